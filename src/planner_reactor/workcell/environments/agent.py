"""A reactor's host in a world of RS processes: the ports of the interface, and what the sensors say of assumptions.

All that is known here has come through the ports: a *lookout* reads s1, j and b now and then, as any reaction may, and
remembers what it was told last. Whether the object stands still, whether it is still to come, whether the belt runs is
judged from that; where nothing was told for a while, nothing is known.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

import msgspec

from planner_reactor.rs.loading import load
from planner_reactor.runtime import Executer, Host, Scheduler
from planner_reactor.trace import Trace
from planner_reactor.workcell.environments.exploits import NEAR
from planner_reactor.workcell.environments.worlds import Surroundings

GLANCE = 0.2
"""Seconds between two glances of the lookout at a port."""
STALE = 5.0
"""Seconds for which the lookout relies on what it was told, and an object that moved is taken to move."""

HostMaker = Callable[[Scheduler, Trace], Host]


class Told(msgspec.Struct):
    """The last value at a port, when it came, and when it last was another one than before."""

    value: float
    at: float
    changed: float | None = None


class Lookout:
    """Reads some ports of an interface, beside the reactor."""

    def __init__(self, scheduler: Scheduler, world: Surroundings) -> None:
        self._scheduler = scheduler
        self._told: dict[str, Told] = {}
        station = Host("lookout")
        station.ports = world.ports
        station.process(window=(0.0, 0.0), name="Note")(self.note)
        ports = [port for port in ("s1", "j", "b") if port in world.ports]
        lines = (f"See_{port} = (IN[{port}]<v> : Note[{port}, v]) :; Delay[{GLANCE}]" for port in ports)
        program = load("\n".join(lines), signatures=station.signatures)
        self._executer = Executer(program, scheduler=scheduler, host=station)
        self._names = [schema.name for schema in program.schemas]

    def start(self) -> None:
        for name in self._names:
            self._executer.start(name)

    def note(self, port: str, value: float) -> None:
        """This was read at a port."""
        now, before = self._scheduler.now, self._told.get(port)
        moved = before is not None and abs(before.value - value) > 1e-9
        self._told[port] = Told(value, now, now if moved else before.changed if before else None)

    def _fresh(self, port: str) -> Told | None:
        told = self._told.get(port)
        return told if told is not None and self._scheduler.now - told.at <= STALE else None

    def still(self) -> bool | None:
        """Does the object stand where it stood?"""
        seen = self._told.get("s1")
        if seen is None:
            return None
        return seen.changed is None or self._scheduler.now - seen.changed > STALE

    def running(self) -> bool | None:
        """Does the belt run? Where there is none it does not."""
        told = self._fresh("b")
        return told.value == 1 if told is not None else None

    def upstream(self) -> bool | None:
        """Is the object, where it was last seen, still to come to the robot?"""
        seen, own = self._fresh("s1"), self._fresh("j")
        return seen.value <= own.value + NEAR if seen is not None and own is not None else None


class Place:
    """The world as a run sees it (`runtime.World`): it begins together with the lookout."""

    def __init__(self, world: Surroundings, lookout: Lookout) -> None:
        self.surroundings = world
        self._lookout = lookout

    @property
    def faults(self) -> Mapping[str, Mapping[str, object]]:
        return self.surroundings.faults

    def start(self, scheduler: Scheduler) -> None:
        self.surroundings.start(scheduler)
        self._lookout.start()

    def ledger(self) -> Mapping[str, int]:
        return self.surroundings.ledger()

    def balanced(self) -> bool:
        return self.surroundings.balanced()

    def finished(self) -> bool:
        return self.surroundings.finished()

    def report(self) -> Mapping[str, object]:
        return self.surroundings.report()

    def strike(self, kind: str, **parameters: object) -> bool:
        return self.surroundings.strike(kind, **parameters)


def agent(
    kind: str, starts: Mapping[str, float], constants: Mapping[str, float] | None = None, *, target: int = 0
) -> HostMaker:
    """What makes a host in a world of this kind; it is finished when `target` objects were taken (0: never)."""

    def made(scheduler: Scheduler, trace: Trace) -> Host:
        world = Surroundings(scheduler, kind, starts, constants)
        world.until_acquired(target)
        lookout = Lookout(scheduler, world)
        host = Host(kind)
        host.ports = world.ports
        host.world = Place(world, lookout)
        host.assumption("Still")(lookout.still)
        if "j" in world.ports:
            host.assumption("Running")(lookout.running)
            host.assumption("Upstream")(lookout.upstream)
        return host

    return made
