"""The words and signs of a domain text `*.itl`, each with its place.

Identifiers may hold hyphens (`int-54`, as X §6.3 prints them), `//` begins a comment. Budgets on size keep
a hostile text from costing more than milliseconds.
"""

from __future__ import annotations

import re

import msgspec

from planner_reactor.errors import Diagnostic, DomainError, Place

DEPTH_LIMIT = 100
"""How deep brackets may be nested."""
DIGITS_LIMIT = 30
"""How long a number may be."""
TEXT_LIMIT = 4_000_000
"""Longest domain text that is read, in characters."""

_TOKEN = re.compile(
    r"""\s*(?://[^\n]*\s*)*(?:
     (?P<name>[A-Za-z_]\w*(?:-\w+)*)
    |(?P<sign><=>|=>|/=|\.\.|[@()\[\]<>,;:])
    |(?P<number>\d+(?:\.\d+)?)
    |(?P<end>\Z)
    |(?P<other>.))""",
    re.VERBOSE | re.DOTALL,
)


class Token(msgspec.Struct, frozen=True, gc=False):
    """`kind` is `name`, `number`, `sign` or `end`; `offset` counts characters from 0."""

    kind: str
    text: str
    offset: int


class WrongSentence(Exception):
    """A sentence that cannot be read, and why."""

    def __init__(self, diagnostic: Diagnostic) -> None:
        super().__init__(str(diagnostic))
        self.diagnostic = diagnostic


class Source:
    """A text with its name; turns an offset into a place or a finding."""

    __slots__ = ("file", "text")

    def __init__(self, text: str, file: str) -> None:
        self.text = text
        self.file = file

    def place(self, offset: int) -> Place:
        before = self.text.rfind("\n", 0, offset)
        return Place(self.text.count("\n", 0, offset) + 1, offset - before, self.file)

    def diagnostic(
        self, offset: int, code: str, message: str, hint: str = "", *, severity: str = "error"
    ) -> Diagnostic:
        start = self.text.rfind("\n", 0, offset) + 1
        end = self.text.find("\n", offset)
        line = self.text[start : end if end >= 0 else len(self.text)]
        return Diagnostic(self.place(offset), severity, code, message, hint, line[:400])


def tokens(source: Source) -> list[Token]:
    """The tokens of a text, with one of kind `end` at the end; DomainError for a text too large or a
    stray sign.
    """
    if len(source.text) > TEXT_LIMIT:
        message = f"the text has more than {TEXT_LIMIT} characters"
        raise DomainError([Diagnostic(Place(1, 1, source.file), "error", "too-large", message)])
    found: list[Token] = []
    depth = 0
    for match in _TOKEN.finditer(source.text):
        kind = match.lastgroup or "other"
        text, offset = match[kind], match.start(kind)
        if kind == "sign":
            depth = max(0, depth + (text in "([") - (text in ")]"))
            if depth > DEPTH_LIMIT:
                message = f"more than {DEPTH_LIMIT} brackets inside each other"
                raise DomainError([source.diagnostic(offset, "too-deep", message)])
        elif kind == "other":
            hint = "comments begin with //" if text in "#%" else ""
            raise DomainError([source.diagnostic(offset, "stray-sign", f"{text!r} has no meaning in a domain", hint)])
        elif kind == "number" and len(text) > DIGITS_LIMIT:
            message = f"a number with {len(text)} digits"
            hint = f"expected at most {DIGITS_LIMIT}"
            raise DomainError([source.diagnostic(offset, "too-large", message, hint)])
        found.append(Token(kind, text, offset))
        if kind == "end":
            break
    return found
