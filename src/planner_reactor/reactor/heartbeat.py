"""The executive's life sign: it kicks a watchdog outside, and stops if that has had to stop the machine.

No Python is a safety function: the watchdog is a device of its own, behind the host, and what it does when a kick is
missed (a controlled stop) it does without asking. The executive kicks only while it turns its own loop and none of its
laws is broken. A watchdog that has tripped answers False: then the reactor halts, and nothing resumes by itself: both
are reset by people (laws 15, 17).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from planner_reactor.runtime import Watchdog

if TYPE_CHECKING:
    from planner_reactor.reactor.reactor import Reactor


class Heartbeat:
    """Kicks the watchdog of a reactor's host, if it has one, `watchdog.period` seconds apart."""

    def __init__(self, reactor: Reactor) -> None:
        self._reactor = reactor
        self.kicks = 0

    def start(self) -> None:
        if (watchdog := self._reactor.host.watchdog) is not None:
            self._beat(watchdog)

    def _beat(self, watchdog: Watchdog) -> None:
        reactor = self._reactor
        reactor.scheduler.call_after(watchdog.period, lambda: self._beat(watchdog))
        if reactor.halted or reactor.laws.violations:
            return
        self.kicks += 1
        if not watchdog.kick(reactor.scheduler.now):
            reactor.trace.record("watchdog", tripped=True)
            reactor.halt()
