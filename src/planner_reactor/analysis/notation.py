"""The notation of properties: `always (asserted job -> eventually succeeded job) under weak fairness`.

    property  ::=  formula [under (weak | strong) fairness [of NAME, …]]
    formula   ::=  formula <-> formula  |  formula -> formula  |  formula leads to formula
                |  formula or formula  |  formula and formula
                |  formula until formula  |  formula unless formula  |  formula releases formula
                |  always formula | eventually formula | never formula | next formula | not formula
                |  (formula)  |  true  |  false  |  atom
    atom      ::=  WORD [NAME [[value, …]]]                 the words: `observing.WORDS`

The loosest stand first. `p leads to q` is `always (p -> eventually q)`; `p unless q` is `until` without the promise
that q comes; `never p` is `always not p`.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Literal, NoReturn

import msgspec

from planner_reactor.analysis.observing import WORDS, Atom, Subject
from planner_reactor.analysis.temporal import (
    FALSE,
    TRUE,
    Both,
    Either,
    Formula,
    Here,
    Negation,
    Next,
    Release,
    Until,
    always,
    eventually,
    implies,
    show,
)
from planner_reactor.errors import SourceError, nearest
from planner_reactor.rs.source import Source
from planner_reactor.rs.terms import Call, Program, Symbol, Text, Value, Variable, calls
from planner_reactor.rs.vocabulary import BUILT_IN

WHERE = "<property>"
"""The file that a property is said to stand in."""

_TOKEN = re.compile(
    r"""\s*(?:(?P<number>-?\d+(?:\.\d+)?)|(?P<name>[A-Za-z_]\w*)|"(?P<text>[^"\n]*)"|(?P<sign><->|->|[()\[\],])|(?P<wrong>\S)|$)"""
)
_PREFIXES = ("always", "eventually", "never", "next", "not")
_JOINING = ("and", "or", "until", "unless", "releases", "leads", "to", "under")
_GRAMMAR = (*_PREFIXES, *_JOINING, "true", "false")
DEEPEST = 100

_KIND: dict[str, Subject] = {"situation": "situation", "port": "port"}


class Fairness(msgspec.Struct, frozen=True):
    """Weak: no process that can always go on waits for ever. Strong: no step that is possible again and again is missed
    for ever, outcomes and values included. With `of`, it is asked of these processes only, and strong fairness comes
    with the weak fairness of all others.
    """

    strength: Literal["none", "weak", "strong"] = "none"
    of: tuple[str, ...] = ()

    def __str__(self) -> str:
        of = f" of {', '.join(self.of)}" if self.of else ""
        return "" if self.strength == "none" else f"under {self.strength} fairness{of}"


class Property(msgspec.Struct, frozen=True):
    """What is to be true of every fair run."""

    formula: Formula
    fairness: Fairness = Fairness()

    def __str__(self) -> str:
        return f"{show(self.formula)} {self.fairness}".rstrip()


class Names(msgspec.Struct, frozen=True):
    """What a program has that properties may speak of; `open` kinds may have more (a name that is computed)."""

    known: dict[Subject, tuple[str, ...]]
    open: frozenset[Subject] = frozenset()


def names_of(program: Program, *processes: Call) -> Names:
    """The situations, ports and basic or built-in processes of a program."""
    found: dict[Subject, dict[str, None]] = {"situation": {}, "port": {}, "process": {}, "symbol": {}}
    computed: set[Subject] = set()
    every = [call for schema in program.schemas for call in calls(schema.body)] + list(processes)
    for call in every:
        if not program.clauses(call.name):
            found["process"][call.name] = None
        signature = BUILT_IN.get(call.name)
        for position, argument in enumerate(call.arguments):
            kind: Subject = _KIND.get(signature.kind(position), "symbol") if signature else "symbol"
            match argument:
                case Symbol(name):
                    found[kind][name] = None
                case Text(value):
                    found[kind][value] = None
                case Variable():
                    computed.add(kind)
    if "port" in computed:  # a port or situation that is a parameter is given as a symbol somewhere
        found["port"] |= found["symbol"]
    if "situation" in computed:
        found["situation"] |= found["symbol"]
    return Names({kind: tuple(names) for kind, names in found.items()})


def read_property(text: str, names: Names | None = None) -> Property:
    """A property from its text; `SourceError` with the place, what was expected and the nearest name."""
    return _Reader(text, names).property()


class _Reader:
    def __init__(self, text: str, names: Names | None) -> None:
        self._source = Source(text, WHERE)
        self._names = names
        self._end = self._at = self._depth = 0
        self._kind = self._text = ""
        self._advance()

    # -- tokens

    def _advance(self) -> str:
        behind = self._text
        match = _TOKEN.match(self._source.text, self._end)
        if match is None or match.lastgroup is None:
            self._kind, self._text, self._at = "end", "", len(self._source.text.rstrip())
            return behind
        self._kind, self._text = match.lastgroup, match[match.lastgroup]
        self._at, self._end = match.start(match.lastgroup), match.end()
        if self._kind == "wrong":
            self._refuse(f"`{self._text}` has no meaning in a property", "it is written in words, `->` and `<->`")
        return behind

    def _refuse(self, message: str, hint: str = "", at: int | None = None) -> NoReturn:
        offset = self._at if at is None else at
        raise SourceError([self._source.finding(offset, "error", "property", message, hint)])

    def _found(self) -> str:
        return f"`{self._text}`" if self._kind != "end" else "the end"

    def _take(self, text: str) -> bool:
        if self._kind in ("name", "sign") and self._text == text:
            self._advance()
            return True
        return False

    def _expect(self, text: str, why: str = "") -> None:
        if not self._take(text):
            near = nearest(self._text, [text]) if self._kind == "name" else ""
            self._refuse(f"expected `{text}`{why}, found {self._found()}", near)

    # -- the grammar

    def property(self) -> Property:
        formula = self._formula()
        fairness = self._fairness() if self._take("under") else Fairness()
        if self._kind != "end":
            near = nearest(self._text, (*_JOINING, "of")) if self._kind == "name" else ""
            self._refuse(f"expected an operator or the end, found {self._found()}", near)
        return Property(formula, fairness)

    def _fairness(self) -> Fairness:
        if self._text not in ("weak", "strong"):
            self._refuse(f"expected `weak` or `strong`, found {self._found()}", nearest(self._text, ("weak", "strong")))
        strength: Literal["weak", "strong"] = "weak" if self._advance() == "weak" else "strong"
        self._expect("fairness")
        of: list[str] = []
        if self._take("of"):
            while not of or self._take(","):
                of.append(str(self._name("process")))
        return Fairness(strength, tuple(of))

    def _formula(self) -> Formula:
        self._depth += 1
        if self._depth > DEEPEST:
            self._refuse(f"more than {DEEPEST} levels of nesting")
        left = self._implication()
        while self._take("<->"):
            right = self._implication()
            left = Both(implies(left, right), implies(right, left))
        self._depth -= 1
        return left

    def _implication(self) -> Formula:
        left = self._chain("or", Either, lambda: self._chain("and", Both, self._bounded))
        if self._take("->"):
            self._depth += 1
            right = self._implication()
            self._depth -= 1
            return implies(left, right)
        if self._take("leads"):
            self._expect("to", " after `leads`")
            return always(implies(left, eventually(self._implication())))
        return left

    def _chain(
        self, word: str, joined: Callable[[Formula, Formula], Formula], operand: Callable[[], Formula]
    ) -> Formula:
        left = operand()
        while self._take(word):
            left = joined(left, operand())
        return left

    def _bounded(self) -> Formula:
        left = self._prefixed()
        if self._take("until"):
            return Until(left, self._bounded())
        if self._take("unless"):
            right = self._bounded()
            return Release(right, Either(left, right))
        return Release(left, self._bounded()) if self._take("releases") else left

    def _prefixed(self) -> Formula:
        prefixes = []
        while self._kind == "name" and self._text in _PREFIXES:
            prefixes.append(self._advance())
            if len(prefixes) > DEEPEST:
                self._refuse(f"more than {DEEPEST} levels of nesting")
        formula = self._primary()
        for prefix in reversed(prefixes):
            formula = _prefixed(prefix, formula)
        return formula

    def _primary(self) -> Formula:
        opened = self._at
        if self._take("("):
            formula = self._formula()
            if not self._take(")"):
                place = self._source.place(opened)
                self._refuse(f"expected `)` for the `(` at column {place.column}, found {self._found()}")
            return formula
        if self._take("true"):
            return TRUE
        return FALSE if self._take("false") else Here(self._atom())

    def _atom(self) -> Atom:
        word, at = self._text, self._at
        if self._kind != "name" or word not in WORDS:
            near = nearest(word, (*WORDS, *_GRAMMAR)) if self._kind == "name" else ""
            self._refuse(f"expected a word that says something of a run, found {self._found()}",
                         near or f"there is: {', '.join(WORDS)}")  # fmt: skip
        self._advance()
        subject, _ = WORDS[word]
        if subject == "nothing":
            return Atom(word)
        if subject == "outcome":
            return Atom(word, self._advance() if self._text in ("stop", "abort") else "")
        if self._kind == "end" or (self._kind == "name" and self._text in _JOINING) or self._text in ("->", "<->", ")"):
            self._refuse(f"`{word}` of which {subject}?", f"expected the name of a {subject}", at)
        name = self._name(subject)
        return Atom(word, name, self._arguments() if self._take("[") else None)

    def _name(self, subject: Subject) -> Value:
        if subject == "label" and self._kind == "number":
            return self._value()
        if self._kind not in ("name", "text"):
            self._refuse(f"expected the name of a {subject}, found {self._found()}")
        known = self._names.known.get(subject) if self._names is not None else None
        if known is not None and self._text not in known:
            listed = ", ".join(known) if known else "none"
            hint = nearest(self._text, known) or f"there is: {listed}"
            self._refuse(f"the program has no {subject} {self._text}", hint)
        return self._advance()

    def _arguments(self) -> tuple[Value, ...]:
        found = [self._value()]
        while self._take(","):
            found.append(self._value())
        self._expect("]")
        return tuple(found)

    def _value(self) -> Value:
        if self._kind not in ("number", "name", "text"):
            self._refuse(f"expected a value, found {self._found()}")
        kind, text = self._kind, self._advance()
        return text if kind != "number" else float(text) if "." in text else int(text)


def _prefixed(word: str, body: Formula) -> Formula:
    match word:
        case "always":
            return always(body)
        case "eventually":
            return eventually(body)
        case "never":
            return always(Negation(body))
        case "next":
            return Next(body)
        case _:
            return Negation(body)
