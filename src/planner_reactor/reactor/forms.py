"""Texts of adaptations by their form: what differs from a text that was checked only in its digits needs no new check.

Planners issue the same clauses again and again, under new labels and for other situations (`grip_7`, `grip_8`). The
*form* of a text is the text with each run of digits replaced by the number of its first occurrence: `P[12] = SIT[s3]…`
and `P[14] = SIT[s9]…` are of one form. Between two texts of one form there is a one-to-one renaming of labels, names
and numbers, and no check of `rs.checks` can tell them apart, as long as nothing but the text itself gives a meaning to
what is renamed. So a form is kept only if

    no name of a process, function or definition has digits          (they mean what the host says)
    every call is of a built-in process or of the host's             (no clause is selected by a number)
    all numbers are whole and not negative, and there are no strings (two ways to write one value would be one value)

A form that was met twice is checked once more, with a number of its own in each place, and taken for what all texts of
this form come to: terms with their places, canonical print, reactions.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import TypeAlias

import msgspec

from planner_reactor.errors import Place, RSError
from planner_reactor.rs.printer import show
from planner_reactor.rs.reactions import Reaction, reaction_of
from planner_reactor.rs.terms import (
    All,
    Call,
    Cond,
    Disable,
    Expression,
    If,
    Loop,
    Not,
    Number,
    Operation,
    Par,
    Process,
    Program,
    Schema,
    Seq,
    Spawn,
    Symbol,
    Variable,
    calls,
    operands,
)

MOST = 256
"""Forms that are kept."""

LONGEST = 10_000
"""Characters of a text whose form is looked for."""

_DIGITS = re.compile("([0-9]+)")
_PLAIN = re.compile(" (?:(?:0|[1-9][0-9]{0,14}) )*")
"""Digits that are read as the number that they show, in one way only."""

_FIRST = 10**15
"""What stands for the digits that come first, when a form is checked, and so on: all have as many digits, `_WIDTH`."""
_WIDTH = 16

TIMES = frozenset({"Delay", "Term", "SUSPEND"})
"""Processes that take as long as a number says."""

Key: TypeAlias = tuple[tuple[str, ...], tuple[int, ...]]
"""What stands between the digits, and which of the different digits stands in each place."""


Durations: TypeAlias = dict[tuple[float, ...], float]
"""How long what serves a situation may still take, by how long what it asserts may: seconds."""


class Filling(msgspec.Struct, frozen=True):
    """What makes a text of its form: the different digits, and how many of them stand before each place."""

    digits: list[str]
    numbers: list[int]
    before: list[int]
    file: str


class Form(msgspec.Struct, frozen=True):
    """All texts of one form: what makes a reaction, and its canonical print, of each of its clauses.

    `durations` are for whoever works out how long clauses of this form may take (`structure`): the same for all, if
    none of them says how long it takes by a number.
    """

    reactions: tuple[Callable[[Filling], Reaction], ...]
    printed: tuple[Callable[[Filling], str], ...]
    needed: int
    durations: tuple[Durations, ...] = ()


def key_of(text: str) -> tuple[Key, list[str], list[str]] | None:
    """The form of a text, its different digits in the order of their coming, and all of them; None if it has none."""
    if len(text) > LONGEST:
        return None
    parts = _DIGITS.split(text)
    runs = parts[1::2]
    different = {run: number for number, run in enumerate(dict.fromkeys(runs))}
    if _PLAIN.fullmatch(f" {' '.join(different)} ") is None and different:
        return None
    return (tuple(parts[::2]), tuple([different[run] for run in runs])), list(different), runs


def filling(digits: list[str], runs: list[str], file: str) -> Filling:
    """What makes a text with these digits; `runs` are they in the order of the text."""
    before = [0]
    for run in runs:
        before.append(before[-1] + len(run))
    return Filling(digits, [int(d) for d in digits], before, file)


class Forms:
    """The forms of which texts were met. May be asked from any thread."""

    def __init__(self, checked: Callable[[str], Program], known: Callable[[str], bool]) -> None:
        """`checked` reads and checks a text, or raises an `RSError`; is a name `known` as a process by itself?"""
        self._checked = checked
        self._known = known
        self._forms: dict[Key, Form | None] = {}
        self._met: dict[Key, None] = {}

    def get(self, key: Key) -> Form | None:
        return self._forms.get(key)

    def met(self, key: Key, needed: int) -> None:
        """A text of this form was found to be sound, and to need so many processes.

        From the second time on the form is kept, if it may be.
        """
        if key in self._forms:
            return
        if key not in self._met:
            if len(self._met) >= MOST:
                self._met.clear()
            self._met[key] = None
            return
        form = self._made(key, needed)
        if len(self._forms) >= MOST:
            self._forms.clear()
        self._forms[key] = form

    def _made(self, key: Key, needed: int) -> Form | None:
        between, order = key
        stand_ins = [str(_FIRST + n) for n in order]
        try:
            program = self._checked("".join([x for pair in zip(between, [*stand_ins, ""], strict=True) for x in pair]))
        except RSError:
            return None  # what the digits are matters
        reactions = [reaction for schema in program.schemas if (reaction := reaction_of(schema)) is not None]
        if len(reactions) < len(program.schemas) or not all(self._may_be_kept(r) for r in reactions):
            return None
        making = _Making(between)
        timed = any(call.name in TIMES for r in reactions for call in calls(r.schema.body))
        return Form(
            tuple([making.reaction(reaction) for reaction in reactions]),
            tuple([_text(show(reaction.schema)) for reaction in reactions]),
            needed,
            () if timed else tuple([{} for _ in reactions]),
        )

    def _may_be_kept(self, reaction: Reaction) -> bool:
        return reaction.label >= _FIRST and all(
            self._known(call.name) and _DIGITS.search(call.name) is None and all(map(_is_plain, call.arguments))
            for call in calls(reaction.schema.body)
        )


def _is_plain(expression: Expression) -> bool:
    """Is it made of names and whole numbers that are not negative?"""
    match expression:
        case Number(value):
            return isinstance(value, int) and value >= _FIRST
        case Symbol() | Variable():
            return True
        case Operation(_, left, right):
            return _is_plain(left) and _is_plain(right)
        case _:
            return False


class _Making:
    """Makes what fills one form; `between` is what stands between its digits."""

    def __init__(self, between: tuple[str, ...]) -> None:
        self._lines: list[tuple[int, list[int]]] = [(0, [])]  # the first run of digits, and what stands before each
        column = 0
        for number, part in enumerate(between):
            for _ in range(part.count("\n")):
                self._lines.append((number, []))
                column = 0
            column += len(part) - (part.rfind("\n") + 1)
            self._lines[-1][1].append(column)

    def place(self, place: Place | None) -> Callable[[Filling], Place | None]:
        """Where the same stands in another text of the form."""
        if place is None:
            return lambda filling: None
        line = place.line
        first, columns = self._lines[line - 1]
        runs = sum(column + _WIDTH * n < place.column - 1 for n, column in enumerate(columns))
        column, last = place.column - _WIDTH * runs, first + runs

        def make(filling: Filling) -> Place:
            before = filling.before
            return Place(line, column + before[last] - before[first], filling.file)

        return make

    def reaction(self, reaction: Reaction) -> Callable[[Filling], Reaction]:
        schema = self.schema(reaction)
        situation = None if reaction.situation is None else _text(reaction.situation)
        asserts, monitors = _texts(reaction.asserts), _texts(reaction.monitors)
        label, stubs = reaction.label - _FIRST, reaction.stubs

        def make(filling: Filling) -> Reaction:
            named = None if situation is None else situation(filling)
            return Reaction(
                filling.numbers[label], schema(filling), named, asserts(filling), stubs, monitors(filling)
            )

        return make

    def schema(self, reaction: Reaction) -> Callable[[Filling], Schema]:
        schema = reaction.schema
        name, label, results = schema.name, reaction.label - _FIRST, _texts(schema.results)
        body, place = self.process(schema.body), self.place(schema.place)
        return lambda f: Schema(name, (Number(f.numbers[label]),), results(f), body(f), place(f))

    def process(self, process: Process) -> Callable[[Filling], Process]:
        match process:
            case Call(name, arguments, results, place):
                expressions, named, at = self.expressions(arguments), _texts(results), self.place(place)
                return lambda f: Call(name, expressions(f), named(f), at(f))
            case Not(body):
                inner = self.process(body)
                return lambda f: Not(inner(f))
            case Loop() | Spawn() | If():
                kind, parts = type(process), [self.process(part) for part in operands(process)]
                return lambda f: kind(*[part(f) for part in parts])
            case Seq() | Cond() | Par() | All() | Disable():
                chain, parts = type(process), [self.process(part) for part in operands(process)]
                return lambda f: chain(tuple([part(f) for part in parts]))

    def expressions(self, expressions: tuple[Expression, ...]) -> Callable[[Filling], tuple[Expression, ...]]:
        match [self.expression(e) for e in expressions]:
            case []:
                return lambda f: ()
            case [one]:
                return lambda f: (one(f),)
            case [one, two]:
                return lambda f: (one(f), two(f))
            case several:
                return lambda f: tuple([e(f) for e in several])

    def expression(self, expression: Expression) -> Callable[[Filling], Expression]:
        match expression:
            case Number(int() as value):
                number = value - _FIRST
                return lambda f: Number(f.numbers[number])
            case Symbol(name, place) | Variable(name, place):
                kind, text, at = type(expression), _text(name), self.place(place)
                return lambda f: kind(text(f), at(f))
            case Operation(sign, left, right):
                one, other = self.expression(left), self.expression(right)
                return lambda f: Operation(sign, one(f), other(f))
            case _:
                raise AssertionError(f"{expression} is in no form that is kept")


def _text(text: str) -> Callable[[Filling], str]:
    """A text that has stand-ins in it."""
    parts = _DIGITS.split(text)
    if len(parts) == 1:
        return lambda filling: text
    wanted = [int(run) - _FIRST for run in parts[1::2]]
    if len(wanted) == 1:
        (number,), (before, _, after) = wanted, parts
        return lambda filling: before + filling.digits[number] + after

    def make(filling: Filling) -> str:
        own = parts[:]  # another thread may fill it too
        own[1::2] = [filling.digits[n] for n in wanted]
        return "".join(own)

    return make


def _texts(texts: tuple[str, ...]) -> Callable[[Filling], tuple[str, ...]]:
    if not any(map(_DIGITS.search, texts)):
        return lambda filling: texts
    makes = [_text(text) for text in texts]
    return lambda filling: tuple([make(filling) for make in makes])
