"""A loop whose two sides may end at any moment, and talk by sessions over a link that loses, repeats, delays and cuts.

The messages are those of `link.messages`, encoded; what the reactor must not forget is on a simulated disk. Either side
may be killed at any instant, also in the middle of what it does, and begins anew after a while: the reactor on its
journal, the planner on what the reactor tells it. The world goes on meanwhile.
"""

from __future__ import annotations

from collections import Counter, deque
from collections.abc import Callable
from typing import Any

from planner_reactor.errors import RefusedError
from planner_reactor.experiments.loop import ASK_AGAIN, HostMaker, Loop
from planner_reactor.link.codec import LARGEST_STANDING, decode, encode
from planner_reactor.link.messages import Adaptation, Enquiry, Perception, Standing
from planner_reactor.link.session import Session
from planner_reactor.planner.planner import Planner
from planner_reactor.simulation.disks import SimulatedDisk
from planner_reactor.simulation.drivers import Drivers
from planner_reactor.simulation.lives import Crash
from planner_reactor.simulation.sides import ReactorSide
from planner_reactor.simulation.wires import CLEAN, TIMING, Name, Weather, Wire

AWAY = 0.5
"""Seconds until a process that was killed begins anew."""


class LinkedLoop(Loop):
    """`make_planner` makes each planner in turn. `crashes` counts what was killed."""

    def __init__(
        self, make_planner: Callable[[], Planner], make_host: HostMaker, *, weather: Weather = CLEAN, **options: Any
    ) -> None:
        super().__init__(make_planner(), make_host, **options)
        self.make_planner = make_planner
        self.disk = SimulatedDisk()
        self.crashes: Counter[str] = Counter()
        self.broken: list[str] = []  # laws that reactors which are gone have seen broken
        self._heard: deque[Perception] = deque()
        self._wire = Wire(self.scheduler, self._arrived, self._met, self._room)
        self._wire.weather = weather
        self._side: ReactorSide | None = None
        self._session = Session(1, timing=TIMING)
        self._came_in = False  # in the middle of what a reactor tells: its number is where this planner begins

    @property
    def violations(self) -> list[str]:
        """The laws that were broken, by whatever incarnation."""
        return [*self.broken, *map(str, self.reactor.laws.violations)]

    # -- processes come and go

    def crash_reactor(self, *, power: bool = False) -> None:
        """Its process is gone, in the middle of what it does; with the power also what was not synced."""
        raise Crash(power=power)

    def crash_planner(self) -> None:
        """Its process is gone, with all that it knew."""
        self.crashes["planner"] += 1
        self._wire.plug("planner", None)
        self._busy = True  # there is nobody to think
        self.scheduler.call_after(AWAY, self._begin_planner)

    def _begin_planner(self) -> None:
        self._heard.clear()
        self._session = Session(self.planners + 1, timing=TIMING)
        self._came_in = True
        self._wire.plug("planner", self._session)
        self.succeed(self.make_planner())

    def _begin(self) -> None:
        self._begin_reactor()
        self._wire.plug("planner", self._session)

    def _go(self, until: float | None) -> None:
        while True:
            try:
                self.scheduler.run(until)
                return
            except Crash as crash:
                self._down(power=crash.power)

    def _begin_reactor(self) -> None:
        drivers = Drivers(self.host, Counter())
        self._side = ReactorSide(
            self.scheduler, self.host, drivers, self.disk, self._wire, self.trace, lambda moment: None
        )
        self.reactor = self._side.reactor
        if (world := self.host.world) is not None:
            self.reactor.laws.ledgers.append(lambda: "" if world.balanced() else f"the world's: {dict(world.ledger())}")
        if not self._side.start():
            raise AssertionError("the disk of a linked loop takes what it is given")

    def _down(self, *, power: bool) -> None:
        if self._side is None:
            return
        self.crashes["power" if power else "reactor"] += 1
        self.broken += map(str, self.reactor.laws.violations)
        self._side.end(power=power)
        self._side = None
        if power:
            self.disk.crash(self.scheduler.random("power"))
        self.scheduler.call_after(AWAY, self._begin_reactor)

    # -- the link

    def _transmit(self, adaptation: Adaptation) -> None:
        self._say(adaptation)

    def _enquire(self, enquiry: Enquiry) -> None:
        self._say(enquiry)

    def _say(self, message: Adaptation | Enquiry) -> None:
        self._session.send(encode(message))
        self._wire.pump("planner")

    def _take(self) -> list[Perception]:
        taken = list(self._heard)
        self._heard.clear()
        return taken

    def _met(self, to: Name) -> None:
        """Another incarnation of the reactor: its perceptions count from 1."""
        if to == "planner":
            self._acted_on = 0

    def _arrived(self, to: Name, messages: list[bytes]) -> None:
        for message in (decode(m, largest=LARGEST_STANDING) for m in messages):
            match message:
                case Adaptation() if self._side is not None:
                    self.reactor.receive(message)
                case Enquiry() if self._side is not None:
                    self._answer(message)
                case Perception():
                    if self._came_in:
                        self._acted_on, self._came_in = message.number - 1, False
                    self._next(message)
                    self._heard.append(message)
                    self._perceived()
                case Standing():
                    self._told(message)
                case _:
                    pass

    def _room(self, to: Name) -> None:
        if to == "reactor" and self._side is not None:
            self._side.pump()

    def _answer(self, enquiry: Enquiry) -> None:
        assert self._side is not None
        assert self._side.session is not None
        try:
            standing = self.reactor.enquire(enquiry)
        except RefusedError:
            self.scheduler.call_after(ASK_AGAIN, lambda: self._ask_again(self.planner))
            return
        self._side.pump()
        self._side.session.send(encode(standing))
        self._wire.pump("reactor")
