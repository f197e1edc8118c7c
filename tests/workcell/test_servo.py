"""Picking by a derived reaction: what the cell offers for it, and that kits come of it (X §5.2; AM relaxed)."""

from __future__ import annotations

import re

import pytest

from planner_reactor.errors import InputError
from planner_reactor.experiments.loop import Loop
from planner_reactor.experiments.picking import Trial, begun, domain_for, one
from planner_reactor.planner import Planner
from planner_reactor.workcell.domains import shipped_domain, without_tracking
from planner_reactor.workcell.faults import Fault, FaultSchedule
from planner_reactor.workcell.host import host


def test_the_hand_written_actions_are_gone_and_the_derived_ones_are_there() -> None:
    domain = domain_for("derived")
    assert not {"Track", "Get"} & set(domain.schemas)
    assert {"Over", "Close", "LOOK", "MOVETOWARDS", "CONTACT"} <= set(domain.schemas)
    assert "MOVECAMERA" not in domain.schemas  # the cell has no port for it


def test_the_planner_finds_guarded_move_between_over_and_close() -> None:
    loop = begun(Trial("derived", 0, 1, 1))
    loop.run(until=20.0)
    assert re.search(r"Over\[x1\] : \(IN\[t\].*OUT\[FindPartCap_x2.*OUT\[r, .*\) : Close\[x1\]", loop.reactor.text())


@pytest.mark.parametrize("slides", [0, 2])
def test_it_makes_kits_whether_or_not_parts_slide_away(slides: int) -> None:
    row = one(Trial("derived", slides, 1, 2))
    assert (row["kits"], row["rejected"], row["violations"], row["interruptions"]) == (2, 0, 0, 0)
    assert (row["struck"] > 0) == (slides > 0)


def test_it_is_as_fast_as_the_hand_written_one_and_does_not_give_up() -> None:
    hand, derived = one(Trial("hand", 1, 1, 2)), one(Trial("derived", 1, 1, 2))
    assert derived["per_kit_s"] <= 1.01 * hand["per_kit_s"]
    hand, derived = one(Trial("hand", 4, 1, 2)), one(Trial("derived", 4, 1, 2))
    assert derived["per_kit_s"] < hand["per_kit_s"]


@pytest.mark.parametrize(
    ("kind", "parameters"),
    [("part_moved", {"along_mm": 0.0, "across_mm": 30.0}), ("part_taken", {}), ("camera_dark", {"duration_s": 8.0})],
)
def test_the_arm_is_never_kept_by_a_part_that_is_lost(kind: str, parameters: dict[str, float]) -> None:
    loop = begun(Trial("derived", 0, 1, 2))
    world = loop.host.world
    assert world is not None
    schedule = FaultSchedule((Fault(at=15.0, kind=kind, parameters=parameters),), world, loop.scheduler)
    loop.run(until=300.0)
    assert not schedule.unstruck()
    assert world.report()["kits"]["completed"] == 2  # type: ignore[index]
    assert loop.reactor.laws.violations == []


def test_it_takes_over_where_the_hand_written_way_has_failed() -> None:
    """AM is held at first, so that parts are placed already when it is given up."""
    planner = Planner(domain_for("derived"), relax=())
    loop = Loop(planner, lambda scheduler, trace: host(scheduler, target=3, servo=True, trace=trace), seed=1)
    world = loop.host.world
    assert world is not None
    FaultSchedule((Fault(at=30.0, kind="part_moved", parameters={}),), world, loop.scheduler)
    loop.run(until=200.0)
    assert dict(planner.relaxed) == {"AM": "forced"}
    assert world.report()["kits"]["completed"] == 3  # type: ignore[index]
    assert "Over[" in loop.reactor.text()
    assert (loop.reactor.laws.violations, loop.reactor.laws.interruptions) == ([], 0)


def test_a_domain_without_track_and_get_has_none_to_replace() -> None:
    with pytest.raises(InputError, match="Track and Get once each, found 0"):
        without_tracking(without_tracking(shipped_domain()))
