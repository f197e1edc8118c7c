"""One run in the world of this package, as a value: what an experiment varies, and what came of it.

Everything that belongs to that world comes from `workcell`; nothing here knows what it makes. Runs of any other
domain and host are `Loop`s like these.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from typing import Any, Literal, TypeAlias

import msgspec

from planner_reactor.experiments.loop import Loop, summary
from planner_reactor.experiments.timing import PER_STEP, Fixed, Measured, PlannerTime, Recorded
from planner_reactor.logic.domain import Domain
from planner_reactor.logic.reader import read_domain
from planner_reactor.planner.planner import Planner
from planner_reactor.runtime import Scheduler, World
from planner_reactor.trace import Trace
from planner_reactor.workcell.calibration import PINNED, Calibration
from planner_reactor.workcell.domains import SHIPPED, shipped_domain
from planner_reactor.workcell.faults import Fault, FaultSchedule
from planner_reactor.workcell.host import host
from planner_reactor.workcell.papers import planner_durations

Relax: TypeAlias = Literal["all", "none"] | tuple[str, ...]
Faults: TypeAlias = Callable[[World], tuple[Fault, ...]]
"""What strikes, once the world that knows the kinds is there."""


class Run(msgspec.Struct, frozen=True, kw_only=True):
    """What an experiment varies. `products`: how many to complete (0: no number); times in seconds."""

    seed: int = 1
    relax: Relax = "all"
    planner_time: float | Literal["measured", "papers"] | PlannerTime = PER_STEP
    calibration: Calibration = PINNED
    faults: Faults = lambda world: ()
    products: int = 0
    until: float | None = None


class Ran(msgspec.Struct, frozen=True):
    """What came of a run. `unstruck`: the kinds of the faults that never could strike."""

    run: Run
    loop: Loop
    came_to: Mapping[str, Any]
    unstruck: tuple[str, ...]


def perform(run: Run, *, domain: Domain | None = None, watch: Callable[[Loop], object] = lambda loop: None) -> Ran:
    """Do it. `watch` is given the loop before it begins."""
    loop = Loop(
        Planner(domain or the_domain(), relax=run.relax),
        partial(_host, run),
        seed=run.seed,
        planner_time=planner_time(run.planner_time),
    )
    world = loop.host.world
    assert world is not None
    schedule = FaultSchedule(run.faults(world), world, loop.scheduler)
    watch(loop)
    loop.run(until=run.until)
    return Ran(run, loop, summary(loop), tuple(fault.kind for fault in schedule.unstruck()))


def the_domain() -> Domain:
    """The planning domain of this package's world, read anew."""
    return read_domain(shipped_domain(), file=SHIPPED)


def planner_time(charge: float | Literal["measured", "papers"] | PlannerTime) -> PlannerTime:
    """What the planner's thinking is charged."""
    if isinstance(charge, float | int):
        return Fixed(charge)
    if charge == "measured":
        return Measured()
    if charge == "papers":
        took = planner_durations()
        return Recorded(
            first=took.first_adaptation_s,
            refinement=took.refinement_s,
            forced_first=took.forced_first_s,
            forced=took.forced_s,
            normal=took.normal,
            other=took.other_s,
        )
    return charge


def _host(run: Run, scheduler: Scheduler, trace: Trace) -> Any:
    return host(scheduler, target=run.products, calibration=run.calibration, trace=trace)
