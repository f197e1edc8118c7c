"""A network of intervals: what is known of how they lie to each other, kept path-consistent as it grows.

`constrain` narrows the relation between two intervals and propagates the consequences through every
triangle that it touches (Allen's propagation, R §7.4). Pairs about which nothing is known have no edge, so
that a network of many loosely related intervals stays sparse. Everything can be taken back: `mark`
remembers a state, `undo` returns to it, which is how a planner backtracks. Path consistency is not
consistency: for the complete answer see `scenarios`.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Iterator

from planner_reactor.logic.allen import ALL, BIT, HIGH, INVERSE, LOW, NONE, ROWS, SHIFT

Interval = Hashable
"""The name of an interval."""

_EQUAL = BIT["e"]


class Network:
    """Intervals and the sets of Allen relations between them. `consistent` is False once a
    contradiction was found.
    """

    __slots__ = ("_edges", "consistent", "trail")

    def __init__(self) -> None:
        self._edges: dict[Interval, dict[Interval, int]] = {}
        self.trail: list[tuple[Interval, Interval, int]] = []
        self.consistent = True

    @property
    def intervals(self) -> tuple[Interval, ...]:
        """All intervals, in the order in which they were first named."""
        return tuple(self._edges)

    def add(self, interval: Interval) -> None:
        """Name an interval of which nothing is known yet."""
        if interval not in self._edges:
            self._edges[interval] = {}

    def relation(self, first: Interval, second: Interval) -> int:
        """The set of relations still possible from `first` to `second`; `ALL` if nothing is known."""
        if first == second:
            return _EQUAL
        return self._edges.get(first, {}).get(second, ALL)

    def edges(self) -> Iterator[tuple[Interval, Interval, int]]:
        """Every pair of which something is known, once, in order."""
        place = {interval: n for n, interval in enumerate(self._edges)}
        for first, row in self._edges.items():
            for second in sorted(row, key=place.__getitem__):
                if place[first] < place[second]:
                    yield first, second, row[second]

    def constrain(self, first: Interval, second: Interval, relation: int) -> bool:
        """Let only `relation` hold from `first` to `second`, with all that follows by path consistency.

        False if that contradicts what is known: the network is then of no use until it is undone.
        """
        self.add(first)
        self.add(second)
        if first == second:
            self.consistent = self.consistent and bool(relation & _EQUAL)
        elif self.consistent:
            narrowed = self._edges[first].get(second, ALL) & relation
            if narrowed != self._edges[first].get(second, ALL):
                self.consistent = self._set(first, second, narrowed) and self._propagate(first, second)
        return self.consistent

    def extend(self, constraints: Iterable[tuple[Interval, Interval, int]]) -> bool:
        """`constrain` by each; False as soon as one contradicts."""
        return all(self.constrain(*constraint) for constraint in constraints)

    def mark(self) -> int:
        """A state to which `undo` can return."""
        return len(self.trail)

    def undo(self, mark: int) -> None:
        """Forget everything since `mark` but the names of intervals."""
        while len(self.trail) > mark:
            first, second, relation = self.trail.pop()
            if relation == ALL:
                del self._edges[first][second], self._edges[second][first]
            else:
                self._edges[first][second] = relation
                self._edges[second][first] = INVERSE[relation]
        self.consistent = True

    def copy(self) -> Network:
        """An independent network with the same relations and no history."""
        other = Network()
        other._edges = {interval: dict(row) for interval, row in self._edges.items()}
        other.consistent = self.consistent
        return other

    def _set(self, first: Interval, second: Interval, relation: int) -> bool:
        row = self._edges[first]
        self.trail.append((first, second, row.get(second, ALL)))
        row[second] = relation
        self._edges[second][first] = INVERSE[relation]
        return relation != NONE

    def _propagate(self, first: Interval, second: Interval) -> bool:
        """Narrow x - z by x - y - z for every pair x - y that has changed, until nothing changes.

        The body of `compose` stands here once more: this is the loop in which a planner's logic spends its time.
        """
        edges = self._edges
        waiting = {(first, second): None}  # used as an ordered set
        while waiting:
            a, b = next(iter(waiting))
            del waiting[a, b]
            for x, y in ((a, b), (b, a)):
                row = edges[x]
                xy = row[y]
                (low, high), (more_low, more_high) = ROWS[xy & LOW], ROWS[xy & HIGH]
                for z, yz in edges[y].items():
                    i, j = yz & LOW, yz >> SHIFT
                    via = low[i] | high[j] | more_low[i] | more_high[j]
                    if via != ALL and z != x:
                        known = row.get(z, ALL)
                        if known & ~via:
                            if not self._set(x, z, known & via):
                                return False
                            if (z, x) not in waiting:
                                waiting[x, z] = None
        return True
