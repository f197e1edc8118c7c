"""Configurations: what evolves, and what it evolves under.

A `Config` is a tuple of running roots (a program, or a reactor and the scripts that change it) over one store; a
`World` holds what does not change: definitions, signatures of the leaves, functions, and how basic processes may end.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from typing import TypeAlias

import msgspec
from msgspec.structs import replace

from planner_reactor.rs.prelude import PRELUDE
from planner_reactor.rs.states import Run, Spot, put, spots
from planner_reactor.rs.store import Store
from planner_reactor.rs.terms import Call, Process, Program, Schema, Spawn, Value, operands
from planner_reactor.rs.vocabulary import BUILT_IN, Signature

Functions: TypeAlias = Mapping[str, Callable[..., Value]]
Label: TypeAlias = tuple[str, tuple[Value, ...], str, tuple[Value, ...]]
"""(name, arguments, "ok" | "ab" | "wait", values): what an observer of a step sees."""

OK = "ok"
AB = "ab"
WAITS = "wait"

Ending: TypeAlias = tuple[bool, tuple[Value, ...]]
Oracle: TypeAlias = Callable[[str, tuple[Value, ...]], Iterable[Ending]]
"""How a basic process may end, with which values: concrete runs are deterministic but for this."""


class World(msgspec.Struct, frozen=True):
    """What a configuration evolves under: definitions, signatures of the leaves, functions, endings."""

    program: Program = msgspec.field(default_factory=Program)
    signatures: Mapping[str, Signature] = msgspec.field(default_factory=lambda: BUILT_IN)
    functions: Functions = msgspec.field(default_factory=dict)
    endings: Oracle = lambda name, arguments: [(True, ()), (False, ())]
    spawned: frozenset[str] = frozenset()  # situations served by `::`: they may be asserted from below themselves

    def select(self, name: str, values: tuple[Value, ...]) -> Schema | None:
        return self.program.select(name, values) or PRELUDE.select(name, values)

    def defines(self, name: str) -> bool:
        return bool(self.program.clauses(name) or PRELUDE.clauses(name))


class Config(msgspec.Struct, frozen=True):
    """The running roots, in order of their start, and the store that they share."""

    roots: tuple[tuple[int, Run], ...] = ()
    store: Store = msgspec.field(default_factory=Store)

    def root(self, number: int) -> Run:
        return next(term for n, term in self.roots if n == number)

    def spots(self) -> Iterator[Spot]:
        for number, term in self.roots:
            yield from spots(term, number)

    def put(self, spot: Spot, new: Run) -> Config:
        roots = tuple((n, put(t, spot.path, new) if n == spot.root else t) for n, t in self.roots)
        return replace(self, roots=roots)


def spawned_situations(program: Program, *processes: Process) -> frozenset[str]:
    """The situations that are served by `::` somewhere: they may be asserted from below themselves."""
    found: set[str] = set()
    waiting: list[Process] = [s.body for s in program.schemas] + list(processes)
    while waiting:
        term = waiting.pop()
        if isinstance(term, Spawn) and isinstance(term.condition, Call) and term.condition.name == "SIT":
            found.update(getattr(a, "name", "") for a in term.condition.arguments[:1])
        waiting += operands(term)
    return frozenset(found)
