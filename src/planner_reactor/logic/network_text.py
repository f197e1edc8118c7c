"""Reads what is said of intervals, one statement a line:

    i1 (b m o) i2                                  how they lie; also [b, m, o], b, meets
    i1 lasts 3000 .. 5000                          how long, in milliseconds; also 3000, or 3000 ..
    start of i2 after end of i1 0 .. 2000          how far apart end points are; negative is before
    i1 uses crane 1                                what it takes of a resource; 1 if not said
    resource crane 2                              how much there is of it; 1 if not said

Several statements for one pair narrow each other, `//` and `#` begin a comment. A contradiction is not an error of the
text.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

from planner_reactor.errors import Diagnostic, DomainError, Place, nearest
from planner_reactor.logic.allen import BASES, NAMED, relations
from planner_reactor.logic.network import Network
from planner_reactor.logic.problems import Apart, Capacity, Lasts, Lies, Statement, Uses

LINES_LIMIT = 200_000
_COMMENT = re.compile(r"(//|#).*$")
_NAME = re.compile(r"\s*([^\s()\[\],]+)")
_LIST = re.compile(r"\s*(?:\(([^()\[\]]*)\)|\[([^()\[\]]*)\])")
_NUMBER = r"-?\d+(?:\.\d+)?"
_SPAN = rf"\s+(?P<least>{_NUMBER})(?P<open>\s*\.\.\s*(?P<most>{_NUMBER})?)?\s*$"
_WORD = r"[^\s()\[\],]+"
_LASTS = re.compile(rf"\s*(?P<interval>{_WORD})\s+lasts" + _SPAN)
_USES = re.compile(rf"\s*(?P<interval>{_WORD})\s+uses\s+(?P<resource>{_WORD})(?:\s+(?P<amount>\d+))?\s*$")
_RESOURCE = re.compile(rf"\s*resource\s+(?P<resource>{_WORD})(?:\s+(?P<amount>\d+))?\s*$")
_APART = re.compile(
    rf"\s*(?P<end>start|end)\s+of\s+(?P<interval>{_WORD})"
    rf"\s+after\s+(?P<from>start|end)\s+of\s+(?P<other>{_WORD})" + _SPAN
)
_METRIC = {
    "lasts": "such as i1 lasts 3000 .. 5000",
    "uses": "such as i1 uses crane 1",
    "of": "such as start of i2 after end of i1 0 .. 2000",
}


def read_statements(text: str, *, file: str = "<text>") -> tuple[Statement, ...]:
    """What the text says, each statement with its line; DomainError with all that is wrong with the text.

    A resource of which nothing says how much there is exists once.
    """
    lines = text.splitlines()
    if len(lines) > LINES_LIMIT:
        place = Place(LINES_LIMIT + 1, 1, file)
        raise DomainError([Diagnostic(place, "error", "too-large", f"more than {LINES_LIMIT} lines")])
    found: list[Statement] = []
    wrong: list[Diagnostic] = []
    for number, line in enumerate(lines, start=1):
        said = _COMMENT.sub("", line)
        if said.strip():
            try:
                found.append(_read_statement(said, Place(number, 1 + len(said) - len(said.lstrip()), file)))
            except _WrongError as error:
                place = Place(number, error.column, file)
                wrong.append(Diagnostic(place, "error", error.code, str(error), error.hint, line))
    if wrong:
        raise DomainError(wrong)
    return (*found, *_single(found))


def read_network(text: str, *, file: str = "<text>") -> Network:
    """The network of the relations that the text states, propagated; DomainError as in `read_statements`."""
    return network_of(read_statements(text, file=file))


def network_of(statements: Sequence[Statement]) -> Network:
    """The network of the relations among statements, propagated."""
    network = Network()
    for said in statements:
        if isinstance(said, Lies):
            network.constrain(said.first, said.second, said.relation)
    return network


def _single(statements: Sequence[Statement]) -> list[Statement]:
    known = {said.resource for said in statements if isinstance(said, Capacity)}
    found: dict[object, Statement] = {}
    for said in statements:
        if isinstance(said, Uses) and said.resource not in known:
            words = f"there is one {said.resource}, for nothing says otherwise"
            found.setdefault(said.resource, Capacity(resource=said.resource, amount=1, words=words, place=said.place))
    return list(found.values())


def _read_statement(line: str, place: Place) -> Statement:
    words = " ".join(line.split())
    if lasts := _LASTS.match(line):
        least, most = _span(lasts)
        if least < 0:
            raise _WrongError(lasts.start("least") + 1, "empty-duration", "a negative duration", "expected 0 or more")
        return Lasts(interval=lasts["interval"], least=least, most=most, words=words, place=place)
    if apart := _APART.match(line):
        least, most = _span(apart)
        first, second = (apart["other"], int(apart["from"] == "end")), (apart["interval"], int(apart["end"] == "end"))
        return Apart(first=first, second=second, least=least, most=most, words=words, place=place)
    if uses := _USES.match(line):
        interval, resource = uses["interval"], uses["resource"]
        return Uses(interval=interval, resource=resource, amount=_amount(uses), words=words, place=place)
    if there := _RESOURCE.match(line):
        return Capacity(resource=there["resource"], amount=_amount(there), words=words, place=place)
    first_name, second_name, relation = _read_line(line)
    return Lies(first=first_name, relation=relation, second=second_name, words=words, place=place)


def _span(found: re.Match[str]) -> tuple[float, float | None]:
    least = float(found["least"])
    most = least if found["open"] is None else None if found["most"] is None else float(found["most"])
    if most is not None and most < least:
        message = f"{least:g} .. {most:g} holds nothing"
        raise _WrongError(found.start("least") + 1, "empty-duration", message, "expected the least first")
    return least, most


def _amount(found: re.Match[str]) -> int:
    if found["amount"] is None:
        return 1
    if int(found["amount"]) == 0:
        raise _WrongError(found.start("amount") + 1, "not-whole", "0 of a resource", "expected a whole number above 0")
    return int(found["amount"])


class _WrongError(Exception):
    def __init__(self, column: int, code: str, message: str, hint: str) -> None:
        super().__init__(message)
        self.column, self.code, self.hint = column, code, hint


def _read_line(line: str) -> tuple[str, str, int]:
    first = _NAME.match(line)
    if not first:
        raise _WrongError(1 + len(line) - len(line.lstrip()), "expected-interval", *_EXPECTED)
    word = _NAME.match(line, first.end())
    if word and word[1] in _METRIC:
        message, hint = f"what {word[1]} says cannot be read", f"expected a line {_METRIC[word[1]]}"
        raise _WrongError(word.start(1) + 1, "unexpected", message, hint)
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
