"""`loop` and `kit`: planner and reactor side by side in a host's world, until it is finished (R Fig. 1).

`loop` runs any domain with any host; `kit` is `loop` with the kitting domain and the kitting host. Everything that
the caller gives is read and checked before the first event; then the trace is opened, and the run begins.
"""

from __future__ import annotations

from collections.abc import Callable
from contextlib import nullcontext
from pathlib import Path
from typing import Any, Final, TypedDict, Unpack, cast, get_args

import msgspec
from msgspec.structs import replace

from planner_reactor.calls.checking import must_fit
from planner_reactor.calls.conforming import LATENESS, attend
from planner_reactor.calls.hosts import HostMaker, HostSource, find_host
from planner_reactor.calls.inputs import names_in, one_of, read_text, seconds, whole
from planner_reactor.calls.outputs import Outputs
from planner_reactor.errors import InputError
from planner_reactor.experiments.advice import Adviser
from planner_reactor.experiments.loop import Loop, summary
from planner_reactor.experiments.replay import check_replay
from planner_reactor.experiments.runs import planner_time
from planner_reactor.experiments.timing import PER_STEP, PlannerTime
from planner_reactor.link.messages import Mode
from planner_reactor.logic.reader import read_domain
from planner_reactor.planner import Planner
from planner_reactor.runtime import Host, Scheduler, VirtualClock, WallClock
from planner_reactor.runtime.garbage import seldom_collected
from planner_reactor.trace import Trace
from planner_reactor.workcell.domains import SHIPPED, shipped_domain, with_kit
from planner_reactor.workcell.faults import FaultSchedule, faults_from
from planner_reactor.workcell.kit import KitSpec, kit_from

KITTING_HOST = "planner_reactor.workcell.host"
MODES: Final[tuple[Mode, ...]] = get_args(Mode)
TRAYS = 5
"""Kits of a run of which neither a number nor an end was given."""


class LoopOptions(TypedDict, total=False):
    """What `loop` and `kit` have in common; every one may be left out.

    `trays`: how many kits (or whatever the host counts) to complete; `seed`; `kit`: the file of another kit;
    `faults`: a file of faults; `goals`: a file of what management says meanwhile (`experiments.advice`); `until`:
    seconds; `cell`: "events"; `clock`: "virtual" or "wall"; `planner`: "inline"; `planner_time`: seconds charged for
    each step of the planner, "measured" or "papers"; `mode`: "drain", "wait" or "versions"; `verify`: verify every
    adaptation before it is issued; `response_ms`: time that may go into one adaptation; `relax`: "all", "none", or
    assumptions;
    `trace`: a file `*.jsonl` to write; `figures`: a directory to draw into;
    `conform`: hold every step against the semantics (`conforming`); `watch`: is given the `Loop` before it runs;
    `told`: is given each warning, a line.
    """

    trays: int | None
    seed: int
    kit: str | Path | None
    faults: str | Path | None
    goals: str | Path | None
    until: float | None
    cell: str
    clock: str
    planner: str
    planner_time: float | str
    mode: str
    verify: bool
    response_ms: float | None
    relax: str | tuple[str, ...]
    trace: str | Path | None
    figures: str | Path | None
    conform: bool
    watch: Callable[[Loop], object]
    told: Callable[[str], object]


class _Options(msgspec.Struct, frozen=True, kw_only=True):
    """`LoopOptions` with their defaults, each checked by itself."""

    trays: int | None = None
    seed: int = 0
    kit: str | Path | None = None
    faults: str | Path | None = None
    goals: str | Path | None = None
    response_ms: float | None = None
    until: float | None = None
    cell: str = "events"
    clock: str = "virtual"
    planner: str = "inline"
    planner_time: float | str = PER_STEP
    mode: str = "drain"
    verify: bool = True
    relax: str | tuple[str, ...] = "all"
    trace: str | Path | None = None
    figures: str | Path | None = None
    conform: bool = False
    watch: Callable[[Loop], object] = lambda loop: None
    told: Callable[[str], object] = lambda line: None

    def __post_init__(self) -> None:
        if self.trays is not None:
            whole("trays", self.trays, 1)
        whole("seed", self.seed, 0)
        seconds("until", self.until)
        one_of("cell", self.cell, ("events",), later=("physics", "camera"))
        one_of("clock", self.clock, ("virtual", "wall"))
        one_of("planner", self.planner, ("inline",), later=("process",))
        one_of("mode", self.mode, MODES)


def kit(*, domain: str | Path | None = None, **options: Unpack[LoopOptions]) -> dict[str, Any]:
    """Build kits in the simulated workcell, from `domain` (default: the kitting domain); see `LoopOptions`.

    Runs until `trays` kits are completed, or until `until`; with neither, five kits. Returns what `loop` does.
    """
    given = _Options(**options)
    if given.trays is None and given.until is None:
        options["trays"] = TRAYS
    if domain is not None:
        return loop(domain, host=KITTING_HOST, **options)
    return _run(shipped_domain(), SHIPPED, KITTING_HOST, None, _Options(**options))


def loop(
    domain: str | Path, *, host: HostSource, goal: str | None = None, **options: Unpack[LoopOptions]
) -> dict[str, Any]:
    """Run planner and reactor for a goal of a domain `*.itl` in a host's world; see `LoopOptions`.

    Returns what the world reports (for kitting `kits`, `parts`, `faults`, …), `adaptations`, `changes_applied`,
    `assumptions`, `first_adaptation_issued_s`, `first_reactor_s`, `first_ideal_s`, `stub_triggers`, `relaxations`,
    `interruptions`, `laws_checked`, `violations`, `unstruck` (faults that have not struck), `finished`, `figures`
    (the files drawn), `simulated_s`, `wall_s`, `cpu_s`, `trace_hash` and, if asked, `conformance`. Raises InputError
    or SourceError for what cannot be used.
    """
    given = _Options(**options)
    return _run(read_text(domain), str(domain), host, goal, given)


def _run(text: str, file: str, host: HostSource, goal: str | None, given: _Options) -> dict[str, Any]:
    made, faults, adviser = _prepared(text, file, host, goal, given)
    with Outputs(given.trace, given.figures) as outputs:
        outputs.attach(made.trace)
        if given.clock == "wall":
            made.trace.record("not_deterministic", because="the clock is the wall clock")
        late = LATENESS if given.clock == "wall" else 0.0
        monitor = attend(made.reactor, lateness=late) if given.conform else None
        given.watch(made)
        with seldom_collected() if given.clock == "wall" else nullcontext():
            made.run(until=given.until)
        # a host of our own is simulation alone; what another one would do twice we cannot know
        if host == KITTING_HOST and given.clock == "virtual" and made.planner_time.deterministic:
            again, *_ = _prepared(text, file, host, goal, replace(given, told=lambda line: None))
            check_replay(made, again, until=given.until)
    held = {"conformance": monitor.report()} if monitor is not None else {}
    for why in adviser.refused:
        given.told(f"not done: {why}")
    return {**_came_to(made, faults, given), "refused_advice": adviser.refused, "figures": outputs.drawn, **held}


def _prepared(
    text: str, file: str, host: HostSource, goal: str | None, given: _Options
) -> tuple[Loop, FaultSchedule | None, Adviser]:
    """Everything that was given, read, checked and put together; nothing has happened yet."""
    kit_spec = kit_from(read_text(given.kit), file=str(given.kit)) if given.kit is not None else None
    if kit_spec is not None:
        text = with_kit(text, kit_spec)
    fault_text = read_text(given.faults) if given.faults is not None else None
    planner = Planner(
        read_domain(text, file=file), goal=goal, relax=_relaxed(given.relax), mode=cast(Mode, given.mode),
        verify=given.verify, response_ms=given.response_ms,
    )  # fmt: skip
    maker = find_host(host)
    _expect(maker, given, kit_spec)

    def make_host(scheduler: Scheduler, trace: Trace) -> Host:
        asked = {"trace": trace, "target": given.trays, "kit": kit_spec}
        made = maker(scheduler, **{name: value for name, value in asked.items() if value is not None})
        for warning in must_fit(text, file, made):
            given.told(f"warning: {warning}")
        return made

    made = Loop(
        planner,
        make_host,
        seed=given.seed,
        clock=VirtualClock() if given.clock == "virtual" else WallClock(),
        planner_time=_planner_time(given.planner_time),
        keep_trace=given.figures is not None,
    )
    faults = _schedule(made, fault_text, str(given.faults))
    adviser = _advised(made, text, file, given.goals)
    _expect_an_end(made, given)
    return made, faults, adviser


def _advised(made: Loop, text: str, file: str, goals: str | Path | None) -> Adviser:
    adviser = Adviser(made, text, file, folder=Path(goals).parent if goals is not None else None)
    if goals is not None:
        adviser.schedule(adviser.read(read_text(goals), file=str(goals)))
    return adviser


def _relaxed(relax: str | tuple[str, ...]) -> Any:
    if relax in ("all", "none"):
        return relax
    found = names_in(relax)
    if "" in found:
        raise InputError("relax lacks a name, expected all, none, or assumptions such as AQ,AM")
    return found


def _planner_time(charge: float | str) -> PlannerTime:
    if charge == "measured":
        return planner_time("measured")
    if charge == "papers":
        return planner_time("papers")
    try:
        per_step = seconds("planner time", float(charge))
    except ValueError as error:
        raise InputError(f"planner time is {charge}, expected measured, papers, or seconds, 0 or more") from error
    return planner_time(PER_STEP if per_step is None else per_step)


def _expect(maker: HostMaker, given: _Options, kit_spec: KitSpec | None) -> None:
    """What is asked of the host it must be able to take."""
    for asked, parameter, option in ((given.trays, "target", "trays"), (kit_spec, "kit", "kit")):
        if asked is not None and parameter not in maker.takes:
            raise InputError(f"host {maker.name} knows no {option}: its `host` has no parameter {parameter}")


def _schedule(made: Loop, text: str | None, file: str) -> FaultSchedule | None:
    if text is None:
        return None
    world = made.host.world
    if world is None:
        raise InputError(f"{file}: host {made.host.name} has no world in which faults could strike")
    return FaultSchedule(faults_from(text, world, file=file), world, made.scheduler)


def _expect_an_end(made: Loop, given: _Options) -> None:
    if given.until is None and made.host.world is None:
        raise InputError(f"host {made.host.name} has no world that could be finished, expected an end: until")


def _came_to(made: Loop, faults: FaultSchedule | None, given: _Options) -> dict[str, Any]:
    world = made.host.world
    unstruck = faults.unstruck() if faults is not None else ()
    for fault in unstruck:
        given.told(f"the fault {fault.kind}, due at {fault.at:g} s, had not struck by {made.costs.simulated:g} s")
    for why in made.planner.withheld.values():
        given.told(f"an adaptation was not issued: {why}")
    for situation, why in made.planner.impossible.items():
        given.told(f"no plan for {situation}: {why}")
    return {
        **summary(made),
        "unstruck": [{"kind": fault.kind, "at": fault.at} for fault in unstruck],
        "impossible": dict(made.planner.impossible),
        "finished": world is not None and world.finished(),
        "seed": given.seed,
    }
