"""What can go wrong, and how it is said.

    PlannerReactorError
    ├── SourceError(ValueError)      a text is wrong: one or more `Diagnostic`s, each with its place
    │   ├── RSError                  a program in RS (`*.rsl`)
    │   └── DomainError              a planning domain (`*.itl`)
    ├── InputError(ValueError)       an argument, a fault list, a kit specification, a host module
    ├── BudgetError(RuntimeError)    a declared limit on size, depth, steps or instances was reached
    ├── DiskError(OSError)           what should be durable could not be written, or read
    └── RefusedError(RuntimeError)   an adaptation that was not applied, and why

A process that *aborts* is an outcome of the language, never one of these.
"""

from __future__ import annotations

from collections.abc import Iterable

import msgspec


class Place(msgspec.Struct, frozen=True):
    """Where something stands in a text: line and column count from 1."""

    line: int
    column: int
    file: str = "<text>"

    def __str__(self) -> str:
        return f"{self.file}:{self.line}:{self.column}"


class Diagnostic(msgspec.Struct, frozen=True):
    """One finding about a text.

    `code` is a short stable name (`unknown-process`), `hint` says what was expected or the nearest name.
    """

    place: Place
    severity: str  # "error" | "warning"
    code: str
    message: str
    hint: str = ""
    line_text: str = ""

    def __str__(self) -> str:
        head = f"{self.place}: {self.message}"
        if self.hint:
            head += f", {self.hint}"
        if not self.line_text:
            return head
        return f"{head}\n    {self.line_text}\n    {caret(self.line_text, self.place.column)}"


class PlannerReactorError(Exception):
    """Base of everything that this package raises on purpose."""


class SourceError(PlannerReactorError, ValueError):
    """A text that cannot be used. `diagnostics` holds every finding, the first is the message."""

    def __init__(self, diagnostics: Iterable[Diagnostic]) -> None:
        self.diagnostics: tuple[Diagnostic, ...] = tuple(diagnostics)
        super().__init__("\n".join(str(d) for d in self.diagnostics))

    @property
    def place(self) -> Place:
        return self.diagnostics[0].place


class RSError(SourceError):
    """A program in RS that cannot be loaded."""


class DomainError(SourceError):
    """A planning domain that cannot be loaded."""


class InputError(PlannerReactorError, ValueError):
    """An argument or an input file that cannot be used."""


class BudgetError(PlannerReactorError, RuntimeError):
    """A declared limit was reached; `limit` names it."""

    def __init__(self, limit: str, message: str) -> None:
        self.limit = limit
        super().__init__(message)


class DiskError(PlannerReactorError, OSError):
    """What should be durable could not be written, or not be read."""


class RefusedError(PlannerReactorError, RuntimeError):
    """An adaptation that was refused; nothing of it was applied."""

    def __init__(self, reason: str, message: str) -> None:
        self.reason = reason
        super().__init__(message)


def caret(line: str, column: int) -> str:
    """A line of blanks with `^` below the given column; tabs are kept so that it stays aligned."""
    return "".join("\t" if c == "\t" else " " for c in line[: column - 1]) + "^"


def nearest(name: str, candidates: Iterable[str]) -> str:
    """`did you mean X?` for the closest candidate, or an empty string.

    The first letter is seldom mistaken: where it differs, all else has to be closer (`Try` does not mean `GTR`).
    """
    from difflib import get_close_matches  # only mistakes need it

    by_folded = {c.lower(): c for c in candidates}
    folded = name.lower()
    alike = [c for c in by_folded if c[:1] == folded[:1]]
    found = get_close_matches(folded, alike, n=1, cutoff=0.6) or get_close_matches(folded, by_folded, n=1, cutoff=0.75)
    return f"did you mean {by_folded[found[0]]}?" if found else ""
