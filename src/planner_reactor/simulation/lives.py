"""A life: what is scheduled on it ends with it, in the middle of whatever it did, as a process ends when it is killed.

It has the face of a scheduler and shares the time, the order and the random numbers of the one that everything runs
on. A reactor is built on a life; its world is not, and lives on when the reactor crashes.
"""

from __future__ import annotations

from random import Random

from planner_reactor.runtime.scheduler import Action, Entry, Scheduler, Timer


class Crash(BaseException):
    """Unwinds whatever the reactor is doing: nothing of it happens after this. Not an error: nobody may catch it."""

    def __init__(self, *, power: bool) -> None:
        self.power = power
        super().__init__("the power goes" if power else "the process is killed")


class Life(Scheduler):
    """A scheduler for one process on a machine; once it is not `alive`, nothing that it was asked for happens."""

    __slots__ = ("_shared", "alive")

    def __init__(self, shared: Scheduler) -> None:
        self._shared = shared
        self.alive = True
        self.clock = shared.clock
        self.seed = shared.seed

    @property
    def now(self) -> float:  # type: ignore[override]  # it reads the time, and never sets it
        return self._shared.now

    def call_at(self, when: float, action: Action) -> Timer:
        timer = Timer(self, max(when, self._shared.now), action)
        self.wait(timer.when, (timer, None))
        return timer

    def soon(self, action: Action) -> None:
        self._shared.soon(lambda: self._if_alive(action))

    def post(self, action: Action) -> None:
        self._shared.post(lambda: self._if_alive(action))

    def _if_alive(self, action: Action) -> None:
        if self.alive:
            action()

    def wait(self, when: float, entry: Entry) -> None:
        self._shared.wait(when, (self, entry))

    def elapsed(self, entry: Entry) -> None:
        """What waits has come due."""
        if self.alive:
            inner: Entry = entry[1]
            inner[0].elapsed(inner)

    def awaits(self, entry: Entry) -> bool:
        inner: Entry = entry[1]
        return self.alive and inner[0].awaits(inner)

    def withdrawn(self) -> None:
        self._shared.withdrawn()

    def random(self, stream: str) -> Random:
        return self._shared.random(stream)

    def stop(self) -> None:
        """Others go on."""

    def run(self, until: float | None = None) -> None:
        raise RuntimeError("a life runs on the scheduler that it shares")

    @property
    def idle(self) -> bool:
        return self._shared.idle
