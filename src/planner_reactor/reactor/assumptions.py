"""What the reactor knows of assumptions, and what follows: behaviour that rests on a failed one is disabled (law 14).

A monitor says that an assumption fails, or that a failed one holds again; a process may notice by itself (through the
host), and as nobody polls for it, what it noticed is repeated while something rests on it. What is known survives a
crash with the journal.
"""

from __future__ import annotations

from collections.abc import Callable

from planner_reactor.link.messages import PerceptionKind
from planner_reactor.reactor.journal import Assumed, Journal
from planner_reactor.reactor.situations import Situations
from planner_reactor.runtime import Scheduler

REPEAT = 2.0
"""Seconds after which a failure that a process noticed is sent again (R §9.2.3; the monitors' period in R §8.3)."""


class Assumptions:
    """`failed` holds the assumptions that fail, and since when; `told(kind, assumption)` hears of every report."""

    def __init__(
        self,
        scheduler: Scheduler,
        journal: Journal,
        situations: Situations,
        told: Callable[[PerceptionKind, str], None],
    ) -> None:
        self._scheduler = scheduler
        self._journal = journal
        self._situations = situations
        self._told = told
        self.failed: dict[str, float] = {}

    def restored(self) -> None:
        """What the journal knows of: it fails until it is sensed to hold."""
        self.failed = dict.fromkeys(self._journal.state.committed.failed, self._scheduler.now)

    def resting_on(self, assumption: str) -> tuple[str, ...]:
        return self._journal.state.committed.resting_on(assumption)

    def sensed(self, assumption: str, holds: bool) -> None:
        """A monitor, or a process itself, says that an assumption fails, or that a failed one holds again."""
        now = self._scheduler.now
        if not holds:
            if assumption not in self.failed:
                self.failed[assumption] = now
                self._journal.note(Assumed(assumption, False, now))
            self._told("assumption_failure", assumption)
        elif self.failed.pop(assumption, None) is not None:
            self._journal.note(Assumed(assumption, True, now))
            self._told("assumption_holds", assumption)
        else:
            return
        self.enable()
        self.disable()

    def noticed(self, assumption: str, holds: bool, evidence: str) -> None:
        """A process noticed by itself: a failure is sent again while something rests on it (nobody asks)."""
        known = assumption in self.failed
        self.sensed(assumption, holds)
        if not holds and not known:
            self._repeat_later(assumption, self.failed[assumption])

    def _repeat_later(self, assumption: str, since: float) -> None:
        def repeat() -> None:
            if self.failed.get(assumption) == since and self.resting_on(assumption):
                self.sensed(assumption, False)
                self._repeat_later(assumption, since)

        self._scheduler.call_after(REPEAT, repeat)

    def disable(self) -> None:
        """Every situation that rests on a failed assumption is disabled by it."""
        for assumption in self.failed:
            for name in self.resting_on(assumption):
                self._situations.disable(name, assumption)

    def enable(self) -> None:
        """No situation is disabled by an assumption that holds, or on which it does not rest any more."""
        rests_on = self._journal.state.committed.rests_on
        for situation in self._situations.held:
            for owner in [h.owner for h in situation.inhibitions if h.kind == "assumption"]:
                assumption = str(owner[1])  # type: ignore[index]  # ("assumption", name)
                if assumption not in self.failed or assumption not in rests_on.get(situation.name, ()):
                    self._situations.enable(situation.name, assumption)
