"""Fault schedules: by turns, and at random by seed."""

from __future__ import annotations

import pytest

from planner_reactor.errors import InputError
from planner_reactor.experiments.schedules import LONGEST, SHORTEST, at_random, in_turn
from planner_reactor.runtime import Scheduler, VirtualClock
from planner_reactor.workcell import telling
from planner_reactor.workcell.evidence import ASSUMPTIONS
from planner_reactor.workcell.faults import Fault
from planner_reactor.workcell.host import host
from planner_reactor.workcell.world import World


@pytest.fixture
def world() -> World:
    made = host(Scheduler(VirtualClock(), seed=1)).world
    assert isinstance(made, World)
    return made


def drawn(world: World, seed: int) -> tuple[Fault, ...]:
    return at_random(world, seed, count=8, begin=5.0, end=400.0, endless=telling.ENDLESS, leave_out=telling.ENDING)


def test_the_same_seed_gives_the_same_faults_and_another_seed_others(world: World) -> None:
    assert drawn(world, 1) == drawn(world, 1)
    assert drawn(world, 1) != drawn(world, 2)


def test_every_kind_comes_up_in_time_and_only_those_of_the_world(world: World) -> None:
    found = [fault for seed in range(60) for fault in drawn(world, seed)]
    assert {fault.kind for fault in found} == set(world.faults) - set(telling.ENDING)
    assert all(5.0 <= fault.at <= 400.0 for fault in found)


def test_what_would_last_for_ever_ends(world: World) -> None:
    endless = [fault for seed in range(60) for fault in drawn(world, seed) if fault.kind in telling.ENDLESS]
    assert endless
    assert all(SHORTEST <= fault.parameters[telling.ENDLESS[fault.kind]] <= LONGEST for fault in endless)


def test_one_of_each_in_turn_breaks_each_assumption(world: World) -> None:
    faults = in_turn(world, telling.EACH, begin=10.0, apart=5.0, endless=telling.ENDLESS)
    assert [fault.at for fault in faults] == [10.0 + 5.0 * n for n in range(len(ASSUMPTIONS))]
    assert all(world.refusal(fault.kind, fault.parameters) is None for fault in faults)


def test_a_kind_that_the_world_does_not_know_is_refused(world: World) -> None:
    with pytest.raises(InputError, match="part_moved"):
        in_turn(world, ["part_mvoed"], begin=0.0, apart=1.0, endless={})
