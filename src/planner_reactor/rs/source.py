"""A text and the places in it.

Tokens and terms know where they stand; this module turns an offset into line and column, and a place into a
finding that shows its line. It reads no language.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Sequence

from msgspec.structs import replace

from planner_reactor.errors import Diagnostic, Place

LONGEST_LINE = 400


class Source:
    """One text, by lines. Columns count characters from 1."""

    __slots__ = ("_starts", "file", "text")

    def __init__(self, text: str, file: str = "<text>") -> None:
        self.text = text
        self.file = file
        self._starts = [0]
        end = text.find("\n")
        while end >= 0:
            self._starts.append(end + 1)
            end = text.find("\n", end + 1)

    def place(self, offset: int) -> Place:
        """Where the character at `offset` (from 0) stands."""
        line = bisect_right(self._starts, offset)
        return Place(line, offset - self._starts[line - 1] + 1, self.file)

    def line(self, number: int) -> str:
        """The text of a line (from 1), without its end; empty beyond the last."""
        if not 1 <= number <= len(self._starts):
            return ""
        start = self._starts[number - 1]
        end = self.text.find("\n", start)
        return self.text[start : end if end >= 0 else len(self.text)].rstrip("\r")

    def finding(self, offset: int, severity: str, code: str, message: str, hint: str = "") -> Diagnostic:
        """A finding about the character at `offset`."""
        place = self.place(offset)
        return Diagnostic(place, severity, code, message, hint, self._shown_line(place))

    def shown(self, findings: Sequence[Diagnostic]) -> tuple[Diagnostic, ...]:
        """The findings in the order of the text, each with its line; those of other files stand last."""
        ours = [f for f in findings if f.place.file == self.file]
        ours.sort(key=lambda f: (f.place.line, f.place.column))
        others = [f for f in findings if f.place.file != self.file]
        return (*(replace(f, line_text=self._shown_line(f.place)) for f in ours), *others)

    def _shown_line(self, place: Place) -> str:
        """The line, unless it is so long that showing it would hide the message."""
        return self.line(place.line)[: place.column + LONGEST_LINE] if place.column <= LONGEST_LINE else ""
