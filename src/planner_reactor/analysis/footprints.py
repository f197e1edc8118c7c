"""What a part of a configuration can ever touch: ports, situations, labels of reactions.

Read off its text, with the values that are known: definitions are followed with their arguments, names that results
bind are unknown, and an unknown port may be any port. Two parts that share no situation and no label have stores of
their own; if they share no port either, nothing but time connects them. What is found is never too little.

POST meets any ADD (docs/language.md), so all that post or add share one thing more, the label pool.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Final, TypeAlias

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
from planner_reactor.rs.terms import Call, Process, Schema, Value, operands
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


def footprint(part: Run, world: World) -> frozenset[Thing]:
    """Everything that this run-time term can ever touch."""
    reader = _Reader(world)
    reader.run(part)
    return frozenset(reader.things)


def meet(one: Iterable[Thing], other: Iterable[Thing], kinds: Iterable[str]) -> bool:
    """Do two footprints share a thing of these kinds?"""
    left, right = set(one), set(other)
    for kind in kinds:
        mine = {name for k, name in left if k == kind}
        theirs = {name for k, name in right if k == kind}
        if mine & theirs or (mine and theirs and (ANY in mine or ANY in theirs)):
            return True
    return False


class _Reader:
    def __init__(self, world: World) -> None:
        self.things: set[Thing] = set()
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
        if not self._world.defines(call.name):
            self._touches(call.name, values)
            return
        self._calls[call.name] = self._calls.get(call.name, 0) + 1
        if self._calls[call.name] > MOST_CALLS:
            values = (ANY,) * len(values)
        if (call.name, values) in self._read:
            return
        self._read.add((call.name, values))
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

    def _touches(self, name: str, values: tuple[Value, ...]) -> None:
        if name in ("POST", "ADD"):
            self.things.add(("pool", None))
        signature = BUILT_IN.get(name)
        if signature is None:
            return
        for position, value in enumerate(values):
            if (kind := signature.kind(position)) in KINDS:
                self.things.add((kind, value))
