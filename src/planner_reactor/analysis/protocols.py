"""Is a script that changes a reactor safe? Every way in which both can go on is looked at (R §5.5).

A script runs as a root of its own beside the reactor, as in the executer. Breadth first, so that what is broken is
shown by a shortest path, these laws are asked of every state:

    safe        no body is cut, and no KILL is reached while its reaction is at work
    consistent  every instance is served by reactions of one structure: before an adaptation, or after it
    atomic      the script never aborts, and nothing waits after its first KILL
    local       what is not named is neither held nor withdrawn, and what is named is not held up before it is drained
    bounded     from every state the script can still end, and no fair run goes round without its end

Weak fairness: what is possible from some moment on at every moment is done. A leaf is known by its place, so a leaf
that starves is seen. Basic processes end at any age within their windows.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Hashable, Iterable, Iterator, Mapping
from math import inf
from typing import Literal, TypeAlias

import msgspec

from planner_reactor.analysis.components import components, reaching
from planner_reactor.analysis.discovery import Discovery, path
from planner_reactor.analysis.explore import canonical
from planner_reactor.analysis.looking import Looking, finish
from planner_reactor.errors import BudgetError
from planner_reactor.rs.configurations import Config, Label, World
from planner_reactor.rs.evolves import started
from planner_reactor.rs.leaves import elapsed, offers, resting, slack, window
from planner_reactor.rs.reactions import REACTION, served_by
from planner_reactor.rs.serving import RULES
from planner_reactor.rs.states import Await, Ended, InstanceNumber, Leaf, Reaction, Run, Waiting, parts_of, spots
from planner_reactor.rs.store import Instance, Store
from planner_reactor.rs.terms import Number, Process, Schema, Value

Law: TypeAlias = Literal["safe", "consistent", "atomic", "local", "bounded"]
LAWS: tuple[Law, ...] = ("safe", "consistent", "atomic", "local", "bounded")

LIMIT = 50_000
"""States that are looked at unless a caller says otherwise."""

REACTOR, SCRIPT = 1, 2
"""The numbers of the two roots."""


class Protocol(msgspec.Struct, frozen=True, kw_only=True):
    """A reactor, a script beside it, and what the script is supposed to do.

    `named` are the situations that it may hold; `kills` and `adds` the labels that go and come, `later` those of the
    adaptations that the script makes after the first. A `patient` script also waits for what was retired to go: it
    must be able to end from every state, which is to end at last if outcomes are fair too. `store` is where it begins
    (for weaker readings of WAIT, see tests).
    """

    reactor: Process
    script: Process
    named: frozenset[str]
    kills: frozenset[Value]
    adds: frozenset[Value]
    later: tuple[tuple[frozenset[Value], frozenset[Value]], ...] = ()  # kills and adds
    patient: bool = False
    store: Store = msgspec.field(default_factory=Store)

    @property
    def removed(self) -> frozenset[Value]:
        """The labels that go, by any of its adaptations."""
        return self.kills.union(*(kills for kills, _ in self.later))

    def together(self, guards: Iterable[object]) -> bool:
        """Do reactions with these labels all belong to one of the structures that there are, one after the other?"""
        rounds = [(self.kills, self.adds), *self.later]
        first = max(next((n for n, (_, adds) in enumerate(rounds, 1) if g in adds), 0) for g in guards)
        last = min(next((n for n, (kills, _) in enumerate(rounds) if g in kills), len(rounds)) for g in guards)
        return first <= last


class Counterexample(msgspec.Struct, frozen=True):
    """The law that is broken, why, and a shortest path to it; the last `cycle` steps go round for ever."""

    law: Law
    why: str
    path: tuple[Label, ...]
    cycle: int = 0


class Checked(msgspec.Struct, frozen=True):
    """What was found: for each law that is broken a shortest counterexample."""

    broken: Mapping[Law, Counterexample]
    states: int

    @property
    def first(self) -> Counterexample | None:
        """The counterexample with the fewest steps."""
        return min(self.broken.values(), key=lambda c: len(c.path), default=None)


_Way: TypeAlias = tuple[int, frozenset[Hashable]]
"""Where a way round is, and who could have taken a step at every state so far and has not."""


class Move(msgspec.Struct, frozen=True):
    """A step: who took it, and where it leads."""

    label: Label
    after: int
    actor: Hashable


def check(protocol: Protocol, world: World, *, limit: int = LIMIT) -> Checked:
    """Ask every law. Raises `BudgetError` above `limit` states."""
    return finish(checking(protocol, world, limit=limit))


def checking(protocol: Protocol, world: World, *, limit: int = LIMIT) -> Looking[Checked]:
    """The same, state by state."""
    search = _Search(protocol, world)
    yield from search.running(limit)
    if (never := search.never_done()) is not None:
        search.broken.setdefault("bounded", never)
    return Checked(search.broken, len(search.states))


class _Search:
    """The states reached so far, and what is broken in them."""

    def __init__(self, protocol: Protocol, world: World) -> None:
        self.protocol = protocol
        self.world = world
        config = started(protocol.reactor, world, config=Config(store=protocol.store))
        self.met = Discovery(canonical(started(protocol.script, world, config=config)))
        self.states = self.met.states
        self.moves: list[tuple[Move, ...]] = []
        self.broken: dict[Law, Counterexample] = {}

    def running(self, limit: int) -> Looking[None]:
        """Reach every state up to the end of the script, and as long as it may be inconsistent after it."""
        for here, state in enumerate(self.states):  # grows while it is read
            found = []
            for label, after, actor in self._successors(state):
                new = len(self.met)
                number = self.met.number(after, here, label)
                if number >= limit:
                    raise BudgetError("states", f"more than {limit} states of reactor and script together")
                if number == new:
                    for law, why in self._breaches(after):
                        if law not in self.broken:
                            self.broken[law] = Counterexample(law, why, self.path(number))
                found.append(Move(label, number, actor))
            self.moves.append(tuple(found))
            yield

    def _successors(self, state: Config) -> Iterator[tuple[Label, Config, Hashable]]:
        if self.done(state) and not self._may_be_inconsistent(state):
            return
        urgent = False
        for offer in offers(state, self.world):
            urgent = urgent or offer.urgent
            spot = offer.changes[0][0]
            actor = (spot.root, spot.path, spot.guard, spot.owner)
            yield offer.label, canonical(offer.taken(state, self.world)), actor
        if not urgent and (pause := _next_edge(state, self.world)) < inf:
            yield ("TIME", (pause,), "ok", ()), canonical(elapsed(state, pause, self.world)), "time"

    def path(self, state: int) -> tuple[Label, ...]:
        """The labels of a shortest way to a state."""
        return path(self.met.origins, state)

    def done(self, state: Config) -> bool:
        return isinstance(state.root(SCRIPT), Ended)

    # -- laws of a state

    def _breaches(self, after: Config) -> Iterator[tuple[Law, str]]:
        yield from self._safe(after)
        yield from self._consistent(after)
        yield from self._atomic(after)
        yield from self._local(after)

    def _safe(self, after: Config) -> Iterator[tuple[Law, str]]:
        if after.store.cut:
            yield "safe", "a body in service is cut off"
        label = _about_to_kill(after)
        guarded = None if label is None else _guarded(after, label)
        if guarded is not None and not resting(guarded) and _at_work(guarded, self.world):
            yield "safe", f"KILL[{label}] is reached while its reaction is at work"

    def _consistent(self, after: Config) -> Iterator[tuple[Law, str]]:
        served: dict[InstanceNumber, set[object]] = {}
        for reaction, number in after.store.served:
            served.setdefault(number, set()).add(reaction.guard)
        for number, guards in served.items():
            if not self.protocol.together(guards):
                situation = next(i.situation for i in after.store.instances if i.number == number)
                yield "consistent", f"an instance of {situation} is served by the old reaction and by the new one"
        if self.done(after):
            for instance in after.store.instances:
                if self._left_alone(instance, after):
                    yield "consistent", f"an instance of {instance.situation} is left that no reaction serves"

    def _left_alone(self, instance: Instance, after: Config) -> bool:
        """Is it one that a removed reaction would have served, and nobody serves or may serve?"""
        store = after.store
        if instance.status != "on" or instance.withdrawn or store.in_service(instance.number):
            return False
        clauses = {n: c for c in self.world.program.clauses(REACTION) for n in _labels(c)}
        serving = [n for n, clause in clauses.items() if served_by(clause.body) == instance.situation]
        return not self.protocol.removed.isdisjoint(serving) and not any(
            _guarded(after, n) is not None and store.serves(Reaction(n, None), instance) for n in serving
        )

    def _may_be_inconsistent(self, state: Config) -> bool:
        """Is an instance alive that a removed reaction has served?"""
        return bool(self.protocol.adds) and any(r.guard in self.protocol.removed for r, _ in state.store.served)

    def _atomic(self, after: Config) -> Iterator[tuple[Law, str]]:
        term = after.root(SCRIPT)
        if isinstance(term, Ended) and not term.ok:
            yield "atomic", "the script aborts half-way"
        if self.protocol.patient or not _waits(term):
            return
        gone = [n for n in self.protocol.kills if _guarded(after, n) is None]
        if gone:
            yield "atomic", f"the script waits though P[{gone[0]}] is removed already"

    def _local(self, after: Config) -> Iterator[tuple[Law, str]]:
        store, named = after.store, self.protocol.named
        held = {h.situation for h in store.inhibitions if h.owner == SCRIPT} | {
            s for s, root in store.drains if root == SCRIPT
        }
        for situation in sorted(held - named):
            yield "local", f"{situation} is held, and the adaptation does not name it"
        for instance in store.instances:
            if instance.withdrawn and not named.intersection(_line(store, instance.number)):
                yield "local", f"an instance of {instance.situation} is withdrawn, and nothing above it is named"
        for entry in store.queue:
            if entry.situation not in held or entry.fate is not None or store.gone(entry.owner):
                continue
            if above := [s for s in _line(store, entry.owner) if s in named and s not in held]:
                yield "local", f"{above[0]} is held up at {entry.situation}, and is not drained yet"

    # -- is the script done at last?

    def never_done(self) -> Counterexample | None:
        """A run on which the script does not end: one that cannot, or one that goes round fairly."""
        goal = [n for n, state in enumerate(self.states) if self.done(state)]
        ending = reaching(([move.after for move in moves] for moves in self.moves), goal)
        trapped = next((n for n in range(len(self.states)) if n not in ending), None)
        waiting = {n for n, state in enumerate(self.states) if not self.done(state)}
        lasso = None if self.protocol.patient else self._lasso(waiting)
        stuck = None
        if trapped is not None:
            stuck = Counterexample("bounded", "from here on the script cannot end", self.path(trapped))
        return stuck or lasso

    def _lasso(self, within: set[int]) -> Counterexample | None:
        """The shortest of the weakly fair lassos, one for each component."""
        found: list[tuple[tuple[Label, ...], tuple[Label, ...]]] = []
        for component in components(self.moves, within):
            if self._is_fair(component):
                found += self._round(component)
        if not found:
            return None
        prefix, cycle = min(found, key=lambda way: len(way[0]) + len(way[1]))
        why = "the script may wait for ever, though everything else is fair"
        return Counterexample("bounded", why, (*prefix, *cycle), len(cycle))

    def _is_fair(self, component: frozenset[int]) -> bool:
        inner = [m for n in component for m in self.moves[n] if m.after in component]
        always = set.intersection(*({m.actor for m in self.moves[n]} for n in component))
        return bool(inner) and always <= {m.actor for m in inner}

    def _round(self, component: frozenset[int]) -> Iterator[tuple[tuple[Label, ...], tuple[Label, ...]]]:
        """The way in, and from there the shortest way back on which every actor has had its turn or no chance."""
        first = min(component, key=lambda n: (len(self.path(n)), n))
        start = (first, frozenset(m.actor for m in self.moves[first]))
        before: dict[_Way, tuple[_Way, Label]] = {}
        waiting = deque([start])
        while waiting:
            here = waiting.popleft()
            for move in self.moves[here[0]]:
                if move.after not in component:
                    continue
                owed = here[1].intersection(m.actor for m in self.moves[move.after]) - {move.actor}
                after = (move.after, frozenset(owed))
                if move.after == first and not owed:
                    yield self.path(first), (*_back(before, here, start), move.label)
                    return
                if after not in before and after != start:
                    before[after] = (here, move.label)
                    waiting.append(after)


def _back(before: Mapping[_Way, tuple[_Way, Label]], here: _Way, start: _Way) -> tuple[Label, ...]:
    labels = []
    while here != start:
        here, label = before[here]
        labels.append(label)
    return tuple(reversed(labels))


# -------------------------------------------------------------------------------------- what a configuration shows


def _next_edge(state: Config, world: World) -> float:
    """Seconds to the next beginning or end of an age window."""
    leaves = [spot.leaf for spot in state.spots() if isinstance(spot.leaf, Leaf)]
    edges = [round(edge - leaf.age, 9) for leaf in leaves for edge in window(leaf, world) if edge < inf]
    return min((edge for edge in edges if edge > 0), default=slack(state, world))


def _about_to_kill(state: Config) -> Value | None:
    for spot in spots(state.root(SCRIPT), SCRIPT):
        if isinstance(spot.leaf, Leaf) and spot.leaf.name == "KILL" and spot.leaf.arguments:
            return spot.leaf.arguments[0]
    return None


def _guarded(state: Config, label: Value) -> Run | None:
    """What stands beside the guard with this label, if it is there."""
    for spot in state.spots():
        if isinstance(spot.leaf, Leaf) and spot.leaf.name == "E" and spot.leaf.arguments == (label,):
            group = state.root(spot.root)
            for index in spot.path[:-1]:
                group = parts_of(group)[index]
            return parts_of(group)[1 - spot.path[-1]] if len(parts_of(group)) == 2 else group
    return None


def _at_work(term: Run, world: World) -> bool:
    """Is there anything in it that takes time? (What is urgent is over before the KILL has its turn.)"""
    if isinstance(term, Await | Waiting):
        return True
    if isinstance(term, Leaf):
        return term.name not in RULES and window(term, world)[1] > 0
    return any(_at_work(part, world) for part in parts_of(term))


def _labels(clause: Schema) -> Iterator[Value]:
    """The label of which this is the clause."""
    return (head.value for head in clause.head[:1] if isinstance(head, Number))


def _waits(term: Run) -> bool:
    return isinstance(term, Waiting) or any(_waits(part) for part in parts_of(term))


def _line(store: Store, number: int | None) -> Iterator[str]:
    """The situation of an instance, and those above it."""
    while number is not None and (instance := store.get(number)) is not None:
        yield instance.situation
        number = instance.owner
