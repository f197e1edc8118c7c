"""What a part of a configuration can ever touch: ports, situations, labels of reactions.

Read off its text, with the values that are known: definitions are followed with their arguments, names that results
bind are unknown, and an unknown port may be any port. Two parts that share no situation and no label have stores of
their own; if they share no port either, nothing but time connects them. What is found is never too little.

POST meets any ADD (docs/language.md), so all that post or add share one thing more, the label pool.

The same reading finds the *plain names*: values that a part only ever uses to say which port, situation or label it
means. No text mentions them, nothing computes or compares with them, so another name in their place would change
nothing but labels; `factoring` knows two parts for copies of each other by that.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Final, TypeAlias

import msgspec

from planner_reactor.rs.configurations import World
from planner_reactor.rs.expressions import EvaluationError, evaluate
from planner_reactor.rs.prelude import PRELUDE
from planner_reactor.rs.states import (
    Await,
    Chain,
    Deciding,
    Leaf,
    Queued,
    Round,
    Run,
    Serve,
    Spawning,
    Testing,
    Waiting,
    parts_of,
)
from planner_reactor.rs.terms import Apply, Call, Negative, Operation, Process, Schema, Value, Variable, operands
from planner_reactor.rs.vocabulary import BUILT_IN

Thing: TypeAlias = tuple[str, Value]
"""("port", name), ("situation", name), ("label", n), ("pool", None); the second is `ANY` where it is unknown."""


class _Any:
    def __repr__(self) -> str:
        return "ANY"


ANY: Final = _Any()
KINDS = ("port", "situation", "label")
MOST_CALLS = 64
"""Calls of one definition that are told apart by their arguments; beyond, these count as unknown."""


class Footprint(msgspec.Struct, frozen=True):
    """Everything that a part can ever touch, and the values that are more than names in it."""

    things: frozenset[Thing]
    inspected: frozenset[Value]


def footprint(part: Run, world: World) -> Footprint:
    """What this run-time term can ever touch."""
    reader = _Reader(world)
    reader.run(part)
    return Footprint(frozenset(reader.things), frozenset(reader.inspected))


def plain_names(footprints: Iterable[Footprint]) -> frozenset[Value]:
    """The names that are plain in all of these together; none, if some name is not known."""
    known = list(footprints)
    names = {name for each in known for _, name in each.things}
    return frozenset() if ANY in names else frozenset(names.difference({None}, *(each.inspected for each in known)))


class _Reader:
    def __init__(self, world: World) -> None:
        self.things: set[Thing] = set()
        self.inspected: set[Value] = set()  # values that are more than a name
        self._world = world
        self._read: set[tuple[str, tuple[Value, ...]]] = set()
        self._calls: dict[str, int] = {}

    def run(self, term: Run) -> None:
        match term:
            case Leaf():
                self._touches(term.name, term.arguments)
            case Await(again=Leaf() as leaf) | Queued(leaf=leaf):
                self._touches(leaf.name, leaf.arguments)
            case Waiting():
                self._touches(term.name, (term.situation,))
            case Chain(_, _, rest, scope):
                self.process(rest, dict(scope))
            case Deciding(_, branches, scope):
                self.process(branches, dict(scope))
            case Testing(_, loop, scope) | Round(_, loop, scope):
                self.process(loop, dict(scope))
            case Spawning(loop=loop, scope=scope):
                self.process(loop, dict(scope))
            case Serve(situation=situation):
                self.things.add(("situation", situation))
            case _:
                pass
        for part in parts_of(term):
            self.run(part)

    def process(self, process: Process, bound: Mapping[str, Value]) -> None:
        if isinstance(process, Call):
            self._call(process, bound)
        for operand in operands(process):
            self.process(operand, bound)

    def _call(self, call: Call, bound: Mapping[str, Value]) -> None:
        values = tuple(self._value(argument, bound) for argument in call.arguments)
        for argument, value in zip(call.arguments, values, strict=True):
            if not isinstance(argument, Variable):
                self._inspect(argument, value, bound)
        if not self._world.defines(call.name):
            self._touches(call.name, values)
            return
        self._calls[call.name] = self._calls.get(call.name, 0) + 1
        if self._calls[call.name] > MOST_CALLS:
            values = (ANY,) * len(values)
        if (call.name, values) in self._read:
            return
        self._read.add((call.name, values))
        clauses = self._world.program.clauses(call.name)
        if any(not hasattr(head, "name") for schema in clauses for head in schema.head):
            self.inspected.update(values)  # a clause is chosen by them
        for schema in self._clauses(call.name, values):
            heads = zip(schema.head, values, strict=False)
            self.process(schema.body, {h.name: v for h, v in heads if hasattr(h, "name") and v is not ANY})

    def _clauses(self, name: str, values: tuple[Value, ...]) -> Iterable[Schema]:
        if ANY not in values:
            found = self._world.select(name, values)
            return () if found is None else (found,)
        return self._world.program.clauses(name) or PRELUDE.clauses(name)

    def _value(self, argument: object, bound: Mapping[str, Value]) -> Value:
        try:
            return evaluate(argument, bound, self._world.functions)  # type: ignore[arg-type]
        except EvaluationError:
            return ANY

    def _inspect(self, argument: object, value: Value, bound: Mapping[str, Value]) -> None:
        """An argument that is not just passed on: a constant, or computed of what is bound."""
        self.inspected.add(value)
        match argument:
            case Variable(name):
                self.inspected.add(bound.get(name))
            case Negative(operand):
                self._inspect(operand, value, bound)
            case Operation(_, left, right):
                self._inspect(left, value, bound)
                self._inspect(right, value, bound)
            case Apply(_, arguments):
                for each in arguments:
                    self._inspect(each, value, bound)

    def _touches(self, name: str, values: tuple[Value, ...]) -> None:
        if name in ("POST", "ADD"):
            self.things.add(("pool", None))
        signature = BUILT_IN.get(name)
        for position, value in enumerate(values):
            if signature is not None and (kind := signature.kind(position)) in KINDS:
                self.things.add((kind, value))
            else:
                self.inspected.add(value)
