"""A situation that fails too often is given up for a time: the restart intensity limit.

What fails is asked for again at once by its REASSERT, and nothing in the papers ends that (a planner may be absent, or
out of plans). More than `failures` failures of one situation within `window` seconds are a *storm*: the situation is
disabled, as if it rested on an assumption "it does not fail like this" that has failed; the planner is told. It is
enabled again when an adaptation of it is applied: new reactions deserve a new trial. If the situation is a root's,
nothing would be left that acts for the goal: that is a safe stop, as by the stop button (law 15).
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable
from typing import TYPE_CHECKING

import msgspec

from planner_reactor.errors import InputError

if TYPE_CHECKING:
    from planner_reactor.reactor.reactor import Reactor

COUNTED = frozenset({"failed", "error", "budget"})
"""Causes of failures that count: what was withdrawn, or rests on a failed assumption, did not fail by itself."""


class Intensity(msgspec.Struct, frozen=True, kw_only=True):
    """More than so many `failures` of one situation within `window` seconds are a storm."""

    failures: int
    window: float

    def __post_init__(self) -> None:
        if self.failures < 1 or not self.window > 0:
            raise InputError(f"{self.failures} failures in {self.window} s, expected at least 1, in more than 0 s")


class Storms:
    """Counts the failures of each situation of a reactor. Without an intensity nothing is ever a storm."""

    def __init__(self, reactor: Reactor, intensity: Intensity | None) -> None:
        self._reactor = reactor
        self._intensity = intensity
        self._failures: dict[str, deque[float]] = {}
        self.count = 0

    def failed(self, situation: str, cause: str) -> None:
        """An instance of the situation has failed."""
        if self._intensity is None or cause not in COUNTED:
            return
        now = self._reactor.scheduler.now
        times = self._failures.setdefault(situation, deque())
        times.append(now)
        while times[0] < now - self._intensity.window:
            times.popleft()
        if len(times) > self._intensity.failures:
            del self._failures[situation]
            self._reactor.executer.after_step(lambda: self._storm(situation))

    def _storm(self, situation: str) -> None:
        reactor = self._reactor
        self.count += 1
        reactor.trace.record("storm", situation=situation)
        reactor.perceive("storm", situation)
        if any(situation in r.asserts for r in reactor.reactions.values() if r.situation is None):
            reactor.halt()
        else:
            reactor.assumptions.storms(situation)

    def changed(self, situations: Iterable[str]) -> None:
        """Adaptations of these were applied: their new reactions begin with a clean record."""
        for situation in situations:
            self._failures.pop(situation, None)
            self._reactor.assumptions.calms(situation)
