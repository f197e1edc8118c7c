"""What the command prints: one JSON object or text for people on standard output, all else on standard error.

Code of a host that prints would spoil the one object, so standard output is led away while anything runs.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, redirect_stdout
from math import isfinite
from typing import Any

from rich import box
from rich.console import Console
from rich.progress import BarColumn, Progress, TaskID, TextColumn, TimeElapsedColumn
from rich.table import Table

MOST_NOTES = 50
"""Lines about what is out of the ordinary in one run; it may be the same every millisecond."""

WIDE = 120
"""Columns where there is no terminal to ask."""


def say(text: str) -> None:
    """A line for people beside the result."""
    print(text, file=sys.stderr)


class Notes:
    """Says the first notes of a run, and how many more there were."""

    def __init__(self) -> None:
        self._count = 0

    def __call__(self, line: str) -> None:
        self._count += 1
        if self._count <= MOST_NOTES:
            say(line)

    def close(self) -> None:
        if self._count > MOST_NOTES:
            say(f"… and {self._count - MOST_NOTES} further notes")


@contextmanager
def reserved_output() -> Iterator[None]:
    """Standard output is for the result: what is printed meanwhile goes to standard error."""
    with redirect_stdout(sys.stderr):
        yield


def print_json(result: Mapping[str, Any]) -> None:
    """The one object, on one line."""
    print(json.dumps(_plain(result), allow_nan=False))


def _plain(value: Any) -> Any:
    """The same with what JSON cannot say (host objects, infinity) as text."""
    match value:
        case None | bool() | int() | str():
            return value
        case float():
            return value if isfinite(value) else str(value)
        case Mapping():
            return {str(key): _plain(part) for key, part in value.items()}
        case list() | tuple():
            return [_plain(part) for part in value]
        case _:
            return str(value)


def table(title: str, columns: Sequence[str], rows: Sequence[Sequence[object]]) -> None:
    """A table with a title; nothing, if it has no rows. Without names of columns it has no head."""
    if not rows:
        return
    drawn = Table(title=title, title_justify="left", title_style="bold", box=box.SIMPLE, show_header=bool(columns))
    for number in range(len(rows[0])):
        first = number == 0
        numbers = bool(columns) and not first
        drawn.add_column(
            columns[number] if columns else "", justify="right" if numbers else "left", no_wrap=first, overflow="fold"
        )
    for row in rows:
        drawn.add_row(*(_cell(value) for value in row))
    console = Console(file=sys.stdout, highlight=False, markup=False, width=None if sys.stdout.isatty() else WIDE)
    with console.capture() as drawing:  # rich itself would end the process if nobody reads
        console.print(drawn)
    print("\n".join(line.rstrip() for line in drawing.get().splitlines()))


def _cell(value: object) -> str:
    match value:
        case None:
            return "-"
        case bool():
            return "yes" if value else "no"
        case float():
            return f"{value:.3f}"
        case list() | tuple():
            return ", ".join(map(str, value)) or "-"
        case _:
            return str(value)


class Advance:
    """A bar on standard error while something long runs, if that is a terminal; else nothing."""

    def __init__(self, title: str) -> None:
        self._progress: Progress | None = None
        self._title = title
        self._task: TaskID | None = None

    def __enter__(self) -> Advance:
        if sys.stderr.isatty():
            columns = (TextColumn("{task.description}"), BarColumn(), TextColumn("{task.fields[note]}"))
            drawn = Console(file=sys.stderr)
            self._progress = Progress(*columns, TimeElapsedColumn(), console=drawn, transient=True)
            self._progress.start()
            self._task = self._progress.add_task(self._title, total=None, note="")
        return self

    def __exit__(self, *_: object) -> None:
        if self._progress is not None:
            self._progress.stop()

    @property
    def shown(self) -> bool:
        return self._progress is not None

    def at(self, done: float, of: float | None, note: str = "") -> None:
        """So much is done, of so much (None: nobody knows)."""
        if self._progress is not None and self._task is not None:
            self._progress.update(self._task, completed=done, total=of, note=note)

    def count(self, done: int, of: int) -> None:
        """So many of so many are done."""
        self.at(done, of, f"{done} of {of}")


def show_conformance(report: Mapping[str, Any]) -> None:
    """What the online monitor says of a run."""
    if report["disagreement"] is not None:
        print(f"not allowed by the semantics, {report['disagreement']}; before it:")
        for label in report["last"]:
            print(f"  {label}")
    else:
        print(f"{report['steps']} steps held against the semantics, all allowed")
    if report["blind"] is not None:
        print(f"followed until {report['until_s']:.3f} s only: {report['blind']}")
