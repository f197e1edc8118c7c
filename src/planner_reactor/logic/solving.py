"""The complete search: is there a world in which all statements hold, and if not, which of them contradict?

First everything is propagated. Then a world is guessed that suits what is known (`ordering`, or the metric network's
earliest times), and looked at: a statement that does not hold in it, or a resource of which too much is used at one
time, is what to split. A relation is split into ORD-Horn parts, for which propagation decides (Nebel, *Solving hard
qualitative temporal reasoning problems*, Constraints 1, 1997); beside durations into convex parts, for which the
metric network decides; an overuse into the orders of two of its users. A contradiction names its reasons, so the search
jumps back to the last choice among them (conflict-directed backjumping, Prosser 1993), and pairs that were in
contradictions are split first (weights after Boussemart et al., ECAI 2004). What is never wrong in a guess is never
split.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import combinations

import msgspec

from planner_reactor.errors import BudgetError
from planner_reactor.logic.allen import base_relation, relations
from planner_reactor.logic.chordal import Chordal, triangulated
from planner_reactor.logic.linking import Linked
from planner_reactor.logic.ordering import places
from planner_reactor.logic.problems import Apart, Capacity, End, Interval, Lasts, Lies, Statement, Uses, intervals_of
from planner_reactor.logic.stn import TimeNetwork, milliseconds, ticks
from planner_reactor.logic.subclasses import Class, parts

GUESSES = 100_000
_BEFORE, _AFTER = relations(["b", "m"]), relations(["bi", "mi"])
_Choice = tuple[int, int, int]


class Answer(msgspec.Struct, frozen=True):
    """`times` is the start and end of each interval in one world, or None; then `core` are the numbers of statements
    that suffice for the contradiction. Times are places on a line, or milliseconds (`metric`).
    """

    times: dict[Interval, tuple[float, float]] | None
    core: tuple[int, ...] = ()
    metric: bool = False
    guesses: int = 0
    worlds: int = 0


def solve(statements: Sequence[Statement], intervals: Iterable[Interval] = (), *, limit: int = GUESSES) -> Answer:
    """A world in which all statements hold, or statements of which no world holds all.

    `intervals` are further ones that no statement names. Complete; BudgetError after `limit` guesses, for the
    question is NP-complete.
    """
    return _Search(statements, intervals, limit).run()


def closure(statements: Sequence[Statement]) -> list[tuple[Interval, int, Interval]] | None:
    """What propagation alone knows of pairs of intervals, from relations and durations together; None if they
    contradict each other at once.
    """
    search = _Search(statements, (), GUESSES, complete=True)
    if not search.propagate():
        return None
    return [(search.names[a], known, search.names[b]) for a, b, known in sorted(search.linked.network.known())]


@dataclass(slots=True)
class _Split:
    """A choice between alternatives of which one must be so; `core` are the reasons of those that failed."""

    mark: tuple[int, int]
    pair: tuple[int, int]
    alternatives: list[_Choice]
    core: int


@dataclass(slots=True)
class _Resource:
    capacity: int
    why: int
    users: list[tuple[int, int, int]]  # interval, amount, reason


class _Search:
    def __init__(
        self, statements: Sequence[Statement], intervals: Iterable[Interval], limit: int, *, complete: bool = False
    ) -> None:
        self.statements = statements
        self.names = tuple(dict.fromkeys((*intervals_of(statements), *intervals)))
        self.number = {name: n for n, name in enumerate(self.names)}
        self.metric = any(isinstance(said, (Lasts, Apart)) for said in statements)
        self.kind: Class = "convex" if self.metric else "ord_horn"
        self.lies = [
            (self.number[said.first], self.number[said.second], said.relation)
            for said in statements
            if isinstance(said, Lies) and said.first != said.second
        ]
        self.resources = self._resources()
        chords = self._chords(complete or self.metric or bool(self.resources))
        self.linked = Linked(chords, TimeNetwork() if self.metric else None)
        self.splits: list[_Split] = []
        self.weights: dict[tuple[int, int], int] = {}
        self.liked = list(range(2 * len(self.names)))
        self.limit, self.guesses, self.worlds = limit, 0, 0

    def propagate(self) -> bool:
        """State everything; False if that contradicts itself at once."""
        return all(self._state(said, 1 << n) for n, said in enumerate(self.statements)) and self.linked.settle()

    def run(self) -> Answer:
        if not self.propagate():
            return self._contradiction(self.linked.conflict)
        wrong: list[tuple[int, int]] = []
        while True:
            wrong = [pair for pair in wrong if len(parts(self.linked.network.relation(*pair), self.kind)) > 1]
            if not wrong:
                world = self._world()
                wrong = self._not_held(world)
                overuse = None if wrong else self._overused(world)
                if not wrong and overuse is None:
                    return self._found(world)
            if wrong:
                pair = max(wrong, key=self._urgency)
                known = self.linked.network.relation(*pair)
                self._split([(*pair, part) for part in parts(known, self.kind)], self.linked.network.why(*pair))
            elif overuse is not None:
                self._split(*overuse)
            depth = len(self.splits)
            core = self._next()
            if core is not None:
                return self._contradiction(core)
            if len(self.splits) < depth:
                wrong = []

    # ------------------------------------------------------------------------------------------ what is stated

    def _chords(self, complete: bool) -> Chordal:
        size = len(self.names)
        if complete:
            return Chordal(combinations(range(size), 2), size)
        return Chordal(triangulated(((a, b) for a, b, _ in self.lies), size), size)

    def _state(self, said: Statement, reason: int) -> bool:
        match said:
            case Lies(first=first, relation=relation, second=second):
                return self.linked.constrain(self.number[first], self.number[second], relation, reason)
            case Lasts(interval=interval, least=least, most=most):
                return self._apart((interval, 0), (interval, 1), least, most, reason)
            case Apart(first=first_end, second=second_end, least=least, most=most):
                return self._apart(first_end, second_end, least, most, reason)
            case Uses(resource=name, amount=amount):
                resource = self.resources.get(name)
                if resource is None or amount <= resource.capacity:
                    return True
                self.linked.conflict = resource.why | reason
                return False
            case Capacity():
                return True

    def _apart(self, first: End, second: End, least: float, most: float | None, reason: int) -> bool:
        one, other = 2 * self.number[first[0]] + first[1], 2 * self.number[second[0]] + second[1]
        return self.linked.bound(other, one, -ticks(least), reason) and (
            most is None or self.linked.bound(one, other, ticks(most), reason)
        )

    def _resources(self) -> dict[object, _Resource]:
        """Those of which there is only so much."""
        found: dict[object, _Resource] = {}
        for n, said in enumerate(self.statements):
            if isinstance(said, Capacity):
                known = found.get(said.resource)
                if known is None or said.amount < known.capacity:
                    found[said.resource] = _Resource(said.amount, 1 << n, [])
        for n, said in enumerate(self.statements):
            if isinstance(said, Uses) and said.resource in found:
                found[said.resource].users.append((self.number[said.interval], said.amount, 1 << n))
        return found

    # ------------------------------------------------------------------------------------------ worlds, and their flaws

    def _world(self) -> list[int]:
        self.worlds += 1
        if self.linked.times is not None:
            return self.linked.times.solution()
        self.liked = places(len(self.names), self.linked.network.known(), self.liked)
        return self.liked

    def _not_held(self, world: list[int]) -> list[tuple[int, int]]:
        return [
            (a, b)
            for a, b, relation in self.lies
            if not base_relation((world[2 * a], world[2 * a + 1]), (world[2 * b], world[2 * b + 1])) & relation
        ]

    def _overused(self, world: list[int]) -> tuple[list[_Choice], int] | None:
        """Ways to end an overuse in this world, and the reasons why it is one: of some users that together take too
        much, and none of which could be spared, two cannot overlap.
        """
        for resource in self.resources.values():
            for user in resource.users:
                now = world[2 * user[0]]
                together = [u for u in resource.users if world[2 * u[0]] <= now < world[2 * u[0] + 1]]
                if sum(amount for _, amount, _ in together) > resource.capacity:
                    return self._orders(_least(together, resource.capacity), resource.why)
        return None

    def _orders(self, users: list[tuple[int, int, int]], why: int) -> tuple[list[_Choice], int]:
        found: list[_Choice] = []
        for (a, _, reason), (b, _, other) in combinations(users, 2):
            why |= reason | other | self.linked.network.why(a, b)
            known = self.linked.network.relation(a, b)
            found += [(a, b, order) for order in (_BEFORE, _AFTER) if known & order]
        return found, why

    def _urgency(self, pair: tuple[int, int]) -> tuple[int, int]:
        return self.weights.get(pair, 0), -self.linked.network.relation(*pair).bit_count()

    # ------------------------------------------------------------------------------------------ choices

    def _split(self, alternatives: list[_Choice], why: int) -> None:
        pair = alternatives[0][:2] if alternatives else (0, 0)
        self.splits.append(_Split(self.linked.mark(), pair, alternatives[::-1], why))

    def _next(self) -> int | None:
        """Take the next alternative that does not contradict at once; the reasons of the contradiction if none is
        left.
        """
        while True:
            split = self.splits[-1]
            bit = 1 << (len(self.statements) + len(self.splits) - 1)
            self.linked.undo(split.mark)
            if split.alternatives:
                first, second, relation = split.alternatives.pop()
                self.guesses += 1
                if self.guesses > self.limit:
                    raise BudgetError("guesses", f"no world found or excluded within {self.limit} guesses")
                if self.linked.constrain(first, second, relation, bit):
                    return None
                core = self.linked.conflict
                self._blame((first, second))
                if core & bit:
                    split.core |= core & ~bit
                    continue
            else:
                core = split.core
            self._jump(core)
            if not self.splits:
                return core

    def _jump(self, core: int) -> None:
        """Back to the last choice among these reasons."""
        self.splits.pop()
        while self.splits:
            bit = 1 << (len(self.statements) + len(self.splits) - 1)
            if core & bit:
                self.splits[-1].core |= core & ~bit
                self._blame(self.splits[-1].pair)
                return
            self.linked.undo(self.splits.pop().mark)

    def _blame(self, pair: tuple[int, int]) -> None:
        self.weights[pair] = self.weights.get(pair, 0) + 1

    # ------------------------------------------------------------------------------------------ answers

    def _found(self, world: list[int]) -> Answer:
        if self.metric:
            first = min(world, default=0)
            shown: list[float] = [milliseconds(time - first) for time in world]
        else:
            rank = {place: n for n, place in enumerate(sorted(set(world)))}
            shown = [rank[place] for place in world]
        times = {name: (shown[2 * n], shown[2 * n + 1]) for n, name in enumerate(self.names)}
        return Answer(times, (), self.metric, self.guesses, self.worlds)

    def _contradiction(self, core: int) -> Answer:
        stated = tuple(n for n in range(len(self.statements)) if core >> n & 1)
        return Answer(None, stated, self.metric, self.guesses, self.worlds)


def _least(users: list[tuple[int, int, int]], capacity: int) -> list[tuple[int, int, int]]:
    """Some of the users that still take too much together, and none of which could be spared."""
    left = users
    for user in users:
        without = [other for other in left if other is not user]
        if sum(amount for _, amount, _ in without) > capacity:
            left = without
    return left
