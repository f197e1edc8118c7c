"""A network that is propagated only where it matters: along the chords of its graph of constraints.

If the graph has a chord in every circle of more than three edges, path consistency of its triangles alone is as good as
that of all pairs, for sets of relations from a class such as ORD-Horn (Bliek and Sam-Haroud, *Path consistency on
triangulated constraint graphs*, IJCAI 1999; Chmeiss and Condotta, *Consistency of triangulated temporal qualitative
constraint networks*, ICTAI 2011). The search of `solving` narrows thousands of times; loosely related intervals then
stay loose.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import cast

from planner_reactor.logic.allen import ALL, HIGH, INVERSE, LOW, ROWS, SHIFT
from planner_reactor.logic.justified import Justified
from planner_reactor.logic.network import Interval


class Chordal(Justified):
    """A `Justified` network over intervals 0, 1, 2 … and the chords given at its start, which cannot grow."""

    __slots__ = ()

    def __init__(self, chords: Iterable[tuple[int, int]], size: int) -> None:
        super().__init__()
        for interval in range(size):
            self.add(interval)
        for first, second in chords:
            for one, other in ((first, second), (second, first)):
                self._edges[one][other] = ALL
                self._why[one][other] = 0

    def undo(self, mark: int) -> None:
        while len(self.trail) > mark:
            first, second, relation = self.trail.pop()
            self._edges[first][second], self._edges[second][first] = relation, INVERSE[relation]
            self._why[first][second] = self._why[second][first] = self._past.pop()
        self.consistent = True
        self.conflict = 0

    def has(self, first: int, second: int) -> bool:
        """Is this pair a chord?"""
        return second in self._edges[first]

    def near(self, interval: int) -> Iterable[int]:
        """The intervals to which it has a chord."""
        return cast(Iterable[int], self._edges[interval])

    def known(self) -> list[tuple[int, int, int]]:
        """The chords about which something is known, each once."""
        edges = cast(dict[int, dict[int, int]], self._edges)
        return [(a, b, known) for a, row in edges.items() for b, known in row.items() if a < b and known != ALL]

    def changes(self, mark: int) -> Iterable[tuple[int, int]]:
        """The chords that were narrowed since a mark, each once."""
        return cast(Iterable[tuple[int, int]], dict.fromkeys((a, b) for a, b, _ in self.trail[mark:]))

    def _follow(self, waiting: dict[tuple[Interval, Interval], None]) -> bool:
        edges, whys = self._edges, self._why
        while waiting:
            a, b = next(iter(waiting))
            del waiting[a, b]
            for x, y in ((a, b), (b, a)):
                row, why, beyond, known_beyond = edges[x], whys[x], whys[y], edges[y]
                (low, high), (more_low, more_high) = ROWS[row[y] & LOW], ROWS[row[y] & HIGH]
                for z, known in row.items():
                    yz = known_beyond.get(z, ALL)
                    if yz != ALL:
                        i, j = yz & LOW, yz >> SHIFT
                        via = low[i] | high[j] | more_low[i] | more_high[j]
                        if known & ~via:
                            if not self._narrow(x, z, known & via, why[y] | beyond[z] | why[z]):
                                return False
                            if (z, x) not in waiting:
                                waiting[x, z] = None
        return True


def triangulated(pairs: Iterable[tuple[int, int]], size: int) -> list[tuple[int, int]]:
    """These pairs of the numbers below `size` with the chords that they lack; those of least degree go first."""
    near = [0] * size
    for first, second in pairs:
        near[first] |= 1 << second
        near[second] |= 1 << first
    found: list[tuple[int, int]] = []
    left = list(range(size))
    while left:
        least = min(left, key=lambda point: (near[point].bit_count(), point))
        left.remove(least)
        around = near[least]
        for point in _numbers(around):
            found.append((min(least, point), max(least, point)))
            near[point] = (near[point] | around) & ~(1 << point | 1 << least)
    return sorted(found)


def _numbers(bits: int) -> list[int]:
    found = []
    while bits:
        found.append((bits & -bits).bit_length() - 1)
        bits &= bits - 1
    return found
