"""Simple temporal networks: how far points of time may lie apart, kept closed as they grow, with reasons.

`far(x, y)` is the most that y can lie behind x; a bound narrows it and everything that follows by shortest paths
(Dechter, Meiri and Pearl, *Temporal constraint networks*, AIJ 49, 1991). A contradiction is a cycle of negative length;
`conflict` are the reasons of its bounds. Lengths are whole numbers of *ticks*: a microsecond is 2**20 of them, and
"strictly less" is less by one tick, so that sums are exact and equality means equality.
"""

from __future__ import annotations

from collections.abc import Iterable

TICKS = 1000 << 20
"""Ticks in a millisecond."""


def ticks(milliseconds: float) -> int:
    """A duration of the domain, to the microsecond, in ticks."""
    return round(milliseconds * 1000) << 20


def milliseconds(length: int) -> float:
    """What a number of ticks is in milliseconds."""
    return length / TICKS


class TimeNetwork:
    """Points 0, 1, 2 … and the distances between them. `consistent` is False once a contradiction was found."""

    __slots__ = ("_far", "_trail", "_why", "conflict", "consistent")

    def __init__(self) -> None:
        self._far: list[dict[int, int]] = []
        self._why: list[dict[int, int]] = []
        self._trail: list[tuple[int, int, int | None, int]] = []
        self.consistent = True
        self.conflict = 0

    def __len__(self) -> int:
        return len(self._far)

    def point(self) -> int:
        """A new point, of which nothing is known."""
        self._far.append({len(self._far): 0})
        self._why.append({})
        return len(self._far) - 1

    def far(self, first: int, second: int) -> int | None:
        """The most that `second` can lie behind `first`, in ticks; None if nothing bounds it."""
        return self._far[first].get(second)

    def why(self, first: int, second: int) -> int:
        """The reasons for `far`."""
        return self._why[first].get(second, 0)

    def bound(self, first: int, second: int, most: int, reason: int = 0) -> bool:
        """Let `second` lie at most `most` ticks behind `first` (negative: at least so much before it)."""
        if not self.consistent:
            return False
        back = self._far[second].get(first)
        if back is not None and back + most < 0:
            self.conflict = reason | self.why(second, first)
            self.consistent = False
            return False
        known = self._far[first].get(second)
        if known is None or most < known:
            self._spread(first, second, most, reason)
        return True

    def changes(self, mark: int) -> Iterable[tuple[int, int]]:
        """The pairs of points that came closer since a mark, each once."""
        return dict.fromkeys((first, second) for first, second, _, _ in self._trail[mark:])

    def mark(self) -> int:
        """A state to which `undo` can return."""
        return len(self._trail)

    def undo(self, mark: int) -> None:
        """Forget everything since `mark` but the points."""
        while len(self._trail) > mark:
            first, second, known, why = self._trail.pop()
            if known is None:
                del self._far[first][second], self._why[first][second]
            else:
                self._far[first][second], self._why[first][second] = known, why
        self.consistent = True
        self.conflict = 0

    def solution(self) -> list[int]:
        """A time for every point, in ticks: as early as the points before it allow, and no two the same by chance.

        The distances are closed, so what suits the points so far can always be extended to the next.
        """
        times: list[int] = []
        for point, row in enumerate(self._far):
            before = ((times[p], self._far[p].get(point)) for p in range(point))
            latest = min((time + most for time, most in before if most is not None), default=None)
            earliest = max((times[q] - d for q, d in row.items() if q < point), default=None)
            if earliest is None:
                earliest = latest - TICKS if latest is not None else 0
            slack = TICKS if latest is None else latest - earliest
            times.append(earliest + min(slack // 2, (point + 1) << 20))
        return times

    def _spread(self, first: int, second: int, most: int, reason: int) -> None:
        beyond = list(self._far[second].items())
        for x, row in enumerate(self._far):
            before = row.get(first)
            if before is None:
                continue
            known = row.get(second)
            if known is not None and before + most >= known:
                continue
            why = reason | self._why[x].get(first, 0)
            for y, after in beyond:
                known = row.get(y)
                if x != y and (known is None or before + most + after < known):
                    self._trail.append((x, y, known, self._why[x].get(y, 0)))
                    row[y] = before + most + after
                    self._why[x][y] = why | self._why[second].get(y, 0)
