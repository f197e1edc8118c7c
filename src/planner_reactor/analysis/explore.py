"""A small explorer: every configuration that a program can reach, breadth first.

States are compared up to the numbers of situation instances, so that a reactor that asserts for ever has finitely
many. Time passes from one end of an age window to the next. Invariants are asked after every step; a violation comes
with a *shortest* path. This is the plain reading of `rs.evolves`: no reduction, no symbols.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from math import inf
from typing import Any, get_args

import msgspec
from msgspec.structs import replace

from planner_reactor.analysis.components import reaching
from planner_reactor.analysis.discovery import Discovery, Origins, path
from planner_reactor.rs.configurations import Config, Label, World
from planner_reactor.rs.leaves import Step, elapsed, slack, steps, window
from planner_reactor.rs.states import Ended, InstanceNumber, Leaf
from planner_reactor.rs.terms import Process

Invariant = Callable[[Config, Step], bool]
"""Asked with the configuration before a step and the step: does the law hold?"""

TEXT = frozenset(get_args(Process))
"""The types of what is text of the program: no instance is in it."""


class Violation(msgspec.Struct, frozen=True):
    """A law that a reachable step breaks, and the labels of a shortest path to it (that step included)."""

    law: str
    path: tuple[Label, ...]


class Exploration(msgspec.Struct, frozen=True):
    """Every state reached, in the order of a shortest way to it, with its moves (label, number of the next state).

    `complete` is False if the limit on states was reached, or a violation stopped the exploration, first.
    """

    states: tuple[Config, ...]
    moves: tuple[tuple[tuple[Label, int], ...], ...]
    violations: tuple[Violation, ...]
    complete: bool
    origins: Origins

    def __repr__(self) -> str:
        return f"Exploration({len(self.states)} states, complete={self.complete}, {list(self.violations)})"

    @property
    def ends(self) -> tuple[int, ...]:
        """The states that nothing leaves."""
        return tuple(n for n, moves in enumerate(self.moves) if not moves)

    def path(self, state: int) -> tuple[Label, ...]:
        """The labels of a shortest way from the first state."""
        return path(self.origins, state)

    def trapped(self, goal: Callable[[Config], bool]) -> int | None:
        """The first state from which no state with the goal can be reached any more, or None."""
        onward = ([after for _, after in moves] for moves in self.moves)
        found = reaching(onward, (n for n, state in enumerate(self.states) if goal(state)))
        return next((n for n in range(len(self.states)) if n not in found), None)


def explore(
    start: Config,
    world: World,
    *,
    laws: Mapping[str, Invariant] | None = None,
    limit: int = 50_000,
    stop_at_violation: bool = True,
) -> Exploration:
    """Explore from `start`, asking every law at every step."""
    met = Discovery(canonical(start))
    moves: list[tuple[tuple[Label, int], ...]] = []
    violations: list[Violation] = []
    for here, state in enumerate(met.states):  # grows while it is read
        found = []
        for step in successors(state, world):
            found.append((step.label, met.number(canonical(step.after), here, step.label)))
            broken = [name for name, law in (laws or {}).items() if not law(state, step)]
            if broken:
                so_far = path(met.origins, here)
                violations += [Violation(name, (*so_far, step.label)) for name in broken]
        moves.append(tuple(found))
        if (violations and stop_at_violation) or len(met) > limit:
            return Exploration(tuple(met.states), tuple(moves), tuple(violations), False, met.origins)
    return Exploration(tuple(met.states), tuple(moves), tuple(violations), True, met.origins)


def successors(config: Config, world: World) -> Iterator[Step]:
    """Every step, and the passing of time to the next end of an age window if nothing is urgent."""
    moves = list(steps(config, world))
    yield from moves
    if any(move.urgent for move in moves):
        return
    pause = min((d for d in boundaries(config, world) if d > 0), default=inf)
    if (pause := min(pause, slack(config, world))) < inf:
        yield Step(("TIME", (pause,), "ok", ()), elapsed(config, pause, world))


def boundaries(config: Config, world: World) -> Iterator[float]:
    """Seconds to each end of an age window, past ones included."""
    for spot in config.spots():
        if isinstance(spot.leaf, Leaf):
            for edge in window(spot.leaf, world):
                if edge < inf:
                    yield round(edge - spot.leaf.age, 9)


def canonical(config: Config) -> Config:
    """The same configuration with its instances numbered 1, 2, … in order of age; numbers of the dead are 0."""
    names = {i.number: InstanceNumber(n) for n, i in enumerate(config.store.instances, 1)}
    names |= {q.ticket: InstanceNumber(-n) for n, q in enumerate(config.store.queue, 1)}
    if all(old == new for old, new in names.items()) and config.store.next_number == len(config.store.instances) + 1:
        return config
    renamed: Config = renumbered(config, names)
    return replace(renamed, store=replace(renamed.store, next_number=len(config.store.instances) + 1))


def renumbered(value: Any, names: Mapping[InstanceNumber, InstanceNumber]) -> Any:
    """The same value with other instance numbers; those without a name become 0."""
    if isinstance(value, InstanceNumber):
        return names.get(value, InstanceNumber(0))
    if type(value) in TEXT:
        return value
    if isinstance(value, tuple):
        return tuple(renumbered(v, names) for v in value)
    if isinstance(value, Ended):
        return Ended(value.ok, renumbered(value.bindings, names), value.cause)
    if isinstance(value, msgspec.Struct):
        changes = {}
        for name in value.__struct_fields__:
            old = getattr(value, name)
            if (new := renumbered(old, names)) is not old and new != old:
                changes[name] = new
        return replace(value, **changes) if changes else value
    return value
