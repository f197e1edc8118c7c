"""One scheduler owns time, order and randomness; everything that runs, runs in its loop.

Actions that are due `soon` (at the present instant) come first, in order; then what waits for an instant, by time and,
among equal times, first come first served. `post` is the one door for other threads. Random numbers come from named
streams seeded from the scheduler's seed, so that a draw in one place never shifts those of another, and a run depends
on its seed alone. It knows nothing of processes.

What waits is kept in one bucket per instant, and only the instants in a heap: periods and rounds make many coincide.
"""

from __future__ import annotations

import random
import sys
from collections import deque
from collections.abc import Callable
from heapq import heapify, heappop, heappush
from typing import Any, Protocol, TypeAlias

from planner_reactor.runtime.clock import Clock

Action = Callable[[], object]

END_OF_TIME = sys.float_info.max
"""What waits for a later instant waits for ever."""

SWEEP_FROM = 512
"""Cancelled entries that may lie in the queue before it is first swept."""


class Timed(Protocol):
    """What waits for an instant on behalf of a subject."""

    def elapsed(self, entry: Entry) -> None:
        """The instant has come; without effect if the entry is no longer awaited."""

    def awaits(self, entry: Entry) -> bool: ...


Entry: TypeAlias = tuple[Timed, Any]
"""(what waits, its subject); told apart by identity."""


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

    def elapsed(self, entry: Entry) -> None:
        action, self._action = self._action, None
        if action is not None:
            action()

    def awaits(self, entry: Entry) -> bool:
        return self._action is not None


class Scheduler:
    """Runs actions in order of time. `now` is the present instant in seconds; it stands still while actions run."""

    __slots__ = ("_attended", "_buckets", "_instants", "_present", "_soon", "_stale", "_stopped", "_streams",
                 "_sweep_at", "clock", "now", "seed")  # fmt: skip

    def __init__(self, clock: Clock, *, seed: int = 0) -> None:
        self.clock = clock
        self.seed = seed
        self.now = clock.read()
        self._instants: list[float] = []
        self._buckets: dict[float, Entry | list[Entry]] = {}
        self._present: list[Entry] = []  # what is still due at the present instant, last first
        self._soon: deque[Action] = deque()
        self._stale = 0
        self._sweep_at = SWEEP_FROM
        self._stopped = False
        self._attended = self.now
        self._streams: dict[str, random.Random] = {}

    def call_at(self, when: float, action: Action) -> Timer:
        """Run the action at this instant (now, if that is past)."""
        timer = Timer(self, when if when > self.now else self.now, action)
        self.wait(timer.when, (timer, None))
        return timer

    def call_after(self, delay: float, action: Action) -> Timer:
        """Run the action after so many seconds."""
        return self.call_at(self.now + delay, action)

    def soon(self, action: Action) -> None:
        """Run the action at the present instant, before what waits for it. For the scheduler's own thread."""
        self._soon.append(action)

    def post(self, action: Action) -> None:
        """Run the action as soon as possible. May be called from any thread."""
        self._soon.append(action)
        self.clock.interrupt()

    def wait(self, when: float, entry: Entry) -> None:
        """Tell the entry at this instant, which is not past (cheaper than a Timer)."""
        bucket = self._buckets.setdefault(when, entry)
        if bucket is entry:
            heappush(self._instants, when)
        elif isinstance(bucket, list):
            bucket.append(entry)
        else:
            self._buckets[when] = [bucket, entry]

    def withdrawn(self) -> None:
        """An entry is no longer awaited. When many are not, they are swept away."""
        self._stale += 1
        if self._stale >= self._sweep_at:
            self._sweep()

    def _sweep(self) -> None:
        count = 0
        for when, bucket in list(self._buckets.items()):
            entries = bucket if isinstance(bucket, list) else [bucket]
            awaited = [entry for entry in entries if entry[0].awaits(entry)]
            count += len(awaited)
            if awaited:
                self._buckets[when] = awaited
            else:
                del self._buckets[when]
        self._instants[:] = self._buckets
        heapify(self._instants)
        self._stale = 0
        self._sweep_at = max(SWEEP_FROM, count)

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

        Returns when that instant is reached, when `stop` was called, or (virtual clock) when nothing is left to do. On
        the wall clock without `until` it waits for what is posted, until `stop`.
        """
        self._stopped = False
        limit = END_OF_TIME if until is None else until
        if self.clock.jumps:
            self._run_jumping(limit)
        else:
            self._run_waiting(limit)

    def _run_jumping(self, limit: float) -> None:
        soon, instants, buckets, present = self._soon, self._instants, self._buckets, self._present
        while not self._stopped:
            if soon:
                soon.popleft()()
                continue
            if present:
                entry = present.pop()
            elif instants and (when := instants[0]) <= limit:
                heappop(instants)
                self.now = when
                bucket = buckets.pop(when)
                if isinstance(bucket, list):
                    present = self._present = bucket
                    present.reverse()
                    continue
                entry = bucket
            else:
                if limit < END_OF_TIME:
                    self.now = max(self.now, limit)
                return
            entry[0].elapsed(entry)

    def _run_waiting(self, limit: float) -> None:
        """All that is due when the clock is read is done at that instant, with what it leads to, however late it is."""
        soon, instants, clock = self._soon, self._instants, self.clock
        due = False  # was anything, when this instant was last looked at?
        while not self._stopped:
            if not due:
                self._attended, self.now = self.now, max(self.now, clock.read())
            for _ in range(len(soon)):  # not what they add: time goes on
                soon.popleft()()
            while instants and instants[0] <= self.now:
                bucket = self._buckets.pop(heappop(instants))
                self._present[:0] = reversed(bucket) if isinstance(bucket, list) else [bucket]
            if due := bool(self._present):
                entry = self._present.pop()
                entry[0].elapsed(entry)
            elif not soon and not self._stopped:
                if self.now >= limit:
                    return
                clock.reach(min(limit, instants[0]) if instants else limit)

    @property
    def attended(self) -> float:
        """The instant up to which all that was due has been done: before `now` if the wall clock has gone on since."""
        return self.now if self.clock.jumps else self._attended

    @property
    def idle(self) -> bool:
        """Is nothing due, now or later?"""
        return not (self._soon or self._present or self._instants)
