"""What the cell has sensed for and against each assumption of R §8.2, and what it therefore says of it.

An assumption *holds* (True) when there was evidence for it and none against it for `quiet_s`; it *fails*
(False) while evidence against it is fresh; it is *unknown* (None) when nothing was seen either way. Unknown
is never taken for false. Subjects that are no assumptions (camera, gripper, ready) only tell the record of
the run that something was sensed.
"""

from __future__ import annotations

from collections.abc import Callable

from planner_reactor.runtime.scheduler import Scheduler
from planner_reactor.trace import Trace

ASSUMPTIONS = ("AQ", "AS", "AF", "ACT", "ACP", "ADT", "AM", "ADD", "AO")
"""In the order in which the planner relaxes them (R §8.2)."""

SELF_REPORTED = ("AM",)
"""Reported by the process that notices (R §8.3); the others by a monitor that asks."""

_NEVER = float("-inf")


class Evidence:
    """For and against, with times. `report(assumption, text)` hears of self-reported ones, `sensed(subject)`
    of all.
    """

    def __init__(self, scheduler: Scheduler, quiet_s: float, trace: Trace | None = None) -> None:
        self.report: Callable[[str, str], None] = lambda assumption, text: None
        self.sensed: Callable[[str], None] = lambda subject: None
        self.counts = dict.fromkeys(ASSUMPTIONS, 0)
        self._scheduler = scheduler
        self._quiet_s = quiet_s
        self._trace = trace
        self._against = dict.fromkeys(ASSUMPTIONS, _NEVER)
        self._for = dict.fromkeys(ASSUMPTIONS, _NEVER)
        self._said: dict[str, str] = {}

    def against(self, assumption: str, text: str) -> None:
        """Something was sensed that cannot be if the assumption holds."""
        self._against[assumption] = self._scheduler.now
        self.counts[assumption] += 1
        self.sensed(assumption)
        if self._trace is not None and self._said.get(assumption) != text:
            self._said[assumption] = text
            self._trace.record("evidence", assumption=assumption, against=text)
        if assumption in SELF_REPORTED:
            self.report(assumption, text)

    def supports(self, assumption: str) -> None:
        """Something was sensed that bears the assumption out."""
        self._for[assumption] = self._scheduler.now

    def note(self, subject: str) -> None:
        """A sensor showed something that is about no assumption."""
        self.sensed(subject)

    def holds(self, assumption: str) -> bool | None:
        """True, False, or None for unknown."""
        against, borne_out = self._against[assumption], self._for[assumption]
        if against > _NEVER and self._scheduler.now - against <= self._quiet_s:
            return False
        return True if borne_out > against else None

    def forget(self, assumption: str) -> None:
        """Evidence against it no longer counts: what it was about says itself that it is over."""
        self._against[assumption] = _NEVER
        self._for[assumption] = self._scheduler.now
