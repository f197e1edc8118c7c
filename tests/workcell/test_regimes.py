"""Regimes: what is false is broken again and again, what is true is left alone."""

from __future__ import annotations

import pytest

from planner_reactor.errors import InputError
from planner_reactor.runtime import Scheduler, VirtualClock
from planner_reactor.workcell.disturbances import DISTURBANCES
from planner_reactor.workcell.evidence import ASSUMPTIONS
from planner_reactor.workcell.host import host
from planner_reactor.workcell.regimes import BREAKING, SHORT_BELT, Regime
from planner_reactor.workcell.world import World


def struck(*false: str, until: float = 200.0, apart: float = 1.0) -> list[tuple[str, float]]:
    """What strikes an idle cell."""
    scheduler = Scheduler(VirtualClock(), seed=1)
    world = host(scheduler, kit=SHORT_BELT).world
    assert isinstance(world, World)
    world.start(scheduler)
    Regime(false, apart=apart).begin(world, scheduler)
    scheduler.run(until=until)
    return [(record.kind, record.struck_s) for record in world.struck]


def test_each_assumption_is_broken_by_a_fault_that_breaks_it_and_no_other() -> None:
    assert tuple(BREAKING) == ASSUMPTIONS
    assert all(DISTURBANCES[breaking.kind].breaks == name for name, breaking in BREAKING.items())


@pytest.mark.parametrize("name", ["AQ", "AS", "AF", "ADD"])
def test_it_is_broken_again_and_again(name: str) -> None:
    times = [time for _, time in struck(name)]
    breaking = BREAKING[name]
    assert times == [breaking.first + n * breaking.period for n in range(len(times))]
    assert len(times) == 1 + (200.0 - breaking.first) // breaking.period


def test_an_order_of_arrival_is_set_once_and_for_ever() -> None:
    assert struck("AO") == [("arrival_order", 1.0)]


def test_what_cannot_strike_waits_and_does_not_pile_up() -> None:
    """No gripper closes and no tray stands in an idle cell."""
    assert struck("AM", "ADT", "ACT", "ACP") == []


def test_regimes_mix_and_may_be_sparser() -> None:
    both, rare = struck("AQ", "ADD"), struck("AQ", "ADD", apart=3.0)
    assert {kind for kind, _ in both} == {"bad_parts", "downstream_blocked"}
    assert len(rare) < len(both)
    assert struck() == []


def test_an_assumption_that_there_is_not_is_refused() -> None:
    with pytest.raises(InputError, match="unknown assumption AK"):
        Regime(["AK"])
