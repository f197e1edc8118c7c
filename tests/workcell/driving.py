"""Runs basic processes without a program: what tests need to set one process against one situation.

`Rig` is a cell on a virtual clock; `rig.run(rig.find("motor"))` runs a process to its end and gives its
results, `rig.begin(...)` starts one that can be abandoned. `build_kits` is the scripted controller that shows
that kits can be built before there is a planner.
"""

from __future__ import annotations

from collections.abc import Callable, Generator
from dataclasses import dataclass, field
from typing import Any

from planner_reactor.runtime import Aborted, Scheduler, Signal, VirtualClock
from planner_reactor.runtime.signals import Within
from planner_reactor.trace import Trace
from planner_reactor.workcell.calibration import PINNED, Calibration
from planner_reactor.workcell.cell import Cell
from planner_reactor.workcell.host import processes
from planner_reactor.workcell.kit import SERVOMOTOR, KitSpec
from planner_reactor.workcell.monitors import Monitors
from planner_reactor.workcell.plant import Plant
from planner_reactor.workcell.world import World

Routine = Generator[Any, Any, Any]


@dataclass(eq=False)
class Running:
    """One process under way. `outcome`: None, "stop" or "abort"."""

    scheduler: Scheduler
    routine: Routine
    outcome: str | None = None
    reason: str = ""
    result: Any = None
    done: Signal = field(default_factory=Signal)
    _signal: Signal | None = None
    _timer: Any = None
    _timed: bool = False

    def step(self, value: object = None) -> None:
        """Let it run to where it waits next."""
        self._signal = self._timer = None
        try:
            wanted = self.routine.send(value)
        except StopIteration as end:
            self._end("stop", result=end.value)
        except Aborted as problem:
            self._end("abort", reason=str(problem))
        else:
            self._wait(wanted)

    def abandon(self) -> None:
        """Abort it from outside."""
        if self._signal is not None:
            self._signal.remove(self)
        if self._timer is not None:
            self._timer.cancel()
        self.routine.close()
        self._end("abort", reason="abandoned")

    def fired(self, value: object) -> None:
        if self._timer is not None:
            self._timer.cancel()
        self.scheduler.soon(lambda: self.outcome is None and self.step(True if self._timed else value))

    def _wait(self, wanted: object) -> None:
        self._timed = isinstance(wanted, Within)
        if isinstance(wanted, Within):
            self._timer = self.scheduler.call_after(wanted.seconds, self._late)
            wanted = wanted.signal
        if isinstance(wanted, Signal):
            self._signal = wanted
            wanted.add(self)
        else:
            self._timer = self.scheduler.call_after(wanted, self.step)  # type: ignore[arg-type]

    def _late(self) -> None:
        if self._signal is not None:
            self._signal.remove(self)
        self.step(False)

    def _end(self, outcome: str, *, reason: str = "", result: Any = None) -> None:
        self.outcome, self.reason, self.result = outcome, reason, result
        self.done.fire()


class Rig:
    """A cell on a virtual clock, and its processes by name (`rig.call("Find", "motor")`)."""

    def __init__(
        self,
        *,
        seed: int = 1,
        kit: KitSpec = SERVOMOTOR,
        calibration: Calibration = PINNED,
        traced: bool = True,
        target: int = 0,
    ) -> None:
        self.scheduler = Scheduler(VirtualClock(), seed=seed)
        self.trace = Trace(lambda: self.scheduler.now) if traced else None
        self.plant = Plant(kit, calibration, self.scheduler, trace=self.trace)
        self.world = World(self.plant, target=target)
        self.cell = Cell(self.plant)
        self.world.arm = self.cell.arm
        self.reports: list[str] = []
        self.cell.evidence.sensed = self.world.sensed
        self.cell.evidence.report = lambda assumption, text: self.reports.append(assumption)
        self.routines = {name: routine for name, routine, _, _ in processes(self.cell)}
        self.windows = {name: high for name, _, _, high in processes(self.cell)}
        self.monitors = Monitors(self.cell)
        self.world.start(self.scheduler)

    def call(self, name: str, *arguments: str) -> Routine:
        """The process, not yet begun."""
        return self.routines[name](*arguments)

    def begin(self, name: str, *arguments: str) -> Running:
        """The process, begun."""
        return self.begin_routine(self.call(name, *arguments))

    def begin_routine(self, routine: Routine) -> Running:
        running = Running(self.scheduler, routine)
        running.step()
        return running

    def run(self, name: str, *arguments: str, within: float = 400.0) -> Running:
        """The process, run to its end."""
        return self.finish(self.begin(name, *arguments), within=within)

    def finish(self, running: Running, *, within: float = 400.0) -> Running:
        """Let time pass until it has ended."""
        running.done.add(_Stop(self.scheduler))
        if running.outcome is None:
            self.scheduler.run(until=self.scheduler.now + within)
        assert running.outcome is not None, "it has not ended"
        return running

    def wait(self, seconds: float) -> None:
        """Let time pass."""
        self.scheduler.run(until=self.scheduler.now + seconds)

    def tray(self) -> str:
        """A tray in the tray area."""
        handle = self.run("Find", "tray").result
        assert self.run("Move", handle, "trayarea").outcome == "stop"
        return str(handle)

    def held(self, kind: str = "motor") -> str:
        """A part in the gripper."""
        return str(self.run("Find", kind).result)

    def holds(self, assumption: str) -> bool | None:
        return self.monitors.holds(assumption)


@dataclass(eq=False)
class _Stop:
    scheduler: Scheduler

    def fired(self, value: object) -> None:
        self.scheduler.stop()


def together(rig: Rig, *routines: Routine) -> Routine:
    """All side by side; ends when all have ended, and aborts if one aborts (the `&` of RS)."""
    running = [rig.begin_routine(routine) for routine in routines]
    for one in running:
        while one.outcome is None:
            yield one.done
    if any(one.outcome == "abort" for one in running):
        raise Aborted("; ".join(one.reason for one in running))


def insisting(rig: Rig, name: str, *arguments: str) -> Routine:
    """Again and again until it stops (REASSERT)."""
    return insisting_on(lambda: rig.call(name, *arguments))


def insisting_on(routine: Callable[[], Routine]) -> Routine:
    """As `insisting`, for any routine."""
    while True:
        try:
            return (yield from routine())
        except Aborted:
            yield 0.2


def _good_tray(rig: Rig) -> Routine:
    tray = yield from rig.call("Find", "tray")
    yield from rig.call("Test", "tray", tray)
    return tray


def trusting_kit(rig: Rig) -> Routine:
    """One kit by the first ideal reactor (R Fig. 9): nothing is checked."""
    tray = yield from insisting(rig, "Find", "tray")
    yield from rig.call("Move", tray, "trayarea")
    yield from together(rig, *(insisting(rig, "FindGetInsert", kind, tray) for kind in rig.cell.kit.kinds))
    yield from insisting(rig, "Deliver", tray)


def careful_kit(rig: Rig) -> Routine:
    """One kit by the final reactor (R Fig. 10): every assumption relaxed."""
    tray = yield from insisting_on(lambda: _good_tray(rig))
    yield from rig.call("Move", tray, "trayarea")
    while True:
        yield from _filled(rig, tray)
        try:
            yield from insisting(rig, "AwaitReady")
            yield from rig.call("Verify", tray)
            yield from rig.call("Deliver", tray)
            return
        except Aborted:
            continue


def _filled(rig: Rig, tray: str) -> Routine:
    while True:
        yield from together(rig, *(_careful_part(rig, kind, tray) for kind in rig.cell.kit.kinds))
        try:
            return (yield from rig.call("Verify", tray))
        except Aborted:
            continue


def _careful_part(rig: Rig, kind: str, tray: str) -> Routine:
    while True:
        try:
            part = yield from _good_part(rig, kind)
            try:
                yield from rig.call("SlotVacant", tray, kind)
            except Aborted:
                yield from rig.call("PutBack", part)
                return
            yield from rig.call("LocateTray", tray)
            yield from rig.call("Insert", part, tray)
            return
        except Aborted:
            yield 0.2


def _good_part(rig: Rig, kind: str) -> Routine:
    while True:
        try:
            wanted = yield from rig.call("Choose", kind)
            yield from rig.call("AwaitArrival", kind)
            part = yield from rig.call("Locate", wanted)
            track = rig.begin("Track", part)
            try:
                yield from rig.call("Get", part)
            finally:
                track.abandon()
            yield from rig.call("Test", kind, part)
            return part
        except Aborted:
            yield 0.2


def build_kits(rig: Rig, kit: Any, *, until: float = 1e5) -> None:
    """One kit after another until the world is finished."""

    def forever() -> Routine:
        while not rig.world.finished():
            yield from kit(rig)

    running = rig.begin_routine(forever())
    running.done.add(_Stop(rig.scheduler))
    if running.outcome is None:
        rig.scheduler.run(until=until)
