"""What the checks find in a text, in short forms for tests. The host offers `HOST` and the functions f and
g."""

from __future__ import annotations

from typing import Any

from planner_reactor.errors import Diagnostic
from planner_reactor.rs.checks import check_text
from tests.strategies import FUNCTIONS, HOST


def findings(text: str, *codes: str, **options: Any) -> list[Diagnostic]:
    """The findings with these codes (all, if none are given), in the order of the text."""
    found = check_text(text, "cell.rsl", signatures=HOST, functions=frozenset(FUNCTIONS), **options)
    return [f for f in found if not codes or f.code in codes]


def places(text: str, *codes: str, **options: Any) -> list[tuple[int, int]]:
    """Where these findings stand: line and column."""
    return [(f.place.line, f.place.column) for f in findings(text, *codes, **options)]


def messages(text: str, *codes: str, **options: Any) -> list[str]:
    """The findings as `message, hint`."""
    return [f"{f.message}, {f.hint}" if f.hint else f.message for f in findings(text, *codes, **options)]


def errors(text: str, **options: Any) -> list[str]:
    """The codes of all errors."""
    return [f.code for f in findings(text, **options) if f.severity == "error"]
