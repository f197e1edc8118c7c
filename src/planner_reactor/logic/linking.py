"""The qualitative and the metric network of the same intervals, kept in step (after Kautz and Ladkin, *Integrating
metric and qualitative temporal reasoning*, AAAI 1991).

What relations say of end points become bounds of the metric network; a base relation that no times can have becomes
impossible in the qualitative one. This goes back and forth until nothing changes, with the reasons handed over.
Interval i has the points 2i and 2i + 1.
"""

from __future__ import annotations

from collections.abc import Iterable

from planner_reactor.logic.allen import ALL
from planner_reactor.logic.chordal import Chordal
from planner_reactor.logic.stn import TimeNetwork
from planner_reactor.logic.subclasses import LESS, MORE, SAME, signs

_FAR = 1 << 120


class Linked:
    """A qualitative network over the intervals 0, 1, 2 …, beside it a metric one if there is anything metric."""

    __slots__ = ("_done", "conflict", "network", "times")

    def __init__(self, network: Chordal, times: TimeNetwork | None) -> None:
        self.network = network
        self.times = times
        self.conflict = 0
        self._done = (0, 0)
        if times is not None:
            for _ in network.intervals:
                start, end = times.point(), times.point()
                times.bound(end, start, -1)

    def constrain(self, first: int, second: int, relation: int, reason: int) -> bool:
        """Narrow a relation, with all that follows; False, and `conflict`, if that contradicts what is known."""
        if not self.network.constrain(first, second, relation, reason):
            self.conflict = self.network.conflict
            return False
        return self.settle()

    def bound(self, first: int, second: int, most: int, reason: int) -> bool:
        """Bound a distance of points, in ticks; what follows for relations is found by `settle`."""
        assert self.times is not None
        if not self.times.bound(first, second, most, reason):
            self.conflict = self.times.conflict
            return False
        return True

    def mark(self) -> tuple[int, int]:
        return self.network.mark(), 0 if self.times is None else self.times.mark()

    def undo(self, mark: tuple[int, int]) -> None:
        self.network.undo(mark[0])
        if self.times is not None:
            self.times.undo(mark[1])
        self._done = (min(self._done[0], mark[0]), min(self._done[1], mark[1]))

    def settle(self) -> bool:
        """Hand over what has changed until nothing changes."""
        if self.times is None:
            return True
        while self._done != self.mark():
            narrowed = self.network.changes(self._done[0])
            self._done = (self.network.mark(), self._done[1])
            if not all(self._to_times(first, second) for first, second in narrowed):
                return False
            closer = self.times.changes(self._done[1])
            self._done = (self._done[0], self.times.mark())
            if not all(self._to_network(first, second) for first, second in self._touched(closer)):
                return False
        return True

    def _touched(self, points: Iterable[tuple[int, int]]) -> dict[tuple[int, int], None]:
        """The pairs of intervals for which points that came closer can matter."""
        found: dict[tuple[int, int], None] = {}
        for one, other in points:
            first, second = sorted((one >> 1, other >> 1))
            if first != second:
                found[first, second] = None
            else:
                found.update(dict.fromkeys((min(first, z), max(first, z)) for z in self.network.near(first)))
        return found

    def _to_times(self, first: int, second: int) -> bool:
        why = self.network.why(first, second)
        found = signs(self.network.relation(first, second))
        for pair, allowed in enumerate(found):
            x, y = 2 * first + (pair >> 1), 2 * second + (pair & 1)
            strict = 0 if allowed & SAME else -1
            if not allowed & MORE and not self.bound(y, x, strict, why):
                return False
            if not allowed & LESS and not self.bound(x, y, strict, why):
                return False
        return True

    def _to_network(self, first: int, second: int) -> bool:
        if not self.network.has(first, second):
            return True
        assert self.times is not None
        known = self.network.relation(first, second)
        points = (2 * first, 2 * first + 1, 2 * second, 2 * second + 1)
        far = [[self.times.far(x, y) for y in points] for x in points]
        left = fitting([[_FAR if d is None else d for d in row] for row in far], known)
        if left == known:
            return True
        why = 0
        for x in points:
            for y in points:
                why |= self.times.why(x, y)
        if not self.network.constrain(first, second, left, why):
            self.conflict = self.network.conflict
            return False
        return True


def fitting(far: list[list[int]], relation: int) -> int:
    """The base relations of a set that two intervals can have, whose four end points lie at most so `far` apart."""
    found = 0
    for n in range(relation.bit_length()):
        if relation >> n & 1 and _fits(far, signs(1 << n)):
            found |= 1 << n
    return found & ALL


def _fits(far: list[list[int]], base: tuple[int, int, int, int]) -> bool:
    least = [row[:] for row in far]
    for pair, sign in enumerate(base):
        x, y = pair >> 1, 2 + (pair & 1)
        if sign != MORE:
            least[y][x] = min(least[y][x], -1 if sign == LESS else 0)
        if sign != LESS:
            least[x][y] = min(least[x][y], -1 if sign == MORE else 0)
    for k in range(4):
        for row in least:
            for j in range(4):
                if row[k] + least[k][j] < row[j]:
                    row[j] = row[k] + least[k][j]
    return all(least[k][k] >= 0 for k in range(4))
