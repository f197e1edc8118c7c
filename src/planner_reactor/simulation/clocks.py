"""The time of day, which jumps. Control may use monotonic time only (rule TIME), so nothing may come of it.

Within its context `time.time` gives the simulated time of day to everything in the process. A case with jumps and the
same case without must have the same trace.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Self

from planner_reactor.runtime import Scheduler

BEGINNING = 1.0e9


class TimeOfDay:
    """Seconds since 1970, as people set them."""

    def __init__(self, scheduler: Scheduler) -> None:
        self.offset = BEGINNING
        self._scheduler = scheduler
        self._real: Callable[[], float] = time.time

    def read(self) -> float:
        return self._scheduler.now + self.offset

    def __enter__(self) -> Self:
        self._real = time.time
        time.time = self.read
        return self

    def __exit__(self, *problem: object) -> None:
        time.time = self._real
