"""Resources: of steps that together would take too much, not all can go on at once (R §7.1, §7.2: resource use).

Steps of one plan that share a resource take turns. In which order follows from a schedule by their durations, so that
the next thing is looked for while this one is still being placed: each step as soon as it can, of several the one
with the most to come after it. If that lasts longer than what no order could avoid, other orders of those that compete
are tried, up to `TRIES`, and the shortest is kept. A resource is so many tracks; who follows whom on a track is a
*turn*: an order of the plan that nothing but a resource asks for.

What an abstract action takes is what its schema says; what the basic ones of its own plan take they take when they
run, and between situations the host serves one after the other.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import islice, permutations

import msgspec

from planner_reactor.logic.allen import inverse
from planner_reactor.logic.domain import Domain
from planner_reactor.logic.formulas import Atom
from planner_reactor.planner.plan import BEFORE, CONTAINS, Plan, Turn
from planner_reactor.planner.structure import lasting
from planner_reactor.planner.thinking import Work

TRIES = 60
PAUSE = 8
"""So many steps are scheduled in one unit of work."""
MOST_COMPETING = 8
"""If more steps compete for resources, no other order is tried."""

_Linked = dict[int, list[int]]


class Schedule(msgspec.Struct, frozen=True):
    """When everything is done (milliseconds), and which steps follow each other on a resource."""

    makespan: float
    turns: tuple[Turn, ...]


def share_out(domain: Domain, plan: Plan) -> Work[bool]:
    """Give the steps that share resources their turns; False if that cannot be."""
    claims: dict[Atom, dict[int, int]] = {}
    for step in plan.steps:
        for demand in step.schema.uses:
            resource = plan.bindings.ground(demand.resource.shifted(step.offset))
            users = claims.setdefault(resource, {})
            users[step.number] = users.get(step.number, 0) + demand.amount
    capacity = {resource: domain.resources[resource.predicate].capacity for resource in claims}
    scarce = {resource: users for resource, users in claims.items() if sum(users.values()) > capacity[resource]}
    if not scarce:
        return True
    schedule = yield from Sharing(plan, scarce, capacity).best()
    if schedule is None:
        return False
    plan.turns.extend(schedule.turns)
    return True


class Sharing:
    """The steps of a plan, their durations and orders. `scarce`: resource → step → how much of it it takes."""

    def __init__(self, plan: Plan, scarce: Mapping[Atom, Mapping[int, int]], capacity: Mapping[Atom, int]) -> None:
        self.capacity = capacity
        self.lasts = {step.number: lasting(step.schema) for step in plan.steps}
        self.after: _Linked = {number: [] for number in self.lasts}
        self.inside: _Linked = {number: [] for number in self.lasts}
        for first, second, relation in plan.network.edges():
            if isinstance(first, int) and isinstance(second, int) and {first, second} <= self.lasts.keys():
                self._note(first, second, relation)
                self._note(second, first, inverse(relation))
        for number, inner in self.inside.items():
            self.lasts[number] = max([self.lasts[number], *(self.lasts[n] for n in inner)])
        self.before = _reversed(self.after)
        order = sorted(self.lasts, key=lambda n: (len(self.before[n]), n))
        self._head = self._longest(order, self.before)
        self.tail = self._longest(order[::-1], self.after)
        self.needs: dict[int, list[tuple[Atom, int]]] = {}
        for resource, users in scarce.items():
            for number, amount in users.items():
                self.needs.setdefault(number, []).append((resource, amount))
        self._scarce = scarce

    def _note(self, first: int, second: int, relation: int) -> None:
        if relation & ~BEFORE == 0:
            self.after[first].append(second)
        elif relation & ~CONTAINS == 0:
            self.inside[first].append(second)

    def _longest(self, order: list[int], linked: _Linked) -> dict[int, float]:
        """The longest chain that ends, or begins, with each step."""
        found: dict[int, float] = {}
        for number in order:
            found[number] = self.lasts[number] + max((found[other] for other in linked[number]), default=0.0)
        return found

    @property
    def bound(self) -> float:
        """No order is done sooner (milliseconds): the longest chain; a resource's work, and what must lie around it."""
        found = max(self._head.values(), default=0.0)
        for resource, users in self._scarce.items():
            work = sum(self.lasts[n] * amount for n, amount in users.items()) / self.capacity[resource]
            first = min(self._head[n] - self.lasts[n] for n in users)
            found = max(found, first + work + min(self.tail[n] - self.lasts[n] for n in users))
        return found

    def best(self) -> Work[Schedule | None]:
        """The shortest schedule found; None if there is none."""
        bound = self.bound
        best: Schedule | None = None
        for wishes in self._wishes():
            found = yield from _Scheduling(self, wishes).run()
            if found is not None and (best is None or found.makespan < best.makespan):
                best = found
            if best is not None and best.makespan <= bound:
                break
        return best

    def _wishes(self) -> Iterator[tuple[int, ...]]:
        """Orders in which those that compete are to be served; the first: as it comes."""
        yield ()
        if len(self.needs) <= MOST_COMPETING:
            yield from islice(permutations(sorted(self.needs, key=lambda n: (-self.tail[n], n))), TRIES)


class _Scheduling:
    """One schedule. On each track of a resource: until when it is taken, and by whom last."""

    def __init__(self, sharing: Sharing, wishes: tuple[int, ...]) -> None:
        self.sharing = sharing
        self.wishes = wishes
        self.tracks = {resource: [(0.0, -1)] * amount for resource, amount in sharing.capacity.items()}
        self.ends: dict[int, float] = {}
        self.turns: list[Turn] = []

    def run(self) -> Work[Schedule | None]:
        """Each step as soon as it can be; None if it cannot be in the order wished."""
        sharing = self.sharing
        waits = {n: len(before) for n, before in sharing.before.items()}
        for inner in sharing.inside.values():
            for n in inner:
                waits[n] += 1
        earliest = dict.fromkeys(sharing.lasts, 0.0)
        ready = [number for number, count in waits.items() if not count]
        wished = iter(self.wishes)
        turn = next(wished, None)
        while ready:
            if len(self.ends) % PAUSE == 0:
                yield
            able = [n for n in ready if n not in sharing.needs or turn in (None, n)]
            if not able:
                return None
            start, _, number = min((max(earliest[n], self._free(n)), -sharing.tail[n], n) for n in able)
            if number == turn:
                turn = next(wished, None)
            ready.remove(number)
            self._take(number, start)
            for when, others in ((self.ends[number], sharing.after[number]), (start, sharing.inside[number])):
                for other in others:
                    earliest[other] = max(earliest[other], when)
                    waits[other] -= 1
                    if not waits[other]:
                        ready.append(other)
        return self._made()

    def _free(self, number: int) -> float:
        """When there is enough of all that the step takes."""
        needs = self.sharing.needs.get(number, ())
        return max((sorted(self.tracks[resource])[amount - 1][0] for resource, amount in needs), default=0.0)

    def _take(self, number: int, start: float) -> None:
        self.ends[number] = end = start + self.sharing.lasts[number]
        for resource, amount in self.sharing.needs.get(number, ()):
            tracks = self.tracks[resource]
            free = [track for track, (until, _) in enumerate(tracks) if until <= start]
            free.sort(key=lambda track: (tracks[track][1] not in self.sharing.before[number], -tracks[track][0]))
            for track in free[:amount]:
                last = tracks[track][1]
                if last >= 0:
                    self.turns.append((last, number))
                tracks[track] = (end, number)

    def _made(self) -> Schedule | None:
        """None if something would outlast what it must happen within."""
        for number, inner in self.sharing.inside.items():
            if any(self.ends[n] > self.ends[number] for n in inner):
                return None
        return Schedule(max(self.ends.values()), tuple(dict.fromkeys(self.turns)))


def _reversed(linked: _Linked) -> _Linked:
    found: _Linked = {number: [] for number in linked}
    for number, others in linked.items():
        for other in others:
            found[other].append(number)
    return found
