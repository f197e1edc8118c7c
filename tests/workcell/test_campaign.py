"""Random faults, and programs killed at random times: nothing is lost, unsensed, stuck or out of the books."""

from __future__ import annotations

import random

import pytest

from planner_reactor.workcell.audit import audit
from planner_reactor.workcell.disturbances import DISTURBANCES
from planner_reactor.workcell.evidence import ASSUMPTIONS
from planner_reactor.workcell.faults import FaultSchedule, faults_from

from .driving import Rig, Running, build_kits, careful_kit


def schedule(rig: Rig, draw: random.Random, count: int) -> FaultSchedule:
    """So many faults of random kinds in the first 400 s."""
    text = ""
    for _ in range(count):
        kind = draw.choice([kind for kind in DISTURBANCES if kind not in ("downstream_ready", "arrival_order")])
        text += f'[[fault]]\nat = {draw.uniform(5, 400)}\nkind = "{kind}"\n'
        if kind == "downstream_blocked":
            text += f"duration_s = {draw.uniform(20, 150)}\n"
    return FaultSchedule(faults_from(text, rig.world), rig.world, rig.scheduler)


def poll(rig: Rig) -> None:
    for assumption in ASSUMPTIONS:
        rig.holds(assumption)
    rig.scheduler.call_after(2.0, lambda: poll(rig))


def check(rig: Rig, faults: FaultSchedule) -> None:
    assert rig.world.finished()
    assert rig.world.report()["kits"]["rejected"] == 0
    assert [fault for fault in rig.world.struck if fault.sensed_s is None] == []
    assert faults.unstruck() == ()
    assert rig.world.balanced(), rig.world.findings
    assert rig.trace is not None
    audited = audit(rig.trace.events)
    assert audited.mistakes == []
    assert audited.ledger() == rig.world.ledger()


@pytest.mark.parametrize("seed", range(12))
def test_random_faults_cost_careful_behaviour_no_kit(seed: int) -> None:
    rig = Rig(seed=seed, target=15)
    faults = schedule(rig, random.Random(seed), 8)
    poll(rig)
    build_kits(rig, careful_kit, until=6000.0)
    check(rig, faults)


@pytest.mark.parametrize("seed", range(12))
def test_nor_does_killing_the_program_again_and_again(seed: int) -> None:
    rig, draw = Rig(seed=seed, target=15), random.Random(seed)
    faults = schedule(rig, draw, 8)
    poll(rig)
    begun: list[Running] = []
    begin = rig.begin_routine

    def remembered(routine):  # type: ignore[no-untyped-def]
        begun.append(begin(routine))
        return begun[-1]

    rig.begin_routine = remembered  # type: ignore[method-assign]
    while not rig.world.finished() and rig.scheduler.now < 6000.0:
        begun.clear()
        build_kits(rig, careful_kit, until=rig.scheduler.now + draw.uniform(1, 120))
        for running in list(begun):
            if running.outcome is None:
                running.abandon()
        assert rig.cell.arm.live in ("", "put away")
        assert rig.cell.arm.queue == []
        assert rig.world.balanced(), rig.world.findings
    check(rig, faults)
