"""What the sensors say of each assumption: holds, fails, or unknown; never by the truth."""

from __future__ import annotations

import pytest

from planner_reactor.workcell.evidence import ASSUMPTIONS

from .driving import Rig, build_kits, careful_kit, trusting_kit


def test_nothing_is_known_before_anything_was_seen_but_downstreams_line() -> None:
    rig = Rig()
    assert {a: rig.holds(a) for a in ASSUMPTIONS} == dict.fromkeys(ASSUMPTIONS) | {"ADD": True}


@pytest.mark.parametrize("kit", [trusting_kit, careful_kit])
def test_in_an_undisturbed_cell_no_assumption_ever_fails(kit: object) -> None:
    rig = Rig(target=40, traced=False)
    answers: set[bool | None] = set()

    def ask() -> None:
        answers.update(rig.holds(a) for a in ASSUMPTIONS)
        rig.scheduler.call_after(2.0, ask)

    ask()
    build_kits(rig, kit)
    assert answers == {True, None}
    assert sum(rig.cell.evidence.counts.values()) == 0


def test_after_some_kits_every_assumption_is_borne_out() -> None:
    rig = Rig(target=3)
    build_kits(rig, trusting_kit)
    rig.tray()
    rig.run("FindGetInsert", "motor", "tray4")
    assert [a for a in ASSUMPTIONS if rig.holds(a) is not True] == []


@pytest.mark.parametrize(
    ("fault", "assumption"),
    [("part_removed_from_tray", "ACT"), ("part_added_to_tray", "ACP"), ("tray_moved", "ADT")],
)
def test_a_look_at_the_tray_area_shows(fault: str, assumption: str) -> None:
    rig = Rig()
    rig.run("FindGetInsert", "motor", rig.tray())
    rig.wait(1.0)
    assert rig.holds(assumption) is not False
    rig.world.strike(fault)
    rig.wait(0.1)  # one picture an instant
    assert rig.holds(assumption) is False
    others = [a for a in ASSUMPTIONS if rig.holds(a) is False]
    assert others == [assumption]
    assert rig.world.struck[0].sensed_s == rig.scheduler.now


def test_a_tray_that_came_filled_is_seen_by_the_palm_camera_when_it_is_taken() -> None:
    rig = Rig()
    rig.world.strike("filled_tray")
    assert rig.holds("AF") is None
    rig.tray()
    assert rig.holds("AF") is False
    assert rig.holds("ACP") is not False


def test_without_a_picture_what_was_true_is_not_taken_for_false() -> None:
    rig = Rig()
    rig.run("FindGetInsert", "motor", rig.tray())
    rig.wait(1.0)
    rig.world.strike("part_removed_from_tray")
    rig.world.strike("camera_dark", duration_s=30.0)
    rig.wait(1.0)
    assert rig.holds("ACT") is None
    rig.wait(30.0)
    assert rig.holds("ACT") is False


def test_unwanted_variants_are_seen_at_the_entrance() -> None:
    rig = Rig()
    rig.world.strike("variants", share=1.0)
    rig.wait(40.0)
    assert rig.holds("AS") is False


def test_a_single_confusion_of_the_camera_is_no_evidence() -> None:
    rig = Rig()
    record = rig.cell.memory.parts["part1"]
    record.votes = {"motor_a": 5, "motor_c": 1}
    rig.cell._judge_variant(record, "motor_a")
    assert rig.holds("AS") is None


def test_bad_quality_is_known_only_by_test_or_by_downstream() -> None:
    rig = Rig()
    rig.world.strike("bad_parts", share=1.0, count=50)
    rig.wait(60.0)
    assert rig.holds("AQ") is None  # no camera sees it
    rig.finish(rig.begin_routine(trusting_kit(rig)))
    assert rig.holds("AQ") is None
    rig.wait(3.0)
    assert rig.holds("AQ") is False


def test_downstreams_line_is_asked_directly_and_returns() -> None:
    rig = Rig()
    rig.world.strike("downstream_blocked", duration_s=10.0)
    assert rig.holds("ADD") is False
    rig.wait(11.0)
    assert rig.holds("ADD") is True


def test_evidence_against_fades_when_it_is_not_renewed() -> None:
    rig = Rig()
    rig.cell.evidence.against("AQ", "test")
    rig.wait(rig.plant.calibration.quiet_s)
    assert rig.holds("AQ") is False
    rig.wait(1.0)
    assert rig.holds("AQ") is None
    rig.cell.evidence.supports("AQ")
    assert rig.holds("AQ") is True


def test_only_motion_is_reported_by_the_process_itself() -> None:
    rig = Rig()
    for assumption in ASSUMPTIONS:
        rig.cell.evidence.against(assumption, "test")
    assert rig.reports == ["AM"]


def test_a_kind_that_stays_away_is_noticed_at_the_entrance_even_if_nobody_needs_it() -> None:
    rig = Rig()
    rig.world.strike("starved_kind", part="body")
    rig.wait(100.0)
    assert rig.holds("AO") is False


def test_what_could_not_be_seen_in_the_dark_is_not_taken_for_starvation() -> None:
    rig = Rig()
    rig.world.strike("camera_dark", duration_s=200.0)
    rig.wait(300.0)
    assert rig.holds("AO") is None


def test_a_part_that_came_with_the_tray_and_is_gone_is_evidence_against_parts_staying() -> None:
    rig = Rig()
    rig.world.strike("filled_tray", part="cap")
    tray = rig.tray()
    rig.world.strike("part_removed_from_tray")
    assert rig.holds("ACT") is False
    assert rig.run("SlotVacant", tray, "cap").outcome == "stop"
    rig.wait(200.0)
    assert rig.holds("ACT") is None


def test_a_picture_taken_for_a_part_shows_the_trays_as_well() -> None:
    rig = Rig()
    rig.run("FindGetInsert", "motor", rig.tray())
    rig.wait(2.0)
    rig.world.strike("part_removed_from_tray")
    rig.run("Choose", "cap")
    assert rig.cell.evidence.holds("ACT") is False  # without any monitor
