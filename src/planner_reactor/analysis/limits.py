"""Limit sets: where an environment model comes to, and under which conditions (X §4.3.2; (4), (8), (12), (15)).

A limit is the first state of a path in which one component of the network invokes a recursion with changed arguments,
reaches a pseudo-bound (a sensory process), or ends for good; or in which nothing can evolve any more. The other
components are then written at their recursion heads, so `TEM[p + g, a]` says that the object has moved and nothing
else. Components communicate: what one reads is what another writes.

Conditions leave out how long things take and what meets within the network. A delay of unknown length may end at any
time; delays of known length take exactly that, so other delays may give other limits. Zero-time tests are urgent, and
the pause of a STREAM is short against every unknown delay. Of bodies of one `::` in the same state two are kept. A
limit under a condition that asks for more than another for the same term is left out.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Collection, Iterator
from math import inf
from typing import Literal, TypeAlias

import msgspec
from msgspec.structs import replace

from planner_reactor.analysis.conditions import (
    Condition,
    Event,
    constraints_of,
    events_of,
    mentioned,
    shortened,
    weaker,
)
from planner_reactor.analysis.evolution import DURATIONS, Evolution, State, immediate, outside
from planner_reactor.analysis.explore import boundaries, canonical
from planner_reactor.analysis.recursions import MARK, bounded, invoked
from planner_reactor.analysis.renaming import renamed, unknowns_of
from planner_reactor.analysis.residuals import Residuals
from planner_reactor.analysis.subnets import Network, folded, network, open_ports
from planner_reactor.rs.comparisons import TESTS
from planner_reactor.rs.configurations import Config, World
from planner_reactor.rs.constraints import consistent, projected
from planner_reactor.rs.evolves import begin, settle, started
from planner_reactor.rs.leaves import elapsed, slack
from planner_reactor.rs.prelude import QUANTUM
from planner_reactor.rs.states import Ended, Leaf, Run, Spawning, Spot, parts_of, with_parts
from planner_reactor.rs.terms import STOP, Call, Par, Process, Value
from planner_reactor.rs.unknowns import Constraint, Symbolic, Unknown, courses

Kind: TypeAlias = Literal["recursion", "bound", "end", "stuck"]

KINDS: tuple[Kind, ...] = ("recursion", "bound", "end", "stuck")

UNTOLD = (*DURATIONS, *TESTS, "Ran")
"""Processes whose end no condition of a limit tells: what they ask of unknowns is told instead."""

MOST_EQUAL = 2
"""Bodies of one `::` that are in the same state: more are like these, since each takes the time that it likes."""

FORGOTTEN = 10**6
"""The serial of unknowns that nothing but an event mentions."""

LIMIT = 20_000
"""States that are reached unless a caller says otherwise."""


class Limit(msgspec.Struct, frozen=True):
    """One entry: under this condition the process comes to this term.

    `component` is what has changed, as it began, and `reached` what it has come to (None if it has ended).
    """

    condition: Condition
    term: Process
    kind: Kind
    component: Process | None = None
    reached: Process | None = None


class LimitSet(msgspec.Struct, frozen=True):
    """All limits, in the order of the components. `complete` is False if the budget of states ran out before."""

    limits: tuple[Limit, ...]
    states: int
    complete: bool


def limit_set(
    process: Process,
    world: World,
    *,
    sensors: Collection[str] = (),
    ports: Collection[Value] | None = None,
    limit: int = LIMIT,
) -> LimitSet:
    """The limit set of a process with pseudo-bounds `sensors` (names of definitions or of basic processes).

    `ports` are open to the world outside (default: those of which the network has one side only).
    """
    return _Search(process, world, tuple(sensors), ports).run(limit)


class _Search:
    def __init__(
        self, process: Process, world: World, sensors: tuple[str, ...], ports: Collection[Value] | None
    ) -> None:
        self._whole = world
        self._tree: Network = network(process, world, whole=sensors)
        self._components = self._tree.components
        self._world = bounded(world, [c.name for c in self._components if isinstance(c, Call)], sensors)
        self._sensors = sensors
        self._ports = open_ports(self._components, world) if ports is None else ports
        self._bounds = {*sensors, *(name for name in self._world.signatures if name.endswith(MARK))}
        self._unhurried: dict[Run, Run] = {}
        self._found: list[Limit] = []
        self._seen: dict[Config, list[Condition]] = {}
        self.states = 0

    def run(self, limit: int) -> LimitSet:
        waiting: deque[tuple[State, Condition]] = deque()
        for config, supposed in courses(self._begun, (), consistent):
            waiting += self._arrived(State(config, supposed), supposed)
        while waiting and self.states < limit:
            state, condition = waiting.popleft()
            self.states += 1
            waiting += self._followed(state, condition)
        return LimitSet(tuple(sorted(self._found, key=self._order)), self.states, not waiting)

    def _begun(self) -> Config:
        config = Config()
        for component in self._components:
            config = started(component, self._world, config=config)
        return self._untimed(config)

    def _untimed(self, config: Config) -> Config:
        """What one step has changed is looked at once."""
        return untimed(config, self._unhurried)

    # ---------------------------------------------------------------------------------------------- one state

    def _followed(self, state: State, condition: Condition) -> Iterator[tuple[State, Condition]]:
        """The states after this one that are neither limits nor have been met."""
        moves = self._moves(state, condition)
        if not moves:
            self._add(Limit((), Residuals({}).network(state.config, self._world), "stuck"), condition)
        for e in moves:
            after = replace(e.after, config=self._untimed(e.after.config))
            yield from self._arrived(after, (*condition, *e.condition))

    def _arrived(self, state: State, condition: Condition) -> Iterator[tuple[State, Condition]]:
        """The state itself, unless it is a limit or has been met."""
        state, bounds = self._unfolded(state)
        told = self._told(condition, state)
        for found in (limits := list(self._limits(state, bounds))):
            self._add(found, told)
        if not limits and self._is_new(state, told):
            yield replace(state, known=constraints_of(told)), told

    def _moves(self, state: State, condition: Condition) -> list[Evolution]:
        """What is urgent, or else everything that may happen next."""
        now = list(immediate(state, self._world))
        hurried = [e for e in now if e.urgent]
        if hurried:
            return hurried
        quick = list(self._quick(state))
        if any(self._is_new(e.after, self._told(condition, e.after), look=True) for e in quick):
            return quick
        later = [] if quick else self._later(state)
        return [*now, *outside(state, self._world, self._ports), *quick, *later]

    def _quick(self, state: State) -> Iterator[Evolution]:
        """The ends of the pauses of STREAMs, if all else that takes time takes it as it likes."""
        timed = [s for s in state.config.spots() if isinstance(s.leaf, Leaf) and s.leaf.name in DURATIONS]
        pauses = [s for s in timed if isinstance(s.leaf, Leaf) and _is_pause(s.leaf)]
        if all(s in pauses or (isinstance(s.leaf, Leaf) and s.leaf.arguments == (inf,)) for s in timed):
            for spot in pauses:
                after = settle(state.config.put(spot, Ended(True)), self._world)
                yield Evolution((), replace(state, config=after), ("Delay", (QUANTUM,), "ok", ()))

    def _later(self, state: State) -> Iterator[Evolution]:
        """TIME: to the next instant at which a window opens or closes."""
        ahead = (d for d in boundaries(state.config, self._world) if d > 0)
        if (seconds := min((*ahead, slack(state.config, self._world)), default=inf)) < inf:
            after = elapsed(state.config, seconds, self._world)
            yield Evolution((), replace(state, config=after), ("TIME", (seconds,), "ok", ()))

    def _unfolded(self, state: State) -> tuple[State, list[Spot]]:
        """Recursions with the arguments that they had are gone into; what is left of bounds is where a limit is."""
        while True:
            bounds = [s for s in state.config.spots() if isinstance(s.leaf, Leaf) and s.leaf.name in self._bounds]
            again = next((s for s in bounds if not self._is_limit(s)), None)
            if again is None:
                return state, bounds
            term = begin(self._invoked(again)[0], (), self._world)
            state = replace(state, config=self._untimed(settle(state.config.put(again, term), self._world)))

    def _is_limit(self, spot: Spot) -> bool:
        """A sensor, or a recursion with changed arguments."""
        assert isinstance(spot.leaf, Leaf)
        if spot.leaf.name in self._sensors:
            return True
        call, entry = self._invoked(spot)
        own = self._components[spot.root - 1]
        if entry is None and isinstance(own, Call) and own.name == call.name:
            return own.arguments != call.arguments
        return entry != spot.leaf.arguments[: len(call.arguments)]

    def _invoked(self, spot: Spot) -> tuple[Call, tuple[Value, ...] | None]:
        assert isinstance(spot.leaf, Leaf)
        return invoked(spot.leaf.name, spot.leaf.arguments, self._whole.program)

    # ------------------------------------------------------------------------------------------------- limits

    def _limits(self, state: State, bounds: list[Spot]) -> Iterator[Limit]:
        for spot in bounds:
            own = self._components[spot.root - 1]
            assert isinstance(spot.leaf, Leaf)
            if spot.leaf.name in self._sensors:
                sensor = Residuals({}).residual(spot.leaf, self._whole)
                whole = own == sensor
                yield Limit((), self._network() if whole else _beside(self._network(), sensor), "bound", own, sensor)
                continue
            call, _ = self._invoked(spot)
            inside = not (isinstance(own, Call) and own.name == call.name)
            now = _beside(self._network(), call) if inside else self._network(spot.root - 1, call)
            yield Limit((), now, "recursion", own, call)
        for number, ((_, term), own) in enumerate(zip(state.config.roots, self._components, strict=True)):
            if isinstance(term, Ended):
                yield Limit((), self._network(number, None), "end", own)

    def _network(self, number: int = -1, changed: Process | None = None) -> Process:
        """The network with the component of this number changed, or gone."""
        now = [changed if n == number else c for n, c in enumerate(self._components)]
        return folded(self._tree, iter(now), self._whole) or STOP

    def _add(self, found: Limit, condition: Condition) -> None:
        asked = constraints_of(condition)
        keep = {*_given(asked), *unknowns_of((found.term, found.reached)), *mentioned(events_of(condition))}
        asked = shortened(projected(asked, keep))
        (_, _, new) = renamed((found.term, found.reached, replace(found, condition=(*events_of(condition), *asked))))
        same = [old for old in self._found if old.term == new.term and old.kind == new.kind]
        if not any(weaker(old.condition, new.condition) for old in same):
            dropped = [old for old in same if weaker(new.condition, old.condition)]
            self._found = [*(old for old in self._found if old not in dropped), new]

    def _order(self, found: Limit) -> tuple[float, int]:
        place = self._components.index(found.component) if found.component in self._components else inf
        return place, KINDS.index(found.kind)

    # --------------------------------------------------------------------------------- what has been met before

    def _told(self, condition: Condition, after: State) -> Condition:
        """The condition as far as anybody may ask for it: no delays, no meetings, nothing of what is forgotten."""
        events = tuple(e for e in events_of(condition) if e.kind != "meeting" and e.name not in UNTOLD)
        constraints = constraints_of(condition)
        if after.serial == 1:
            return tuple(dict.fromkeys((*events, *constraints)))
        live = {*unknowns_of(after.config), *unknowns_of([e.arguments for e in events])}
        events = tuple(_without_results(e, live) for e in events)
        constraints = projected(constraints, {*_given(constraints), *live}) if constraints else ()
        return tuple(dict.fromkeys((*events, *constraints)))

    def _is_new(self, state: State, condition: Condition, *, look: bool = False) -> bool:
        """Has this configuration not been met under a condition that asks for no more? Then it has now."""
        key, told = canonical(state.config), condition
        if state.serial > 1:
            key, told = renamed((key, told))
        before = self._seen.get(key, [])
        if any(weaker(known, told) for known in before):
            return False
        if not look:
            self._seen[key] = [*(known for known in before if not weaker(told, known)), told]
        return True


def _without_results(event: Event, live: Collection[Unknown]) -> Event:
    """The event, with results that nobody can ask for any more told by their names only."""
    if all(u in live for u in event.results):
        return event
    forgotten = (u if u in live or not isinstance(u, Unknown) else Unknown(u.name, FORGOTTEN) for u in event.results)
    return replace(event, results=tuple(forgotten))


def _given(constraints: tuple[Constraint, ...]) -> Iterator[Unknown]:
    """The unknowns of the constraints that were there from the start."""
    return (u for u in mentioned(constraints) if u.serial <= 0)


def _beside(term: Process, more: Process) -> Process:
    return Par((*term.parts, more)) if isinstance(term, Par) else Par((term, more))


def _is_pause(leaf: Leaf) -> bool:
    """Is it the pause of a STREAM? The prelude stands in no text."""
    return leaf.name == "Delay" and leaf.site is None and leaf.arguments == (QUANTUM,)


def untimed(config: Config, memory: dict[Run, Run] | None = None) -> Config:
    """The configuration in which what takes an unknown time may end at any time. `memory` holds terms done before."""
    known = {} if memory is None else memory
    roots = []
    for number, term in config.roots:
        if (new := known.get(term)) is None:
            new = known[term] = _unhurried(term)
        roots.append((number, new))
    return Config(tuple(roots), config.store)


def _unhurried(term: Run) -> Run:
    if isinstance(term, Leaf):
        if term.name in DURATIONS and term.arguments and isinstance(term.arguments[0], Symbolic):
            return replace(term, name="Term", arguments=(inf,), age=0.0)
        return term
    if isinstance(term, Spawning) and len(term.bodies) > MOST_EQUAL:
        kept = [b for n, b in enumerate(term.bodies) if term.bodies[:n].count(b) < MOST_EQUAL]
        term = term if len(kept) == len(term.bodies) else replace(term, bodies=tuple(kept))
    parts = parts_of(term)
    new = tuple(map(_unhurried, parts))
    return term if all(a is b for a, b in zip(new, parts, strict=True)) else with_parts(term, new)
