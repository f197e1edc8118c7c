"""What may not be told before the journal is known again (law 8).

A COMMIT that could be appended and not synced leaves nobody knowing whether it is on the disk: a crash may bring it
back. The adaptation is not applied, and it is not refused either, as far as the planner is told, until the journal has
been begun anew without it. Should the reactor crash before, what it says of the versions that stand is the answer.
"""

from __future__ import annotations

from collections.abc import Callable

from planner_reactor.reactor.journal import Journal
from planner_reactor.runtime import Scheduler

AGAIN = 1.0
"""Seconds after which the journal is tried again."""


class Doubts:
    """Holds back what depends on a journal that is not trusted."""

    def __init__(self, scheduler: Scheduler, journal: Journal) -> None:
        self._scheduler = scheduler
        self._journal = journal
        self._waiting: list[Callable[[], object]] = []

    def settle(self, told: Callable[[], object], *, doubtful: bool) -> None:
        """Call `told`; what is doubtful as soon as the journal is known to hold what its state says."""
        if self._journal.trusted or not doubtful:
            told()
            return
        self._waiting.append(told)
        if len(self._waiting) == 1:
            self._scheduler.call_after(AGAIN, self._try)

    def _try(self) -> None:
        if not self._journal.renew(self._scheduler.now):
            self._scheduler.call_after(AGAIN, self._try)
            return
        waiting, self._waiting = self._waiting, []
        for told in waiting:
            told()
