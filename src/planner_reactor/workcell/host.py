"""The kitting host: the basic processes of `kitting.itl`, the nine assumptions, and the world behind them.

`--host planner_reactor.workcell.host` finds `host`, which makes a fresh cell for each run. Every process has
a finite age window: the longest wait for its turn and its part, and the motions after that; a process that
fails does so after `REACTION_S` at the earliest, so that retrying a situation always takes time.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from functools import partial, wraps
from typing import Any

from planner_reactor.runtime.host import Host
from planner_reactor.runtime.scheduler import Scheduler
from planner_reactor.runtime.sensing import PLAIN, Caution
from planner_reactor.runtime.signals import Aborted
from planner_reactor.trace import Trace
from planner_reactor.workcell.calibration import PINNED, Calibration
from planner_reactor.workcell.cell import Cell, Steps
from planner_reactor.workcell.evidence import ASSUMPTIONS
from planner_reactor.workcell.kit import SERVOMOTOR, KitSpec
from planner_reactor.workcell.looking import Looking
from planner_reactor.workcell.monitors import CAUTIONS, Monitors
from planner_reactor.workcell.picking import Picking
from planner_reactor.workcell.placing import Placing
from planner_reactor.workcell.plant import Plant
from planner_reactor.workcell.servo import Servo
from planner_reactor.workcell.world import World

REACTION_S = 0.2
"""No process fails sooner than this."""


def host(
    scheduler: Scheduler,
    *,
    kit: KitSpec = SERVOMOTOR,
    target: int = 0,
    calibration: Calibration = PINNED,
    trace: Trace | None = None,
    cautions: Mapping[str, Caution] | None = None,
    servo: bool = False,
) -> Host:
    """A kitting workcell on this scheduler. `target`: the world is finished after so many completed kits (0:
    never); `cautions`: how the readings of its sensors are taken; `servo`: the arm can be moved by increments.
    """
    plant = Plant(kit, calibration, scheduler, trace=trace)
    world = World(plant, target=target)
    made = Host("kitting")
    made.world = world
    cell = Cell(plant)
    world.arm = cell.arm
    cell.evidence.sensed = world.sensed
    cell.evidence.report = lambda assumption, text: made.report(assumption, False, text)
    served = Servo(made, cell) if servo else None
    for name, routine, results, high in processes(cell):
        if served is not None and name == "Locate":
            routine = served.locating(routine)
        outcomes = ("abort",) if name == "Track" else ("stop", "abort")
        made.process(results=results, window=(0.0, high), outcomes=outcomes, name=name)(paced(routine, scheduler))
    monitors = Monitors(cell)
    for assumption in ASSUMPTIONS:
        caution = (cautions or CAUTIONS).get(assumption, PLAIN)
        made.assumption(assumption, caution)(partial(monitors.reading, assumption))
    world.sensors = cell.sensors
    return made


def processes(cell: Cell) -> Iterator[tuple[str, Callable[..., Steps[Any]], tuple[str, ...], float]]:
    """Every basic process: name, routine, results, the end of its age window in seconds."""
    picking = Picking(cell)
    placing = Placing(cell, picking)
    looking = Looking(cell, placing)
    c = cell.calibration
    wait = cell.wait_s
    # a take may wait, be wrong twice and put back; a thing in the gripper may first be waited for
    take = wait + 3 * (c.pick_and_place_s + c.put_back_s)
    held = 2 * c.pick_and_place_s + c.reconcile_s + c.test_s + c.discard_s
    picture = c.patience_s + c.carry_s + c.verify_s + c.look_again_s
    yield "FindGetInsert", placing.find_get_insert, (), take + held
    yield "Find", picking.find, ("x",), take
    yield "Locate", picking.locate, ("x",), wait + c.pick_and_place_s
    yield "Track", picking.track, (), 2 * take
    yield "Get", picking.get, (), take
    yield "Move", placing.move, (), held
    yield "Insert", placing.insert, (), held
    yield "PutBack", picking.put_back, (), held
    yield "Deliver", placing.deliver, (), wait + held
    yield "Choose", looking.choose, ("d",), 2 * c.look_s
    yield "AwaitArrival", looking.await_arrival, (), wait + c.pick_and_place_s
    yield "Test", looking.test, (), held
    yield "LocateTray", looking.locate_tray, (), picture
    yield "SlotVacant", looking.slot_vacant, (), picture
    yield "Verify", looking.verify, (), picture
    yield "AwaitReady", looking.await_ready, (), c.patience_s + 1.0


def paced(routine: Callable[..., Steps[Any]], scheduler: Scheduler) -> Callable[..., Steps[Any]]:
    """The routine, but an abort at the very instant of its start comes `REACTION_S` later."""

    @wraps(routine)
    def begun(*arguments: Any) -> Steps[Any]:
        began = scheduler.now
        try:
            return (yield from routine(*arguments))
        except Aborted as problem:
            if scheduler.now > began:
                raise
            reason = str(problem)
        yield REACTION_S
        raise Aborted(reason)

    return begun
