"""A small explorer: every configuration that a program can reach, breadth first.

States are compared up to the numbers of situation instances, so that a reactor that asserts for ever has finitely
many. Time passes from one end of an age window to the next. Invariants are asked after every step; a violation comes
with a *shortest* path. This is the plain reading of `rs.evolves`: no reduction, no symbols.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, fields, is_dataclass, replace
from math import inf
from typing import Any

from planner_reactor.rs.evolves import Config, Label, World
from planner_reactor.rs.leaves import Step, elapsed, slack, steps, window
from planner_reactor.rs.states import InstanceNumber, Leaf

Invariant = Callable[[Config, Step], bool]
"""Asked with the configuration before a step and the step: does the law hold?"""

TIME: Label = ("TIME", (), "ok", ())


@dataclass(frozen=True, slots=True)
class Violation:
    """A law that a reachable step breaks, and the labels of a shortest path to it (that step included)."""

    law: str
    path: tuple[Label, ...]


@dataclass(frozen=True, slots=True)
class Exploration:
    """What was found. `complete` is False if the limit on states was reached first."""

    states: int
    transitions: int
    deadlocks: tuple[tuple[Label, ...], ...]
    violations: tuple[Violation, ...]
    ends: frozenset[Config] = field(repr=False)
    complete: bool = True


def explore(
    start: Config,
    world: World,
    *,
    laws: Mapping[str, Invariant] | None = None,
    limit: int = 50_000,
    stop_at_violation: bool = True,
) -> Exploration:
    """Explore from `start`. A deadlock is a state without steps in which a root has not ended."""
    laws = laws or {}
    first = canonical(start)
    came_from: dict[Config, tuple[Config, Label] | None] = {first: None}
    waiting = deque([first])
    transitions = 0
    deadlocks: list[tuple[Label, ...]] = []
    violations: list[Violation] = []
    ends: set[Config] = set()
    while waiting:
        state = waiting.popleft()
        moves = list(successors(state, world))
        transitions += len(moves)
        if not moves:
            ends.add(state)
            if any(True for _ in state.spots()):
                deadlocks.append(_path(state, came_from))
        for step in moves:
            broken = [name for name, law in laws.items() if not law(state, step)]
            violations += [Violation(name, (*_path(state, came_from), step.label)) for name in broken]
            if broken and stop_at_violation:
                return Exploration(len(came_from), transitions, tuple(deadlocks), tuple(violations), frozenset(ends))
            after = canonical(step.after)
            if after not in came_from:
                if len(came_from) >= limit:
                    return Exploration(
                        limit, transitions, tuple(deadlocks), tuple(violations), frozenset(ends), complete=False
                    )
                came_from[after] = (state, step.label)
                waiting.append(after)
    return Exploration(len(came_from), transitions, tuple(deadlocks), tuple(violations), frozenset(ends))


def successors(config: Config, world: World) -> Iterator[Step]:
    """Every step, and the passing of time to the next end of an age window if nothing is urgent."""
    yield from (moves := list(steps(config, world)))
    longest = slack(config, world)
    if longest > 0 and not any(m.urgent for m in moves):
        pause = min((d for d in _boundaries(config, world) if d > 0), default=inf)
        if pause < inf:
            yield Step(TIME, elapsed(config, min(pause, longest)))


def _boundaries(config: Config, world: World) -> Iterator[float]:
    for spot in config.spots():
        if isinstance(spot.leaf, Leaf):
            for edge in window(spot.leaf, world):
                if edge < inf:
                    yield round(edge - spot.leaf.age, 9)


def _path(state: Config, came_from: Mapping[Config, tuple[Config, Label] | None]) -> tuple[Label, ...]:
    labels: list[Label] = []
    while (step := came_from[state]) is not None:
        state, label = step
        labels.append(label)
    return tuple(reversed(labels))


def canonical(config: Config) -> Config:
    """The same configuration with its instances numbered 1, 2, … in order of age; numbers of the dead are 0."""
    names = {i.number: InstanceNumber(n) for n, i in enumerate(config.store.instances, 1)}
    names |= {q.ticket: InstanceNumber(-n) for n, q in enumerate(config.store.queue, 1)}
    if all(old == new for old, new in names.items()) and config.store.next_number == len(config.store.instances) + 1:
        return config
    renamed: Config = _renumbered(config, names)
    return replace(renamed, store=replace(renamed.store, next_number=len(config.store.instances) + 1))


def _renumbered(value: Any, names: Mapping[InstanceNumber, InstanceNumber]) -> Any:
    if isinstance(value, InstanceNumber):
        return names.get(value, InstanceNumber(0))
    if isinstance(value, tuple):
        return tuple(_renumbered(v, names) for v in value)
    if is_dataclass(value) and not isinstance(value, type):
        changes = {}
        for member in fields(value):
            old = getattr(value, member.name)
            if (new := _renumbered(old, names)) is not old and new != old:
                changes[member.name] = new
        return replace(value, **changes) if changes else value
    return value
