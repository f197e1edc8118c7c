"""Environment models that run: worlds of RS processes beside a reactor, on the run's own clock (X §3.3, eq. 7).

A `Surroundings` runs a model and its sensory-motor interface in an executer of their own. Of its ports the reactor
shares those of the interface and no others: what it knows of the world has come through sense1, touch or joint, what it
does to it goes through motor1, move or close. What moves by itself draws from the scheduler's stream, so that one seed
is one world. `Gauge` is the experimenter's view of the truth: no host, sensor or planner has access to it.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from functools import lru_cache
from typing import Any

import msgspec

from planner_reactor.errors import InputError, RSError, nearest
from planner_reactor.rs.checks import check_addition
from planner_reactor.rs.given import with_values
from planner_reactor.rs.loading import load_process
from planner_reactor.rs.parser import parse_program
from planner_reactor.rs.source import Source
from planner_reactor.rs.terms import Program, Value
from planner_reactor.rs.vocabulary import BUILT_IN
from planner_reactor.runtime import Executer, Label, Scheduler
from planner_reactor.workcell.environments.dynamics import host as sight
from planner_reactor.workcell.environments.dynamics import model, senses

TIMING: Mapping[str, float] = {
    "t0": 1.0, "ts0": 0.05, "ts1": 0.02, "gl": 0.02, "tl": 0.05, "gm": 0.02, "tm": 0.005,
    "tt0": 0.05, "tt1": 0.02, "gto": 0.02, "tto": 0.05, "gmv": 0.2, "tmv": 0.005,
    "tm0": 1.0, "gg": 0.05, "gh": 0.01, "th": 0.05, "gj": 0.02, "tj": 0.05, "gb": 0.05, "tb": 0.2,
    "gap": 1.0,
}  # fmt: skip
"""Seconds. A command is held for less than the quantum of STREAM, so that it is carried out once."""

MEASURES: Mapping[str, float] = {
    "eps": 0.9, "mu": 0.5, "nu": 12.0, "start": 0.0, "width": 0.05, "stride": 0.5, "field": 1.0,
}  # fmt: skip
"""Lengths. `field`: what the camera sees to either side; `stride`: how far the robot goes for one command at most."""


class Kind(msgspec.Struct, frozen=True):
    """A world: the texts it consists of, what runs, its ports, and the names of its starting values."""

    texts: tuple[str, ...]
    root: str
    interface: tuple[str, ...]
    ports: tuple[str, ...]
    starts: tuple[str, ...]


_SIGHT, _TOUCH = ("sense1", "motor1"), ("touch", "move", "joint", "close", "feel")
KINDS: Mapping[str, Kind] = {
    "tracking": Kind(("tracking",), "TEM", _SIGHT, ("s1", "m1"), ("p", "a")),
    "reaching": Kind(
        ("guarded_move", "grasping"), "Reaching", (*_SIGHT, *_TOUCH),
        ("s1", "m1", "t", "r", "j", "g", "h"), ("p", "a", "pr"),
    ),
    "line": Kind(
        ("guarded_move", "grasping"), "Line", (*_SIGHT, *_TOUCH, "encoder"),
        ("s1", "m1", "t", "r", "j", "g", "h", "b"), ("p", "a", "pr", "s"),
    ),
}  # fmt: skip


class Surroundings:
    """One world, begun at `starts`, with these `constants` in place of the usual ones. A `runtime.World`."""

    def __init__(
        self,
        scheduler: Scheduler,
        kind: str,
        starts: Mapping[str, float],
        constants: Mapping[str, float] | None = None,
    ) -> None:
        if kind not in KINDS:
            raise InputError(f"unknown world {kind}, {nearest(kind, KINDS) or 'there is: ' + ', '.join(KINDS)}")
        self.kind = KINDS[kind]
        self.constants = {**TIMING, **MEASURES, **(constants or {})}
        self.starts = tuple(float(starts[name]) for name in self.kind.starts)
        self.gauge = Gauge(scheduler, dict(zip(self.kind.starts, self.starts, strict=True)), self.constants)
        program = program_of(self.kind, tuple(self.constants.items()))
        host = senses(self.constants["field"], self.constants["stride"])
        self.executer = Executer(program, scheduler=scheduler, host=host, observer=self.gauge.saw)
        self.ports = self.executer.share(*self.kind.ports)
        self.program = program
        self._most = 0

    def start(self, scheduler: Scheduler) -> None:
        self.executer.start(self.kind.root, self.starts)
        for name in self.kind.interface:
            self.executer.start(name)

    def until_acquired(self, count: int) -> None:
        """Be finished when so many objects have been taken."""
        self._most = count

    def finished(self) -> bool:
        return 0 < self._most <= self.gauge.taken

    def ledger(self) -> Mapping[str, int]:
        gauge = self.gauge
        return {"arrived": gauge.arrived, "there": gauge.there, "taken": gauge.taken, "lost": gauge.lost}

    def balanced(self) -> bool:
        return self.gauge.there in (0, 1)

    def report(self) -> Mapping[str, object]:
        return {"objects": dict(self.ledger()), "moves": self.gauge.moves}

    @property
    def faults(self) -> Mapping[str, Mapping[str, Any]]:
        return {"belt": {"runs": 0.0}} if self.kind.root == "Line" else {}

    def strike(self, kind: str, **parameters: Any) -> bool:
        """`belt`: it is switched on or off (`runs` 1 or 0) by somebody else."""
        runs = float({**self.faults[kind], **parameters}["runs"])
        self.executer.start_process(load_process(f"OUT[switch, {runs}]", given=self.program), name="switch")
        return True


class Gauge:
    """What is true: where the object, the camera and the robot are, and since when. For whoever measures."""

    def __init__(self, scheduler: Scheduler, starts: Mapping[str, float], constants: Mapping[str, float]) -> None:
        self._scheduler = scheduler
        self._constants = constants
        self.now: dict[str, float] = dict(starts)
        self.courses: dict[str, list[tuple[float, float]]] = {name: [(0.0, v)] for name, v in starts.items()}
        self.grips: list[tuple[float, bool]] = []
        self.touches: list[float] = []
        self.acquired: list[float] = []
        self.moves = 0
        self.arrived, self.taken, self.lost = 1, 0, 0

    @property
    def there(self) -> int:
        """How many objects are there: one, or none until the belt brings the next."""
        return self.arrived - self.taken - self.lost

    def saw(self, label: Label) -> None:
        """One step of the world."""
        match label:
            case ("Ran", _, _, (float(step),)):
                self._set("p", self.now["p"] + step)
            case ("LST", (float(p), _), "ok", _):
                self._set("p", p + self._constants["mu"] * self.now["s"])
            case ("LST", _, "ab", _):
                self.lost += 1
            case ("Comes", _, _, _):
                self.arrived += 1
                self._set("p", self._constants["start"])
            case ("COM", (str(port), value), _, _):
                self._communicated(port, value)
            case _:
                pass

    def _communicated(self, port: str, value: Value) -> None:
        match port, value:
            case "angle", float(angle):
                self._set("a", angle)
            case "switch", float(runs):
                self._set("s", runs)
            case "rc", float(step):
                self.moves += step != 0
                self._set("pr", self.now["pr"] + step)
            case "taken", _:
                self.taken += 1
                self.acquired.append(self._scheduler.now)
            case "held", _:
                self.grips.append((self._scheduler.now, value == 1))
            case "tact", _:
                self.touches.append(self._scheduler.now)

    def _set(self, name: str, value: float) -> None:
        if self.now[name] != value:
            self.now[name] = value
            self.courses[name].append((self._scheduler.now, value))

    def samples(self, name: str, instants: Iterable[float]) -> list[float]:
        """The course of `p`, `a`, `pr` or `s` at these instants (rising)."""
        course, found, at = self.courses[name], [], 0
        for instant in instants:
            while at + 1 < len(course) and course[at + 1][0] <= instant:
                at += 1
            found.append(course[at][1])
        return found


@lru_cache(64)
def program_of(kind: Kind, constants: tuple[tuple[str, float], ...]) -> Program:
    """The definitions of a world, of which all constants are numbers; what a later text defines anew counts."""
    text = "\n".join(model(name) for name in kind.texts)
    last = {(schema.name, len(schema.head)): schema for schema in parse_program(text, file=kind.root).schemas}
    program = with_values(Program(last.values()), dict(constants))
    found = check_addition(Program(), program, signatures={**BUILT_IN, **sight.signatures}, functions=sight.functions)
    if errors := [f for f in found if f.severity == "error"]:
        raise RSError(Source(text, kind.root).shown(errors))
    return program
