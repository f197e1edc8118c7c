"""What holds up the loop is interrupted: host code that computes or blocks, and never yields.

Everything runs in one thread, so that `while True: pass` in one process would hold up all others for ever. With
patience a thread beside the loop looks at whether the same call of a process is still running, and if so sends the
loop's thread a signal, whose handler raises `HeldUp` there: the call aborts (cause error) like one that raised. It is
raised only where host code stands, never in the middle of the executer.

For the wall clock and the main thread, where Python handles signals; elsewhere, and in foreign code that does not come
back, only the watchdog outside helps (docs/hosts.md). A call that is known to block belongs in a thread (`apart`).
"""

from __future__ import annotations

import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType
from typing import Any

OURS = ("planner_reactor.runtime", "planner_reactor.reactor", "planner_reactor.link", "planner_reactor.trace")
"""Where nothing may be interrupted."""


class HeldUp(BaseException):
    """Raised in host code that holds up the loop. No `except Exception` of it stands in the way."""


class Patience:
    """Calls host code, and knows whether a call lasts. `seconds` is how long one may hold up the loop."""

    def __init__(self, seconds: float) -> None:
        self.seconds = seconds
        self._turn = 0  # counts the calls
        self._inside = False  # is host code running?

    def call(self, routine: Callable[..., Any], *arguments: Any) -> Any:
        """What the routine returns or raises, or `HeldUp`."""
        self._turn += 1
        self._inside = True
        try:
            return routine(*arguments)
        finally:
            self._inside = False

    @contextmanager
    def kept(self) -> Iterator[None]:
        """Look after the calls of this thread meanwhile; without effect where that cannot be done."""
        if threading.current_thread() is not threading.main_thread() or not hasattr(signal, "pthread_kill"):
            yield
            return
        before = signal.signal(signal.SIGUSR1, self._interrupted)
        over = threading.Event()
        looking = threading.Thread(target=self._look, args=(threading.get_ident(), over), daemon=True)
        looking.start()
        try:
            yield
        finally:
            over.set()
            looking.join()
            signal.signal(signal.SIGUSR1, before)

    def _look(self, thread: int, over: threading.Event) -> None:
        """Half the time it may take has passed twice, and it is the same call."""
        seen = 0
        while not over.wait(self.seconds / 2):
            turn = self._turn
            if self._inside and turn == seen:
                signal.pthread_kill(thread, signal.SIGUSR1)
            seen = turn

    def _interrupted(self, number: int, frame: FrameType | None) -> None:
        if self._inside and frame is not None and _is_host_code(frame):
            raise HeldUp(
                f"held up the loop for {self.seconds:g} s: it should yield, or be registered with blocking=True"
            )


def _is_host_code(frame: FrameType) -> bool:
    """Does host code stand here, or foreign code that it was called as?"""
    return frame.f_code is Patience.call.__code__ or not frame.f_globals.get("__name__", "").startswith(OURS)
