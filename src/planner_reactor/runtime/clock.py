"""Two clocks with one face: virtual time, which jumps, and the wall clock, which waits.

The scheduler asks its clock to `reach` an instant and is told which instant it now is. On the virtual clock that is
always the one asked for; on the wall clock it may be earlier, because something was posted from another thread. Times
are seconds since the clock was made. Control uses the monotonic clock (rule TIME), never the time of day.
"""

from __future__ import annotations

import threading
import time
from typing import Protocol


class Clock(Protocol):
    """What a scheduler needs of time. `jumps`: any instant is reached at once."""

    @property
    def jumps(self) -> bool: ...

    def read(self) -> float:
        """The present instant, seconds; what jumps has none of its own: 0."""

    def reach(self, when: float) -> None:
        """Wait for the instant `when`, or until interrupted."""

    def interrupt(self) -> None:
        """End the present wait, or the next one at once. May be called from any thread."""


class VirtualClock:
    """Time that passes only when nothing is left to do at the present instant."""

    __slots__ = ()
    jumps = True

    def read(self) -> float:
        return 0.0

    def reach(self, when: float) -> None:
        """There is nothing to wait for."""

    def interrupt(self) -> None:
        """Nothing waits on this clock."""


class WallClock:
    """The machine's monotonic clock."""

    __slots__ = ("_origin", "_woken")
    jumps = False

    def __init__(self) -> None:
        self._origin = time.monotonic()
        self._woken = threading.Event()

    def read(self) -> float:
        return time.monotonic() - self._origin

    def reach(self, when: float) -> None:
        if self._woken.wait(min(max(0.0, when - self.read()), threading.TIMEOUT_MAX)):
            self._woken.clear()

    def interrupt(self) -> None:
        self._woken.set()
