"""A quantity that changes at instants and stays in between: what the papers plot (R Figs 12 to 19).

Times are seconds on the run's clock. Of several changes at one instant only the last counts.
"""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from collections.abc import Iterable, Iterator

import msgspec


class Staircase(msgspec.Struct, frozen=True):
    """`values[n]` from `times[n]` on, until the next; `start` before the first."""

    times: tuple[float, ...] = ()
    values: tuple[float, ...] = ()
    start: float = 0.0

    @classmethod
    def through(cls, points: Iterable[tuple[float, float]], *, start: float = 0.0) -> Staircase:
        """The staircase through these points, in order of time."""
        times: list[float] = []
        values: list[float] = []
        for time, value in points:
            if times and times[-1] == time:
                values[-1] = value
            elif not values or values[-1] != value:
                times.append(time)
                values.append(value)
        return cls(tuple(times), tuple(values), start)

    @classmethod
    def counting(cls, times: Iterable[float]) -> Staircase:
        """One more at each of these instants."""
        return cls.through((time, float(n)) for n, time in enumerate(times, 1))

    def at(self, time: float) -> float:
        """The value at an instant."""
        place = bisect_right(self.times, time)
        return self.values[place - 1] if place else self.start

    def steps(self, begin: float, end: float) -> Iterator[tuple[float, float]]:
        """The corners from `begin` to `end`, both ends included: what to draw with `steps-post`."""
        yield begin, self.at(begin)
        for place in range(bisect_right(self.times, begin), bisect_left(self.times, end)):
            yield self.times[place], self.values[place]
        yield end, self.at(end)

    def reaches(self, value: float, *, after: float = 0.0) -> float | None:
        """The first instant from `after` on at which it is at least `value`."""
        if self.at(after) >= value:
            return after
        return next((t for t, v in zip(self.times, self.values, strict=True) if t >= after and v >= value), None)

    def plateaus(self) -> tuple[float, ...]:
        """The values one after the other, without those that another took the place of at the same instant."""
        found = [self.start] if not self.times or self.times[0] > 0 else []
        for value in self.values:
            if not found or found[-1] != value:
                found.append(value)
        return tuple(found)
