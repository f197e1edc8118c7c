"""What a host module is written with: it brings a world to a text.

A host registers basic processes (R §9.1: atomic processes that command servers and return results), pure functions for
expressions, and assumptions: what the sensors say of each (holds, fails, unknown). Nothing in a text can reach other
host code. Every basic process declares its age window, or a limit, in seconds.

    host = Host("cell")

    @host.process(results=("x",), window=(0.2, 1.0))
    def Find(kind: str):
        yield 0.2
        return "x7"
"""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping
from math import inf, isfinite
from typing import TYPE_CHECKING, Any, Protocol, TypeVar, get_type_hints

import msgspec

from planner_reactor.errors import InputError, nearest
from planner_reactor.rs.terms import Value
from planner_reactor.rs.vocabulary import BUILT_IN, Kind, Signature
from planner_reactor.runtime.scheduler import Scheduler
from planner_reactor.runtime.sensing import PLAIN, Caution, Sensed

if TYPE_CHECKING:
    from planner_reactor.runtime.ports import Port

Routine = TypeVar("Routine", bound=Callable[..., Any])
Sensor = TypeVar("Sensor", bound=Callable[[], Sensed])
Listener = Callable[[str, bool, str], object]


class World(Protocol):
    """What stands behind a host's processes, simulated or real."""

    @property
    def faults(self) -> Mapping[str, Mapping[str, Any]]:
        """The kinds of faults that can strike, each with its parameters and their defaults."""

    def start(self, scheduler: Scheduler) -> None: ...

    def ledger(self) -> Mapping[str, int]: ...

    def balanced(self) -> bool: ...

    def finished(self) -> bool: ...

    def report(self) -> Mapping[str, object]: ...

    def strike(self, kind: str, **parameters: Any) -> bool:
        """Let a fault happen; False if it cannot strike yet."""


class Watchdog(Protocol):
    """A device that stops the machine, in a controlled way, when it is not kicked in time. It never resumes alone."""

    @property
    def period(self) -> float:
        """Seconds between two kicks: well below what it waits for."""

    def kick(self, now: float) -> bool:
        """The executive is alive at this instant; False if the device has stopped the machine."""


class BasicProcess(msgspec.Struct, frozen=True):
    """A registered process: its signature, what runs, and what takes back what it may have begun."""

    signature: Signature
    routine: Callable[..., Any]
    abandon: Callable[..., object] | None
    limit: float
    places: int  # parameters that the routine takes
    blocking: bool = False  # runs in a thread of its own


class Host:
    """A registry of processes, functions and assumptions."""

    def __init__(self, name: str) -> None:
        self.name = name
        self.processes: dict[str, BasicProcess] = {}
        self.functions: dict[str, Callable[..., Value]] = {}
        self.assumptions: dict[str, Callable[[], Sensed]] = {}
        self.cautions: dict[str, Caution] = {}
        self.world: World | None = None
        self.watchdog: Watchdog | None = None
        self.ports: Mapping[str, Port] = {}  # what else serves them: see `Executer.share`
        self._listeners: list[Listener] = []

    @property
    def signatures(self) -> Mapping[str, Signature]:
        """The signatures of the registered processes, by name."""
        return {name: process.signature for name, process in self.processes.items()}

    def process(
        self,
        *,
        results: tuple[str, ...] | int = 0,
        window: tuple[float, float] = (0.0, inf),
        outcomes: tuple[str, ...] = ("stop", "abort"),
        limit: float | None = None,
        abandon: Callable[..., object] | None = None,
        blocking: bool = False,
        name: str | None = None,
        means: str = "",
    ) -> Callable[[Routine], Routine]:
        """Register a function, a generator function or a coroutine function as a basic process.

        Parameters annotated `float` or `int` take numbers, `str` symbols, any other a value of any kind. What it
        returns are its results: None for none, a tuple for several. It ends at an age within `window`; if it would end
        earlier, it ends at the window's beginning. After `limit` seconds (the window's end, if not given) it is
        abandoned and aborts. `abandon(*arguments)` is called once if it is aborted from outside while it runs. What is
        `blocking`, a plain function that waits for a device or computes for long, runs in a thread on the wall clock.
        `means` is a test in RS on its parameters, `LST[p - a, 1] : LST[a - p, 1]`, that stops where the process stops:
        with it an analysis knows what the outcome says.
        """

        def register(routine: Routine) -> Routine:
            own = name or routine.__name__
            names = tuple(f"r{i + 1}" for i in range(results)) if isinstance(results, int) else tuple(results)
            longest = _limit(own, window, limit)
            kinds, optional = _kinds(routine)
            self._check_new(own)
            _check_outcomes(own, outcomes)
            if blocking and (inspect.isgeneratorfunction(routine) or inspect.iscoroutinefunction(routine)):
                raise InputError(f"{own}: what is blocking is a plain function, not one that yields or awaits")
            signature = Signature(
                own, kinds, names, optional=optional, window=(window[0], min(window[1], longest)),
                outcomes=frozenset(outcomes), parameters=tuple(inspect.signature(routine).parameters), means=means,
            )  # fmt: skip
            self.processes[own] = BasicProcess(signature, routine, abandon, longest, len(kinds), blocking)
            return routine

        return register

    def function(self, routine: Routine) -> Routine:
        """Register a pure function for expressions, under its own name."""
        self._check_new(routine.__name__)
        self.functions[routine.__name__] = routine
        return routine

    def assumption(self, name: str, caution: Caution = PLAIN) -> Callable[[Sensor], Sensor]:
        """Register what the sensors say of an assumption: True (holds), False (fails), None (unknown), or a `Reading`.

        `caution` says how its readings are taken, also those that a process reports by itself.
        """

        def register(sensor: Sensor) -> Sensor:
            if name in self.assumptions:
                raise InputError(f"{self.name}: assumption {name} is registered twice")
            self.assumptions[name] = sensor
            if caution != PLAIN:
                self.cautions[name] = caution
            return sensor

        return register

    def report(self, assumption: str, holds: bool, evidence: str = "") -> None:
        """A process itself has noticed whether an assumption holds: tell those who listen."""
        if assumption not in self.assumptions:
            hint = nearest(assumption, self.assumptions)
            raise InputError(f"{self.name}: unknown assumption {assumption}" + (f", {hint}" if hint else ""))
        for listener in self._listeners:
            listener(assumption, holds, evidence)

    def listen(self, listener: Listener) -> None:
        """Be told (assumption, holds, evidence) of every report."""
        self._listeners.append(listener)

    def _check_new(self, name: str) -> None:
        if name in BUILT_IN:
            raise InputError(f"{self.name}: {name} is a built-in process, choose another name")
        if name in self.processes or name in self.functions:
            raise InputError(f"{self.name}: {name} is registered twice")


def _limit(name: str, window: tuple[float, float], limit: float | None) -> float:
    low, high = window
    if not 0 <= low <= high:
        raise InputError(f"{name}: its window must be (low, high) with 0 <= low <= high, not {window}")
    longest = high if limit is None else limit
    if not isfinite(longest) or longest < low:
        raise InputError(f"{name}: give a finite end of its window, or a limit (seconds) beyond its beginning")
    return longest


def _check_outcomes(name: str, outcomes: tuple[str, ...]) -> None:
    for outcome in outcomes:
        if outcome not in ("stop", "abort"):
            raise InputError(f'{name}: an outcome is "stop" or "abort", not {outcome!r}')


def _kinds(routine: Callable[..., Any]) -> tuple[tuple[Kind, ...], int]:
    """The kinds of the parameters, and how many of the last have defaults."""
    hints = get_type_hints(routine)
    kinds: list[Kind] = []
    optional = 0
    for parameter in inspect.signature(routine).parameters.values():
        if parameter.kind not in (parameter.POSITIONAL_ONLY, parameter.POSITIONAL_OR_KEYWORD):
            raise InputError(f"{routine.__name__}: parameter {parameter.name} must be positional")
        optional += parameter.default is not parameter.empty
        hint = hints.get(parameter.name, object)
        kinds.append("number" if hint in (float, int) else "symbol" if hint is str else "any")
    return tuple(kinds), optional
