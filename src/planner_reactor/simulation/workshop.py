"""A busy world with many situations, made to be changed: cheap, and able to do everything that a world can do wrong.

Its deeds say which reaction does them on behalf of which instance, so that whoever watches can tell by itself whether
an instance saw two versions. They take their time, abort, raise, hang and linger; an axis moves by a drive whose link
may drop; three assumptions are sensed by sensors that go wrong (`sensors`), a fourth by none; a watchdog stops it if
nobody kicks.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator
from typing import Any

from planner_reactor.runtime import Aborted, Host, Scheduler, Signal
from planner_reactor.simulation.sensors import ASSUMPTIONS, NOTICED, Read, Sensors, caution_of

LONGEST_DEED, LINGERING = 40.0, 200.0
"""Seconds that a deed takes at most, and one that hardly ends."""

SPEED, TICK, JUMP = 0.06, 1.0, 0.061
"""Of the axis: metres a second, seconds between two set points, metres between two set points at most."""

BEAT = 5.0
"""Seconds between two beats of the reaction that nothing may delay (law 12)."""

Did = Callable[[str, int, int], object]


class Axis:
    """One axis and its drive. `wrong` says when a set point was too far from where it stood."""

    def __init__(self) -> None:
        self.pose = 0.0
        self.linked = True
        self.busy = False
        self.back = Signal("drive is back")
        self.wrong: list[str] = []

    def set(self, target: float) -> None:
        """A set point, reached within a tick."""
        if abs(target - self.pose) > JUMP:
            self.wrong.append(f"the axis jumps from {self.pose:.3f} to {target:.3f} m")
        if self.linked:
            self.pose = target


class Dog:
    """A watchdog: not kicked for its `patience`, it has stopped the machine, until people reset it."""

    period, patience = 2.0, 12.0

    def __init__(self) -> None:
        self.tripped: float | None = None  # when
        self.kicked: float | None = None

    def trip(self, now: float) -> None:
        """It stops the machine."""
        self.tripped = now if self.tripped is None else self.tripped

    def kick(self, now: float) -> bool:
        if self.kicked is not None and now - self.kicked > self.patience:
            self.trip(now)
        self.kicked = now
        return self.tripped is None

    def reset(self) -> None:
        self.tripped = self.kicked = None

    def stands(self, now: float) -> bool:
        """Was the machine stopped so long ago that who kicks knows?"""
        return self.tripped is not None and now > self.tripped + self.period


class Workshop:
    """The world: what happens in it, and what is counted. `did` is told of each deed as it begins, `failed` of one that
    did not work.
    """

    def __init__(self, scheduler: Scheduler) -> None:
        self.scheduler = scheduler
        self.axis = Axis()
        self.raising = self.hanging = 0
        self.failing = 0.03
        self.counts: Counter[str] = Counter()
        self.did: Did = lambda situation, instance, version: None
        self.failed: Callable[[str], object] = lambda situation: None
        self.beat: Callable[[], object] = lambda: None
        self.dog = Dog()
        self._draw = scheduler.random("workshop")
        self.sensors = Sensors(scheduler.random("sensors"), lambda: scheduler.now, self.counts)
        self.host = self._host()

    def calm(self) -> None:
        """Faults cease."""
        self.raising = self.hanging = 0
        self.failing = 0.0
        self.sensors.mend()
        self.link_drive(True)

    def read_anew(self) -> dict[str, Read]:
        """What the sensors will have said to a reactor that begins."""
        self.sensors.forget()
        return self.sensors.read

    def flips(self, name: str, *, holds: bool) -> None:
        """An assumption changes, and a process notices."""
        self.sensors.truth[name] = holds
        self.sensors.reported(name, holds)
        self.host.report(name, holds, "noticed")

    def relent(self) -> None:
        """What only a process notices holds again, and one does."""
        self.flips(NOTICED, holds=True)

    def link_drive(self, linked: bool) -> None:
        """The drive's link drops, or is there again; meanwhile somebody pushes the axis."""
        self.axis.linked = linked
        if linked:
            self.axis.back.fire()
        else:
            self.axis.pose = round(self._draw.uniform(0.0, 2.0), 3)

    # -- its processes

    def _host(self) -> Host:
        host = Host("workshop")
        host.watchdog = self.dog
        for name in ASSUMPTIONS:
            host.assumption(name, caution_of(name))(lambda name=name: self.sensors.sense(name))
        host.assumption(NOTICED)(lambda: None)
        host.process(window=(0.0, LONGEST_DEED), name="Do")(self._do)
        host.process(window=(0.0, LINGERING), name="Linger")(self._linger)
        host.process(window=(0.0, LONGEST_DEED), name="Pause")(self._pause)
        host.process(window=(0.0, LONGEST_DEED), name="Travel")(self._travel)
        host.process(window=(0.0, 0.0), name="Beat")(self._beats)
        host.process(window=(0.0, 1.0), name="Spin")(self._spins)
        return host

    def _spins(self) -> None:
        """Over at once; who repeats it goes round for ever."""

    def _do(self, situation: str, instance: float, version: float, seconds: float) -> Iterator[Any]:
        self.did(situation, int(instance), int(version))
        if self.raising:
            self.raising -= 1
            self.counts["raised"] += 1
            self.failed(situation)
            raise RuntimeError("a deed raises")
        if self.hanging:
            self.hanging -= 1
            self.counts["hung"] += 1
            yield 10.0 * LONGEST_DEED
        yield seconds
        if self._draw.random() < self.failing:
            self.counts["aborted"] += 1
            self.failed(situation)
            raise Aborted("it did not work")

    def _linger(self, situation: str, instance: float, version: float) -> Iterator[Any]:
        self.did(situation, int(instance), int(version))
        self.counts["lingered"] += 1
        yield LINGERING

    def _pause(self, seconds: float) -> Iterator[Any]:
        yield seconds

    def _beats(self) -> None:
        self.beat()

    def _travel(self, target: float) -> Iterator[Any]:
        """One at a time, set point by set point; without its drive it holds, and goes on from where it then is."""
        if self.axis.busy:
            yield 1.0
            raise Aborted("the axis is in use")
        self.axis.busy = True
        try:
            yield from self._moves(target)
        finally:
            self.axis.busy = False

    def _moves(self, target: float) -> Iterator[Any]:
        axis = self.axis
        while abs(target - axis.pose) > 1e-6:
            if not axis.linked:
                if not (yield axis.back.within(LONGEST_DEED / 2)):
                    raise Aborted("the drive does not answer")
                self.counts["resumed"] += 1
            pose = axis.pose  # read anew: it may have been pushed since, though the link is there again
            axis.set(pose + max(-SPEED * TICK, min(SPEED * TICK, target - pose)))
            yield TICK
