"""Two clocks with one face: virtual time, which jumps, and the wall clock, which waits.

The scheduler asks its clock to `reach` an instant and is told which instant it now is. On the virtual clock
that is always the one asked for; on the wall clock it may be earlier, because something was posted from
another thread. Times are seconds since the clock was made. Control uses the monotonic clock (rule TIME),
never the time of day.
"""

from __future__ import annotations

import threading
import time
from math import inf
from typing import Protocol


class Clock(Protocol):
    """What a scheduler needs of time."""

    def read(self) -> float:
        """The present instant, seconds."""

    def reach(self, when: float) -> float:
        """Wait for the instant `when` (`inf`: for ever), or until interrupted; returns the present instant.

        A clock that cannot wait for ever returns `inf` when asked to: then nothing more will happen.
        """

    def interrupt(self) -> None:
        """End the present wait, or the next one at once. May be called from any thread."""


class VirtualClock:
    """Time that passes only when nothing is left to do at the present instant."""

    __slots__ = ("_now",)

    def __init__(self) -> None:
        self._now = 0.0

    def read(self) -> float:
        return self._now

    def reach(self, when: float) -> float:
        if when < inf:
            self._now = when
        return when

    def interrupt(self) -> None:
        """Nothing waits on this clock."""


class WallClock:
    """The machine's monotonic clock."""

    __slots__ = ("_origin", "_woken")

    def __init__(self) -> None:
        self._origin = time.monotonic()
        self._woken = threading.Event()

    def read(self) -> float:
        return time.monotonic() - self._origin

    def reach(self, when: float) -> float:
        now = self.read()
        if now >= when:
            return now
        self._woken.wait(None if when == inf else when - now)
        self._woken.clear()
        return self.read()

    def interrupt(self) -> None:
        self._woken.set()
