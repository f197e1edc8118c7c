"""The papers' measure of improvement, from assumptions alone (R §9.2.3, Fig. 19).

    M = (#SAP + #SAR) + 2 (#RAP + #RAR) + (#AE before − #AE now)

S: supported, that is used and holding; R: retracted, that is used before and not now; P, R: in the planner, in the
reactor; AE: the assumptions that hold in the environment, as far as the reactor has been told. Retractions count
twice to make up for what they take from the first term. The last term lasts for one `TICK`. Plotted is 1/M, from M > 0.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterable

import msgspec

from planner_reactor.experiments.staircases import Staircase

TICK = 1.0
"""Seconds from t−1 to t."""


class Members(msgspec.Struct, frozen=True):
    """A set that changes at instants: `sets[n]` from `times[n]` on, empty before."""

    times: tuple[float, ...]
    sets: tuple[frozenset[str], ...]

    @classmethod
    def through(cls, points: Iterable[tuple[float, frozenset[str]]]) -> Members:
        """The set through these points, in order of time; of several at one instant the last counts."""
        found: dict[float, frozenset[str]] = {}
        for time, members in points:
            found[time] = members
        return cls(tuple(found), tuple(found.values()))

    def at(self, time: float) -> frozenset[str]:
        """The set at an instant."""
        place = bisect_right(self.times, time)
        return self.sets[place - 1] if place else frozenset()

    def ever(self, time: float) -> frozenset[str]:
        """Everything that has been a member up to an instant."""
        return frozenset().union(*self.sets[: bisect_right(self.times, time)])

    @property
    def count(self) -> Staircase:
        """How many members."""
        return Staircase.through((t, float(len(s))) for t, s in zip(self.times, self.sets, strict=True))


def improvement(planner: Members, reactor: Members, failing: Members, *, tick: float = TICK) -> Staircase:
    """M over time: assumptions used by planner and reactor, and those that do not hold."""
    changes = {*planner.times, *reactor.times, *failing.times, *(t + tick for t in failing.times)}
    return Staircase.through((t, _measure(planner, reactor, failing, t, tick)) for t in sorted(changes))


def _measure(planner: Members, reactor: Members, failing: Members, time: float, tick: float) -> float:
    false = failing.at(time)
    supported = sum(len(side.at(time) - false) for side in (planner, reactor))
    retracted = sum(len(side.ever(time) - side.at(time)) for side in (planner, reactor))
    lost = len(false) - len(failing.at(time - tick))
    return supported + 2 * retracted + lost
