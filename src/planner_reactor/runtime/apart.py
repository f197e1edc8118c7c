"""Host code that blocks runs in a thread of its own: the loop does not wait for it, whatever it does.

A process registered as `blocking` is, for the loop, a generator that waits for a signal: its thread posts the outcome.
So its window, its limit and what aborts it are those of any other. What is abandoned is given up: an exception is
raised in its thread, as soon as Python runs there again. That ends a loop, and it stops what has blocked too long from
going on as if it were in time. What never comes back from foreign code stays behind, in a thread that ends with the
program.

On a virtual clock nothing runs apart, for time would stand still meanwhile: there the function is called as it is.
"""

from __future__ import annotations

import ctypes
import threading
from collections import deque
from collections.abc import Callable, Generator
from contextlib import suppress
from queue import SimpleQueue
from typing import Any, TypeAlias

from planner_reactor.runtime.scheduler import Scheduler
from planner_reactor.runtime.signals import Signal

MOST = 64
"""Threads of one executer, those that stay behind included: more calls abort (cause error)."""

Ended: TypeAlias = Callable[[], Any]
"""How a call ended: gives what it returned, or raises what it raised."""


class GivenUp(BaseException):
    """Raised in the thread of a call that was abandoned. No `except Exception` holds it up."""


class Crowded(RuntimeError):
    """All threads are busy, or stay behind."""


class _Call:
    """One call, which ends once: by itself, or because it is given up."""

    def __init__(self, work: Callable[[], Any], ended: Callable[[Ended], object]) -> None:
        self.work = work
        self.thread = 0
        self._ended = ended
        self._lock = threading.Lock()
        self._over = False

    def begin(self) -> bool:
        """Here it is to run: is it still wanted?"""
        with self._lock:
            self.thread = threading.get_ident()
            return not self._over

    def end(self, how: Ended) -> None:
        with self._lock:
            if not self._over:
                self._over = True
                self._ended(how)

    def give_up(self) -> None:
        with self._lock:
            if not self._over:
                self._over = True
                ctypes.pythonapi.PyThreadState_SetAsyncExc(ctypes.c_ulong(self.thread), ctypes.py_object(GivenUp))


class Workers:
    """Threads that are made as they are needed, and used again."""

    def __init__(self) -> None:
        self._idle: deque[SimpleQueue[_Call]] = deque()
        self._count = 0

    def begin(self, work: Callable[[], Any], ended: Callable[[Ended], object]) -> _Call:
        """Call `work` in a thread; `ended` is called there. `Crowded` if there is none."""
        call = _Call(work, ended)
        if not self._idle:
            if self._count >= MOST:
                raise Crowded(f"all {MOST} threads for blocking processes are busy, or stay behind")
            self._count += 1
            calls = SimpleQueue[_Call]()
            thread = threading.Thread(target=self._serve, args=(calls,), name="blocking process", daemon=True)
            thread.start()
        else:
            calls = self._idle.popleft()
        calls.put(call)
        return call

    def _serve(self, calls: SimpleQueue[_Call]) -> None:
        while True:
            call = calls.get()
            with suppress(GivenUp):  # nobody waits for it any more
                if call.begin():
                    call.end(_ended(call.work))
            self._idle.append(calls)


def _ended(work: Callable[[], Any]) -> Ended:
    try:
        value = work()
    except GivenUp:
        raise
    except BaseException as problem:
        return _raising(problem)
    return lambda: value


def _raising(problem: BaseException) -> Ended:
    def ended() -> Any:
        raise problem

    return ended


def apart(
    routine: Callable[..., Any], scheduler: Scheduler, workers: Workers
) -> Callable[..., Generator[Signal, Ended, Any]]:
    """The routine as a generator function, which waits for it while it runs in a thread."""

    def run(*arguments: object) -> Generator[Signal, Ended, Any]:
        over = Signal()
        call = workers.begin(lambda: routine(*arguments), lambda how: scheduler.post(lambda: over.fire(how)))
        try:
            how = yield over
        except GeneratorExit:
            call.give_up()
            raise
        return how()

    return run
