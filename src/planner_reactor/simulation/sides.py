"""The two sides of a simulated run, each a process that may end at any moment and begin anew.

A side is what its process holds in memory: the reactor's a `Reactor` on a `Life`, its drivers, its mount and its
session; the planner's a session and what is on the way. What survives (the disk, the planner's book) is handed in.
"""

from __future__ import annotations

from collections.abc import Callable

from planner_reactor.errors import DiskError, RefusedError
from planner_reactor.link.channels import PerceptionChannel
from planner_reactor.link.codec import decode, encode
from planner_reactor.link.messages import Adaptation, Enquiry, Perception
from planner_reactor.link.session import Session
from planner_reactor.reactor.journal import Journal
from planner_reactor.reactor.reactor import Reactor
from planner_reactor.reactor.storms import Intensity
from planner_reactor.runtime import Budgets, Host, Scheduler
from planner_reactor.simulation.books import Key
from planner_reactor.simulation.disks import Moment, Mount, SimulatedDisk
from planner_reactor.simulation.drivers import Drivers
from planner_reactor.simulation.lives import Life
from planner_reactor.simulation.wires import TIMING, Wire
from planner_reactor.trace import Trace

AHEAD = 8
"""Perceptions under way at most: the others wait, and repeats of them are counted."""

NO_KEY: Key = (-1, -1)
"""Of what is no adaptation."""

BUDGETS = Budgets(turns=100, processes=21_500)


class ReactorSide:
    """One incarnation of the reactor. `sent` is what it gave to the link, in order."""

    def __init__(
        self, scheduler: Scheduler, base: Host, drivers: Drivers, disk: SimulatedDisk, wire: Wire, trace: Trace,
        at: Callable[[Moment], object], *, intensity: Intensity | None = None,
    ) -> None:  # fmt: skip
        self.life = Life(scheduler)
        self.drivers = drivers
        self.mount = Mount(disk, at)
        self.wire = wire
        self.sent: list[Perception] = []
        self.perceptions = PerceptionChannel(self._perceived)
        self.reactor = Reactor(
            self.life,
            host=drivers.host,
            perceptions=self.perceptions,
            trace=trace,
            budgets=BUDGETS,
            journal=Journal(self.mount),
            intensity=intensity,
        )
        self.session: Session | None = None
        self._base = base

    def start(self) -> bool:
        """Begin to act; False if the disk does not let it."""
        self._base.listen(self._reported)
        try:
            self.reactor.start()
        except DiskError:
            return False
        self.session = Session(self.reactor.journal.state.incarnation, timing=TIMING)
        self.wire.plug("reactor", self.session)
        self.pump()
        return True

    def end(self, *, power: bool) -> int:
        """The process is gone; how many commands were abandoned."""
        self.life.alive = self.mount.alive = False
        if self in (listeners := [getattr(heard, "__self__", None) for heard in self._base._listeners]):
            del self._base._listeners[listeners.index(self)]
        if self.wire.ends.get("reactor") is self.session:
            self.wire.plug("reactor", None)
        return self.drivers.close()

    def _reported(self, assumption: str, holds: bool, evidence: str) -> None:
        for listener in self.drivers.host._listeners:
            listener(assumption, holds, evidence)

    def _perceived(self) -> None:
        if self.session is not None:
            self.life.soon(self.pump)

    def pump(self) -> None:
        """Give to the link what was perceived, as far as it keeps up."""
        if self.session is not None and self.session.unacknowledged < AHEAD and len(self.perceptions):
            for perception in self.perceptions.take():
                self.sent.append(perception)
                self.session.send(encode(perception))
            self.wire.pump("reactor")

    def receive(self, messages: list[bytes]) -> None:
        """Messages of the planner, in order."""
        for message in map(decode, messages):
            if not self.life.alive:
                return
            match message:
                case Adaptation():
                    self.reactor.receive(message)
                case Enquiry():
                    self._answer(message)
                case _:
                    pass

    def _answer(self, enquiry: Enquiry) -> None:
        """How it stands; nothing if its epoch cannot be made durable (it will be asked again)."""
        try:
            standing = self.reactor.enquire(enquiry)
        except RefusedError:
            return
        if self.session is not None:
            self.pump()
            self.session.send(encode(standing))
            self.wire.pump("reactor")


class PlannerSide:
    """One incarnation of the planner's end of the link."""

    def __init__(self, incarnation: int, wire: Wire) -> None:
        self.session = Session(incarnation, timing=TIMING)
        self.wire = wire
        self.sent: list[Key] = []
        self.dead: set[Key] = set()  # acknowledged by a reactor that is gone

    def send(self, message: Adaptation | Enquiry) -> None:
        self.sent.append((message.epoch, message.id) if isinstance(message, Adaptation) else NO_KEY)
        self.session.send(encode(message))
        self.wire.pump("planner")

    def met(self) -> None:
        """Another incarnation of the reactor speaks: what the earlier one had taken went with it."""
        self.dead.update(self.sent[: len(self.sent) - self.session.unacknowledged])
