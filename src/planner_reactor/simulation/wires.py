"""The link between two ends that talk by sessions: frames are lost, repeated, reordered, delayed and cut.

It is cut in both directions or in one (half-open: who sends does not notice). Ends are replaced when their process
begins anew; frames of the earlier one may still arrive, as over a real link.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from functools import partial
from typing import Literal

import msgspec

from planner_reactor.link.session import Session, Timing
from planner_reactor.runtime.scheduler import Scheduler, Timer

Name = Literal["reactor", "planner"]
OTHER: dict[Name, Name] = {"reactor": "planner", "planner": "reactor"}

TIMING = Timing(resend=0.4, beat=2.0, lease=6.0)


class Weather(msgspec.Struct, frozen=True):
    """How a link is: chances of losing and repeating a frame, longest delay in seconds."""

    loss: float = 0.0
    repeat: float = 0.0
    delay: float = 0.05


CLEAN = Weather()


class Wire:
    """Carries frames between the two ends.

    `arrived(end, messages)` is told what an end has received, `met(end)` that the other end is another incarnation,
    `room(end)` that something this end had to say was acknowledged: it may give more to its session.
    """

    def __init__(
        self,
        scheduler: Scheduler,
        arrived: Callable[[Name, list[bytes]], object],
        met: Callable[[Name], object],
        room: Callable[[Name], object],
    ) -> None:
        self.scheduler = scheduler
        self.weather = CLEAN
        self.ends: dict[Name, Session] = {}
        self.open: dict[Name, bool] = {"reactor": True, "planner": True}  # do frames of this end get through?
        self.counts: Counter[str] = Counter()
        self._arrived = arrived
        self._met = met
        self._room = room
        self._draw = scheduler.random("wire")
        self._due: dict[Name, Timer | None] = {"reactor": None, "planner": None}
        self._sent = 0
        self._latest: dict[Name, int] = {"reactor": 0, "planner": 0}

    def plug(self, name: Name, end: Session | None) -> None:
        """This end begins anew, or is gone."""
        if end is None:
            self.ends.pop(name, None)
        else:
            self.ends[name] = end
            self.pump(name)

    def pump(self, name: Name) -> None:
        """Let an end say what it has to say, and be asked again when it is due."""
        if (timer := self._due[name]) is not None:
            timer.cancel()
            self._due[name] = None
        if (end := self.ends.get(name)) is not None:
            now = self.scheduler.now
            for frame in end.due(now):
                self.carry(name, frame)
            self._due[name] = self.scheduler.call_at(max(end.next_due(), now + 0.001), lambda: self.pump(name))

    def carry(self, name: Name, frame: bytes, *, over: bool = False) -> None:
        """A frame of this end is under way; whether it comes, the weather says. `over`: who sends it is replaced."""
        weather, draw = self.weather, self._draw
        for _ in range(2 if weather.repeat and draw.random() < weather.repeat else 1):
            self._sent += 1
            number = self._sent
            if not self.open[name]:
                self.counts["cut" if not self.open[OTHER[name]] else "half_open"] += 1
            elif weather.loss and draw.random() < weather.loss:
                self.counts["lost"] += 1
            else:
                delay = draw.uniform(0.001, weather.delay)
                self.counts["delayed"] += delay > TIMING.resend
                self.scheduler.call_after(delay, partial(self._comes, OTHER[name], number, frame, over))

    def _comes(self, to: Name, number: int, frame: bytes, over: bool) -> None:
        if (end := self.ends.get(to)) is None:
            return
        self.counts["reordered"] += number < self._latest[to]
        self._latest[to] = max(number, self._latest[to])
        before, peer, stale = end.counts["repeated"], end.peer, end.counts["stale"]
        waiting = end.unacknowledged
        messages = end.receive(frame, self.scheduler.now)
        if end.peer != peer:
            self._met(to)
        if end.unacknowledged < waiting:
            self._room(to)
        self.counts["repeated"] += end.counts["repeated"] - before
        self.counts["over"] += over and end.counts["stale"] > stale
        if messages:
            self._arrived(to, messages)
        self.pump(to)
