"""Regimes: what is false is broken again and again, what is true is left alone."""

from __future__ import annotations

import pytest

from planner_reactor.errors import InputError
from planner_reactor.runtime import Scheduler, VirtualClock
from planner_reactor.workcell.disturbances import DISTURBANCES
from planner_reactor.workcell.evidence import ASSUMPTIONS
from planner_reactor.workcell.host import host
from planner_reactor.workcell.regimes import BREAKING, SHORT_BELT, regime


def test_each_assumption_is_broken_by_a_fault_that_breaks_it_and_no_other() -> None:
    assert tuple(BREAKING) == ASSUMPTIONS
    assert all(DISTURBANCES[breaking.kind].breaks == name for name, breaking in BREAKING.items())


@pytest.mark.parametrize("name", ASSUMPTIONS)
def test_it_is_broken_again_and_again_up_to_the_end_by_faults_that_the_world_takes(name: str) -> None:
    world = host(Scheduler(VirtualClock()), kit=SHORT_BELT).world
    faults = regime([name], until=600.0)
    assert all(world.refusal(fault.kind, fault.parameters) is None for fault in faults)  # type: ignore[union-attr]
    lasts = [fault.parameters.get("duration_s") for fault in faults]
    assert lasts == [600.0] or len(faults) >= 7
    assert max(fault.at for fault in faults) < 600.0


def test_regimes_mix_by_time_and_may_be_sparser() -> None:
    both, rare = regime(["AQ", "ADT"], until=300.0), regime(["AQ", "ADT"], until=300.0, apart=3.0)
    assert [fault.at for fault in both] == sorted(fault.at for fault in both)
    assert {fault.kind for fault in both} == {"bad_parts", "tray_moved"}
    assert len(rare) < len(both) / 2
    assert regime((), until=300.0) == ()


def test_an_assumption_that_there_is_not_is_refused() -> None:
    with pytest.raises(InputError, match="unknown assumption AK"):
        regime(["AK"], until=10.0)
