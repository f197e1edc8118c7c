"""A network that remembers why: for every pair, which of the reasons given led to what is known of it.

A reason is a bit of a whole number; what follows from several carries the bits of all of them. So a contradiction names
the constraints that it needs (`conflict`), the search of `solving` knows how far to jump back, and a constraint can be
taken back out of order (`retract`): only what rests on it is forgotten and derived anew.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from planner_reactor.logic.allen import ALL, HIGH, INVERSE, LOW, ROWS, SHIFT
from planner_reactor.logic.network import Interval, Network


class Justified(Network):
    """A `Network` whose constraints have reasons. After a contradiction `conflict` holds the bits of a set of
    reasons that suffice for it (not always a minimal one, see `explaining`).
    """

    __slots__ = ("_given", "_past", "_why", "conflict")

    def __init__(self) -> None:
        super().__init__()
        self._why: dict[Interval, dict[Interval, int]] = {}
        self._past: list[int] = []
        self._given: dict[tuple[Interval, Interval], list[tuple[int, int]]] = {}
        self.conflict = 0

    def add(self, interval: Interval) -> None:
        super().add(interval)
        self._why.setdefault(interval, {})

    def why(self, first: Interval, second: Interval) -> int:
        """The reasons for what is known of two intervals; 0 if nothing is known, or if it needs none."""
        return self._why.get(first, {}).get(second, 0)

    def constrain(self, first: Interval, second: Interval, relation: int, reason: int = 0) -> bool:
        """As in `Network`; `reason` are the bits of what says so."""
        if first == second:
            self.add(first)
            if not super().constrain(first, second, relation):
                self.conflict = reason
            return self.consistent
        self.add(first)
        self.add(second)
        if self.consistent:
            known = self._edges[first].get(second, ALL)
            if known & relation != known:
                self.consistent = self._narrow(first, second, known & relation, reason | self.why(first, second))
                self.consistent = self.consistent and self._follow({(first, second): None})
        return self.consistent

    def undo(self, mark: int) -> None:
        trail = self.trail
        while len(trail) > mark:
            first, second, relation = trail.pop()
            why = self._past.pop()
            if relation == ALL:
                for one, other in ((first, second), (second, first)):
                    del self._edges[one][other], self._why[one][other]
            else:
                self._edges[first][second], self._edges[second][first] = relation, INVERSE[relation]
                self._why[first][second] = self._why[second][first] = why
        self.consistent = True
        self.conflict = 0

    def copy(self) -> Justified:
        other = Justified()
        other._edges = {interval: dict(row) for interval, row in self._edges.items()}
        other._why = {interval: dict(self._why[interval]) for interval in self._edges}
        other.consistent, other.conflict = self.consistent, self.conflict
        return other

    def retract(self, reason: int, given: Iterable[tuple[Interval, Interval, int, int]]) -> bool:
        """Forget all that rests on a reason; `given` are the constraints that remain, each with its reason.

        The network is then what these constraints alone would have made of it, and can only be undone to a mark made
        after this.
        """
        lost = [edge for edge in self._pairs() if self.why(*edge) & reason]
        for first, second in lost:
            for one, other in ((first, second), (second, first)):
                del self._edges[one][other], self._why[one][other]
        self.trail.clear()
        self._past.clear()
        self.consistent, self.conflict = True, 0
        again = dict.fromkeys(lost)
        ends = dict.fromkeys(interval for edge in lost for interval in edge)
        for first, second, relation, bits in given:
            if ((first, second) in again or (second, first) in again) and not self.constrain(
                first, second, relation, bits
            ):
                return False
        around = {(x, y): None for x in ends for y in self._edges[x]}
        self.consistent = self._follow(around)
        return self.consistent

    def _pairs(self) -> Iterator[tuple[Interval, Interval]]:
        return ((first, second) for first, second, _ in self.edges())

    def _narrow(self, first: Interval, second: Interval, relation: int, why: int) -> bool:
        self._past.append(self._why[first].get(second, 0))
        self._why[first][second] = self._why[second][first] = why
        if not self._set(first, second, relation):
            self.conflict = why
            return False
        return True

    def _follow(self, waiting: dict[tuple[Interval, Interval], None]) -> bool:
        """The loop of `Network`, with reasons."""
        edges, whys = self._edges, self._why
        while waiting:
            a, b = next(iter(waiting))
            del waiting[a, b]
            for x, y in ((a, b), (b, a)):
                row, why, beyond = edges[x], whys[x], whys[y]
                xy, reason = row[y], why[y]
                (low, high), (more_low, more_high) = ROWS[xy & LOW], ROWS[xy & HIGH]
                for z, yz in edges[y].items():
                    i, j = yz & LOW, yz >> SHIFT
                    via = low[i] | high[j] | more_low[i] | more_high[j]
                    if via != ALL and z != x:
                        known = row.get(z, ALL)
                        if known & ~via:
                            if not self._narrow(x, z, known & via, reason | beyond[z] | why.get(z, 0)):
                                return False
                            if (z, x) not in waiting:
                                waiting[x, z] = None
        return True
