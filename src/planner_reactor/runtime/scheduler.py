"""One scheduler owns time, order and randomness; everything that runs, runs in its loop.

Actions that are due `soon` (at the present instant) come first, in order; then the timers, by time and,
among equal times, first come first served. `post` is the one door for other threads. Random numbers come
from named streams seeded from the scheduler's seed, so that a draw in one place never shifts those of
another, and a run depends on its seed alone. It knows nothing of processes.
"""

from __future__ import annotations

import random
from collections import deque
from collections.abc import Callable
from heapq import heapify, heappop, heappush
from itertools import count
from math import inf
from typing import Protocol

from planner_reactor.runtime.clock import Clock

Action = Callable[[], object]

STALE_BEFORE_SWEEP = 512
"""Cancelled timers that may lie in the queue before it is swept (and only when they are more than half of
it).
"""


class Timed(Protocol):
    """What stands in the queue: it is told when its instant has come, and says whether it still waits for
    it.
    """

    def elapsed(self, ticket: int) -> None: ...

    def awaits(self, ticket: int) -> bool: ...


class Timer:
    """An action that is due at an instant; `cancel` takes it back (without effect once it has run)."""

    __slots__ = ("_action", "_scheduler", "when")

    def __init__(self, scheduler: Scheduler, when: float, action: Action) -> None:
        self.when = when
        self._scheduler = scheduler
        self._action: Action | None = action

    @property
    def active(self) -> bool:
        return self._action is not None

    def cancel(self) -> None:
        if self._action is not None:
            self._action = None
            self._scheduler.withdrawn()

    def elapsed(self, ticket: int) -> None:
        action, self._action = self._action, None
        if action is not None:
            action()

    def awaits(self, ticket: int) -> bool:
        return self._action is not None


class Scheduler:
    """Runs actions in order of time. `now` is the present instant in seconds; it stands still while actions
    run.
    """

    __slots__ = ("_queue", "_soon", "_stale", "_stopped", "_streams", "_tickets", "clock", "now", "seed")

    def __init__(self, clock: Clock, *, seed: int = 0) -> None:
        self.clock = clock
        self.seed = seed
        self.now = clock.read()
        self._queue: list[tuple[float, int, Timed]] = []
        self._tickets = count(1)
        self._soon: deque[Action] = deque()
        self._stale = 0
        self._stopped = False
        self._streams: dict[str, random.Random] = {}

    def call_at(self, when: float, action: Action) -> Timer:
        """Run the action at this instant (now, if that is past)."""
        timer = Timer(self, max(when, self.now), action)
        heappush(self._queue, (timer.when, next(self._tickets), timer))
        return timer

    def call_after(self, delay: float, action: Action) -> Timer:
        """Run the action after so many seconds."""
        return self.call_at(self.now + delay, action)

    def soon(self, action: Action) -> None:
        """Run the action at the present instant, after what is already due. For the scheduler's own thread."""
        self._soon.append(action)

    def post(self, action: Action) -> None:
        """Run the action as soon as possible. May be called from any thread."""
        self._soon.append(action)
        self.clock.interrupt()

    def wait(self, when: float, waiter: Timed) -> int:
        """Tell the waiter at this instant, if it still `awaits` the ticket returned (cheaper than a Timer)."""
        ticket = next(self._tickets)
        heappush(self._queue, (when, ticket, waiter))
        return ticket

    def withdrawn(self) -> None:
        """A timer or a waiter no longer awaits its ticket: sweep the queue when most of it is like that."""
        self._stale += 1
        if self._stale > STALE_BEFORE_SWEEP and self._stale * 2 > len(self._queue):
            self._queue[:] = [entry for entry in self._queue if entry[2].awaits(entry[1])]
            heapify(self._queue)
            self._stale = 0

    def random(self, stream: str) -> random.Random:
        """The generator of this name; the same seed and name give the same draws in every process."""
        if (found := self._streams.get(stream)) is None:
            found = self._streams[stream] = random.Random(f"{self.seed}/{stream}")
        return found

    def stop(self) -> None:
        """Let `run` return after the present action."""
        self._stopped = True

    def run(self, until: float | None = None) -> None:
        """Run what is due, in order, up to and including the instant `until`.

        Returns when that instant is reached, when `stop` was called, or (virtual clock) when nothing is
        left to do. On the wall clock without `until` it waits for what is posted, until `stop`.
        """
        self._stopped = False
        limit = inf if until is None else until
        queue, soon, reach = self._queue, self._soon, self.clock.reach
        while not self._stopped:
            if soon:
                soon.popleft()()
                continue
            when = queue[0][0] if queue else inf
            if when > self.now:
                if when > limit and self.now >= limit:
                    return
                reached = reach(when if when < limit else limit)
                if reached == inf:
                    return
                self.now = reached
                if reached < when:
                    continue
            _, ticket, timed = heappop(queue)
            timed.elapsed(ticket)

    @property
    def idle(self) -> bool:
        """Is nothing due, now or later?"""
        return not self._soon and not self._queue
