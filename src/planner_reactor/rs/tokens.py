"""The tokens of a text, one after the other, within a budget.

A `Cursor` stands before one token. It matches the next only when it is asked for, so that a hostile text is
refused where it becomes too much, not after all of it has been cut up. What the tokens mean is the parser's
business.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from itertools import islice

import msgspec

from planner_reactor.errors import Place, RSError
from planner_reactor.rs.grammar import DEFINITION, TOKEN
from planner_reactor.rs.source import Source

LONGEST_QUOTE = 40


class Budgets(msgspec.Struct, frozen=True):
    """What a text may ask for. A term has fewer parts than its text has tokens, so that `tokens` bounds both.

    `nesting` bounds what the parser has open at once (parentheses, prefixes, right operands), `depth` how
    deep the resulting term is: every recursive walk of it stays far below Python's limit.
    """

    characters: int = 1_000_000
    tokens: int = 250_000
    nesting: int = 240
    depth: int = 100
    digits: int = 80
    errors: int = 20


BUDGETS = Budgets()

EXCEEDED = frozenset({"too-long", "too-many-tokens", "too-deep"})
"""Codes of errors after which a text is not read on."""

_HINTS = {
    "{": "processes are grouped by parentheses: `(P)`",
    "}": "processes are grouped by parentheses: `(P)`",
    "'": 'strings are written "in double quotes"',
    '"': 'a string ends with `"` on the line on which it begins',
    "!": "`~P` negates a process, `/=` compares",
    "¬": "`~P` negates a process",
    "%": "arithmetic has `+ - * /`, other functions come from the host",
    "‖": "`|` composes processes side by side",
}


OPENS = {")": "(", "]": "[", ">": "<"}
TOO_DEEP = "give an inner part a name and a definition of its own"


class Cursor:
    """The token to be read next: its `kind` ("name", "number", "text", "sign", "word", "end"), its `text`, and
    where it begins, `at`."""

    __slots__ = ("_matches", "_nesting", "at", "budgets", "kind", "source", "text")

    def __init__(self, source: Source, budgets: Budgets) -> None:
        self.source = source
        self.budgets = budgets
        self.kind = self.text = ""
        self.at = 0
        self._nesting = 0
        if len(source.text) > budgets.characters:
            raise self.error("too-long", f"the text is longer than {budgets.characters} characters")
        self._matches = self._from(0)
        self.advance()

    def advance(self) -> str:
        """Goes on to the next token; returns the text of the one left behind."""
        behind = self.text
        match = next(self._matches, None)
        if match is None:
            raise self.error("too-many-tokens", f"the text has more than {self.budgets.tokens} tokens")
        self.kind = kind = match.lastgroup or "end"
        self.text = match[kind]
        self.at = match.start(kind)
        if kind == "wrong":
            raise self._wrong_character()
        return behind

    def split(self) -> None:
        """Takes the first character off the token: `>=` after the results of a head is `>` and `=`."""
        self.text = self.text[1:]
        self.at += 1

    def skip_to_definition(self) -> None:
        """Goes on to the next line that begins a definition, or to the end."""
        found = DEFINITION.search(self.source.text, self.at)
        self._matches = self._from(found.start() if found else len(self.source.text))
        self._nesting = 0
        self.advance()

    def enter(self) -> None:
        """Something is opened here, to be left before what is open already."""
        self._nesting += 1
        if self._nesting > self.budgets.nesting:
            raise self.error("too-deep", f"more than {self.budgets.nesting} levels of nesting", TOO_DEEP)

    def leave(self, levels: int = 1) -> None:
        self._nesting -= levels

    def close(self, sign: str, opened: int) -> None:
        """Reads the `sign` that closes what was opened at this offset."""
        if self.text == sign:
            self.advance()
        elif sign == ">" and self.text == ">=":
            self.split()
        else:
            place = self.source.place(opened)
            hint = f"to close the `{OPENS[sign]}` at {place.line}:{place.column}"
            raise self.error("syntax", f"expected `{sign}`, found {self.found()}", hint)

    def place(self) -> Place:
        return self.source.place(self.at)

    def found(self) -> str:
        """The token, as a message names it."""
        if self.kind == "end":
            return "the end of the text"
        return f"`{self.text}`" if len(self.text) <= LONGEST_QUOTE else f"`{self.text[:LONGEST_QUOTE]}…`"

    def error(self, code: str, message: str, hint: str = "") -> RSError:
        """An error at this token, to be raised."""
        return RSError([self.source.finding(self.at, "error", code, message, hint)])

    def _from(self, offset: int) -> Iterator[re.Match[str]]:
        return islice(TOKEN.finditer(self.source.text, offset), self.budgets.tokens)

    def _wrong_character(self) -> RSError:
        if self.text.isdigit():
            hint = "numbers are written 12, 0.5 or 1e-3, and a name begins with a letter"
            return self.error("syntax", "this is not a number", hint)
        message = "this string has no end" if self.text == '"' else f"`{self.text}` has no meaning in RS"
        return self.error("syntax", message, _HINTS.get(self.text, ""))
