"""Does a network take infinitely many steps at one instant? Then it is Zeno, and time never passes (X §4.1.2, STREAM).

Every state is reached symbolically; of values only is kept which of them are the same, so that there are finitely
many states. A cycle of urgent steps is a Zeno loop: it is given with the meetings and ends of processes in it, the
definitions that are called anew in each round, and a way there. Because values are forgotten, a loop that only
certain values would break may be reported; where none is found, there is none.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Collection
from itertools import pairwise
from math import inf

import msgspec
from msgspec.structs import replace

from planner_reactor.analysis.evolution import State, beginnings, immediate, outside
from planner_reactor.analysis.explore import boundaries, canonical
from planner_reactor.analysis.limits import untimed
from planner_reactor.analysis.renaming import forgotten
from planner_reactor.analysis.residuals import Noting
from planner_reactor.analysis.subnets import network, open_ports
from planner_reactor.rs.configurations import Config, Label, World
from planner_reactor.rs.graphs import reachable, way_round
from planner_reactor.rs.leaves import elapsed, slack
from planner_reactor.rs.terms import Process, Value

LIMIT = 5_000
"""States that are reached unless a caller says otherwise."""


class Move(msgspec.Struct, frozen=True):
    """A step to the state of this number. `calls` are the definitions that it begins."""

    label: Label
    after: int
    urgent: bool
    calls: tuple[str, ...] = ()


class ZenoLoop(msgspec.Struct, frozen=True):
    """Steps that can follow each other for ever at one instant, and the steps that lead there."""

    labels: tuple[Label, ...]
    calls: tuple[str, ...]
    path: tuple[Label, ...]

    def __str__(self) -> str:
        meetings = " . ".join(f"{name}[{', '.join(map(str, arguments))}]" for name, arguments, _, _ in self.labels)
        return f"{', '.join(self.calls) or 'a loop'} goes round at one instant: {meetings}"


class ZenoReport(msgspec.Struct, frozen=True):
    """A loop, or None; `complete` is False if not every state was looked at."""

    loop: ZenoLoop | None
    states: int
    complete: bool


def zeno(
    process: Process, world: World, *, ports: Collection[Value] | None = None, limit: int = LIMIT
) -> ZenoReport:
    """Look for a Zeno loop of a process; `ports` are open to the world outside (default: those with one side only)."""
    noting = Noting(**{name: getattr(world, name) for name in World.__struct_fields__})
    open_to = open_ports(network(process, world).components, world) if ports is None else ports
    search = _Search(noting, open_to)
    for start in beginnings(process, world):
        search.found(_forgotten(start))
    while search.waiting and len(search.numbers) <= limit and not search.looping:
        search.expand()
    return ZenoReport(search.loop(), len(search.numbers), not search.waiting and not search.looping)


class _Search:
    """States as they are found: what urgent steps lead to is looked at before anything else."""

    def __init__(self, world: Noting, ports: Collection[Value]) -> None:
        self.numbers: dict[Config, int] = {}
        self.waiting: deque[tuple[int, Config]] = deque()
        self.looping: list[int] = []
        self._world = world
        self._ports = ports
        self._moves: dict[int, list[Move]] = {}
        self._came_from: dict[int, tuple[int, Label]] = {}

    def found(self, config: Config, *, urgent: bool = False) -> int:
        if config not in self.numbers:
            (self.waiting.appendleft if urgent else self.waiting.append)((len(self.numbers), config))
        return self.numbers.setdefault(config, len(self.numbers))

    def expand(self) -> None:
        here, config = self.waiting.popleft()
        self._moves[here] = []
        for label, after, urgent, calls in _moves(config, self._world, self._ports):
            new = len(self.numbers)
            number = self.found(after, urgent=urgent)
            if number == new:
                self._came_from[number] = (here, label)
            self._moves[here].append(Move(label, number, urgent, calls))
            if urgent and number != new and self._leads(number, here):
                self.looping = [here]

    def _leads(self, start: int, goal: int) -> bool:
        """Do urgent steps lead from here to there?"""
        return goal in reachable({n: [m.after for m in found if m.urgent] for n, found in self._moves.items()}, [start])

    def loop(self) -> ZenoLoop | None:
        if not self.looping:
            return None
        (start,) = self.looping
        way = way_round({n: tuple(m.after for m in found if m.urgent) for n, found in self._moves.items()}, start)
        steps = [next(m for m in self._moves[a] if m.after == b and m.urgent) for a, b in pairwise(way)]
        path: list[Label] = []
        while start in self._came_from:
            start, label = self._came_from[start]
            path.append(label)
        called = tuple(dict.fromkeys(name for step in steps for name in step.calls))
        return ZenoLoop(tuple(step.label for step in steps), called, tuple(reversed(path)))


def _forgotten(state: State) -> Config:
    return forgotten(canonical(untimed(state.config)))


def _moves(
    config: Config, world: Noting, ports: Collection[Value]
) -> list[tuple[Label, Config, bool, tuple[str, ...]]]:
    state = State(config, serial=10**6)
    found = []
    world.noted.clear()
    for e in immediate(state, world):
        found.append((e.label, _forgotten(e.after), e.urgent, tuple(dict.fromkeys(name for name, _ in world.noted))))
        world.noted.clear()
    if not any(urgent for _, _, urgent, _ in found):
        found += [(e.label, _forgotten(e.after), False, ()) for e in outside(state, world, ports)]
        ahead = (d for d in boundaries(config, world) if d > 0)
        if (seconds := min((*ahead, slack(config, world)), default=inf)) < inf:
            later = replace(state, config=elapsed(config, seconds, world))
            found.append((("TIME", (seconds,), "ok", ()), _forgotten(later), False, ()))
    return found
