"""FindGetInsert, Insert, Move, Deliver: what is placed, what is not, and that nothing is placed twice."""

from __future__ import annotations

import pytest

from planner_reactor.workcell.kit import kit_from

from .driving import Rig, trusting_kit


def test_find_get_insert_fills_the_slot() -> None:
    rig = Rig()
    tray = rig.tray()
    assert rig.run("FindGetInsert", "motor", tray).outcome == "stop"
    assert rig.world.ledger()["in_trays"] == 1
    assert set(next(iter(rig.plant.area.values())).slots) == {"motor"}


def test_a_pick_and_place_takes_about_six_and_a_half_seconds() -> None:
    rig = Rig()
    tray = rig.tray()
    began = rig.scheduler.now
    rig.run("FindGetInsert", "motor", tray)
    retreat = rig.plant.calibration.retreat_s
    assert rig.scheduler.now - began + retreat == pytest.approx(6.5, abs=0.3)


def test_repeating_find_get_insert_places_nothing_twice() -> None:
    rig = Rig()
    tray = rig.tray()
    for _ in range(3):
        assert rig.run("FindGetInsert", "motor", tray).outcome == "stop"
    assert rig.world.ledger()["in_trays"] == 1


def test_insert_puts_the_held_part_into_its_slot_and_repeating_it_stops_at_once() -> None:
    rig = Rig()
    tray, part = rig.tray(), rig.held("cap")
    assert rig.run("Insert", part, tray).outcome == "stop"
    sent = rig.cell.arm.commands.sent
    assert rig.run("Insert", part, tray).outcome == "stop"
    assert rig.cell.arm.commands.sent == sent
    assert rig.world.ledger()["in_trays"] == 1


def test_a_part_held_for_a_slot_that_is_filled_by_now_goes_back() -> None:
    rig = Rig()
    tray = rig.tray()
    rig.run("FindGetInsert", "cap", tray)
    part = rig.held("cap")
    assert rig.run("Insert", part, tray).outcome == "stop"
    assert (rig.world.ledger()["in_trays"], rig.world.ledger()["held"]) == (1, 0)


def test_inserting_what_is_not_held_aborts() -> None:
    rig = Rig()
    assert rig.run("Insert", "part7", rig.tray()).outcome == "abort"


def test_inserting_into_what_is_no_tray_aborts() -> None:
    rig = Rig()
    part = rig.held()
    assert rig.run("Insert", part, "part1").outcome == "abort"
    assert rig.run("Insert", part, "tray9").outcome == "abort"


def test_the_slot_is_pressed_into_without_looking_and_what_is_there_is_damaged() -> None:
    rig = Rig()
    rig.world.strike("filled_tray", part="motor")
    tray = rig.tray()
    attempt = rig.run("FindGetInsert", "motor", tray)
    assert attempt.outcome == "abort"
    assert rig.world.ledger()["rejected"] == 1  # the part that would not go in
    assert next(iter(rig.plant.area.values())).slots["motor"].damaged
    assert rig.holds("AF") is False
    assert rig.run("FindGetInsert", "motor", tray).outcome == "stop"  # it was felt: the slot is filled
    assert rig.world.ledger()["in_trays"] == 1


def test_a_slot_filled_by_somebody_else_meanwhile_is_told_from_one_that_came_filled() -> None:
    rig = Rig()
    tray = rig.tray()
    rig.world.strike("part_added_to_tray", part="motor")
    rig.run("FindGetInsert", "motor", tray)
    assert (rig.holds("ACP"), rig.holds("AF")) == (False, True)


def test_placing_by_a_remembered_pose_fails_when_the_tray_was_moved() -> None:
    rig = Rig()
    tray = rig.tray()
    rig.world.strike("tray_moved")
    for _ in range(2):
        assert rig.run("FindGetInsert", "motor", tray).outcome == "abort"
    assert rig.holds("ADT") is False
    assert rig.run("LocateTray", tray).outcome == "stop"
    assert rig.run("FindGetInsert", "motor", tray).outcome == "stop"


def test_a_part_that_slipped_away_is_noticed_when_it_should_go_in() -> None:
    rig = Rig()
    tray = rig.tray()
    placing = rig.begin("FindGetInsert", "motor", tray)
    rig.wait(5.0)
    assert rig.world.strike("part_dropped")
    assert rig.finish(placing).outcome == "abort"
    assert rig.world.struck[0].sensed_s == rig.scheduler.now
    assert rig.cell.memory.held == ""
    assert rig.run("FindGetInsert", "motor", tray).outcome == "stop"


def test_move_sets_a_tray_down_and_repeating_it_stops_at_once() -> None:
    rig = Rig()
    tray = rig.tray()
    sent = rig.cell.arm.commands.sent
    assert rig.run("Move", tray, "trayarea").outcome == "stop"
    assert rig.cell.arm.commands.sent == sent


def test_move_to_an_unknown_place_aborts() -> None:
    rig = Rig()
    assert rig.run("Move", rig.held(), "moon").outcome == "abort"


@pytest.mark.parametrize(("place", "account"), [("rejectbin", "rejected"), ("belt", "on_belt")])
def test_a_part_can_be_moved_to(place: str, account: str) -> None:
    rig = Rig()
    part = rig.held()
    before = rig.world.ledger()[account]
    assert rig.run("Move", part, place).outcome == "stop"
    assert rig.world.ledger()[account] >= before + (account == "rejected")
    assert rig.world.ledger()["held"] == 0


def test_a_part_cannot_be_moved_into_the_tray_area() -> None:
    rig = Rig()
    part = rig.held()
    assert rig.run("Move", part, "trayarea").outcome == "abort"


def test_deliver_hands_a_full_tray_over_and_it_is_judged_by_what_is_in_it() -> None:
    rig = Rig()
    rig.finish(rig.begin_routine(trusting_kit(rig)))
    assert rig.world.report()["kits"] == {"completed": 1, "rejected": 0}
    assert rig.world.ledger()["shipped"] == 3
    rig.wait(3.0)
    assert rig.cell.evidence.holds("AQ") is True


def test_an_incomplete_kit_is_rejected_and_downstream_says_so_later() -> None:
    rig = Rig()
    tray = rig.tray()
    rig.run("FindGetInsert", "motor", tray)
    assert rig.run("Deliver", tray).outcome == "stop"
    assert rig.world.report()["rejections"][0]["reasons"] == ["missing"]
    assert rig.cell.evidence.holds("ACT") is None
    rig.wait(3.0)
    assert rig.cell.evidence.holds("ACT") is False


def test_delivering_a_tray_that_has_left_stops_at_once() -> None:
    rig = Rig()
    tray = rig.tray()
    for _ in range(2):
        assert rig.run("Deliver", tray).outcome == "stop"
    assert len(rig.plant.downstream.rejections) == 1
    assert rig.run("FindGetInsert", "motor", tray).outcome == "stop"
    assert rig.run("Verify", tray).outcome == "stop"
    assert rig.world.ledger()["in_trays"] == 0


def test_a_blocked_downstream_refuses_and_the_kit_is_lost() -> None:
    rig = Rig()
    tray = rig.tray()
    rig.world.strike("downstream_blocked")
    assert rig.run("Deliver", tray).outcome == "abort"
    assert rig.world.report()["rejections"][0]["reasons"] == ["refused"]
    assert rig.run("Deliver", tray).outcome == "stop"  # it is gone: nothing is left to do


def test_an_abandoned_delivery_leaves_the_tray_where_it_stood_and_can_be_repeated() -> None:
    rig = Rig()
    tray = rig.tray()
    rig.run("FindGetInsert", "motor", tray)
    delivering = rig.begin("Deliver", tray)
    rig.wait(3.0)
    delivering.abandon()
    assert rig.world.trays()["held"] == 1
    assert rig.world.balanced(), rig.world.findings
    rig.wait(10.0)
    assert rig.world.trays()["area"] == 1
    assert rig.world.ledger()["in_trays"] == 1
    assert rig.run("Deliver", tray).outcome == "stop"


def test_a_delivery_goes_on_with_a_tray_that_is_still_held() -> None:
    rig = Rig()
    tray = rig.tray()
    delivering = rig.begin("Deliver", tray)
    rig.wait(3.0)
    delivering.abandon()
    assert rig.run("Deliver", tray).outcome == "stop"
    assert rig.world.trays()["rejected"] == 1


@pytest.mark.parametrize("after", [0.2, 1.0, 3.0, 5.2, 6.0])
def test_abandoning_find_get_insert_at_any_age_can_be_made_good(after: float) -> None:
    rig = Rig()
    tray = rig.tray()
    placing = rig.begin("FindGetInsert", "motor", tray)
    rig.wait(after)
    placing.abandon()
    assert (rig.cell.arm.owner, rig.cell.arm.live) == (None, "")
    assert rig.run("FindGetInsert", "motor", tray).outcome == "stop"
    assert rig.world.ledger()["in_trays"] == 1
    rig.wait(10.0)
    assert rig.world.ledger()["held"] == 0
    assert rig.world.balanced(), rig.world.findings


def test_several_trays_can_stand_in_a_larger_tray_area() -> None:
    rig = Rig(kit=kit_from('[trays]\nplaces = 2\n[[part]]\nkind = "cap"\n[[part]]\nkind = "body"'))
    first, second = rig.tray(), rig.tray()
    assert first != second
    assert rig.run("FindGetInsert", "cap", first).outcome == "stop"
    assert rig.run("FindGetInsert", "cap", second).outcome == "stop"
    assert rig.run("Find", "tray").result == first
