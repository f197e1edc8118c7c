"""Reads a network of intervals from lines such as `i1 (b m o) i2`.

One constraint a line, several for one pair narrow each other; `i1 meets i2` and `i1 [m o] i2` mean the same
as in a domain, commas between relations are allowed, `//` and `#` begin a comment. A contradiction is not
an error of the text: the network that is returned then says that it is not consistent.
"""

from __future__ import annotations

import re

from planner_reactor.errors import Diagnostic, DomainError, Place, nearest
from planner_reactor.logic.allen import BASES, NAMED, relations
from planner_reactor.logic.network import Network

LINES_LIMIT = 200_000
_COMMENT = re.compile(r"(//|#).*$")
_NAME = re.compile(r"\s*([^\s()\[\],]+)")
_LIST = re.compile(r"\s*(?:\(([^()\[\]]*)\)|\[([^()\[\]]*)\])")


def read_network(text: str, *, file: str = "<text>") -> Network:
    """The network that the text describes, propagated; DomainError with all that is wrong with the text."""
    lines = text.splitlines()
    if len(lines) > LINES_LIMIT:
        place = Place(LINES_LIMIT + 1, 1, file)
        raise DomainError([Diagnostic(place, "error", "too-large", f"more than {LINES_LIMIT} lines")])
    network = Network()
    wrong: list[Diagnostic] = []
    for number, line in enumerate(lines, start=1):
        if _COMMENT.sub("", line).strip():
            try:
                network.constrain(*_read_line(_COMMENT.sub("", line)))
            except _WrongError as error:
                place = Place(number, error.column, file)
                wrong.append(Diagnostic(place, "error", error.code, str(error), error.hint, line))
    if wrong:
        raise DomainError(wrong)
    return network


class _WrongError(Exception):
    def __init__(self, column: int, code: str, message: str, hint: str) -> None:
        super().__init__(message)
        self.column, self.code, self.hint = column, code, hint


def _read_line(line: str) -> tuple[str, str, int]:
    first = _NAME.match(line)
    if not first:
        raise _WrongError(1 + len(line) - len(line.lstrip()), "expected-interval", *_EXPECTED)
    relation, end = _read_relation(line, first.end())
    second = _NAME.match(line, end)
    if not second:
        raise _WrongError(end + 1, "expected-interval", "the second interval is missing", _EXPECTED[1])
    rest = line[second.end() :]
    if rest.strip():
        column = second.end() + 1 + len(rest) - len(rest.lstrip())
        raise _WrongError(column, "unexpected", f"{rest.strip()} after the constraint", "expected the end of the line")
    return first[1], second[1], relation


_EXPECTED = ("not a constraint", "expected INTERVAL (RELATIONS) INTERVAL, such as i1 (b m o) i2")


def _read_relation(line: str, start: int) -> tuple[int, int]:
    listed = _LIST.match(line, start)
    word = _NAME.match(line, start)
    if listed:
        inside = listed[1] if listed[1] is not None else listed[2]
        found = re.split(r"[\s,]+", inside.strip()) if inside.strip() else []
        column = listed.start(1 if listed[1] is not None else 2) + 1
        if not found:
            raise _WrongError(column, "no-relation", "an empty list of relations", f"expected some of {_BASES}")
    elif word:
        found, column = [word[1]], word.start(1) + 1
        if word[1] in NAMED:
            return NAMED[word[1]], word.end()
    else:
        raise _WrongError(start + 1, "expected-relation", *_EXPECTED)
    for name in found:
        if name not in BASES:
            known = BASES if listed else (*NAMED, *BASES)
            hint = nearest(name, known) or f"expected some of {_BASES}"
            raise _WrongError(
                line.index(name, column - 1) + 1,
                "unknown-relation",
                f"{name} is not a relation of Allen's",
                hint,
            )
    return relations(found), listed.end() if listed else word.end()  # type: ignore[union-attr]


_BASES = " ".join(BASES)
