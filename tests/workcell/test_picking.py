"""Find, Locate, Track, Get, PutBack: success, abort, idempotence, abandon; by what is seen alone."""

from __future__ import annotations

import pytest

from planner_reactor.workcell.host import paced
from planner_reactor.workcell.kit import kit_from

from .driving import Rig


def test_find_takes_an_instance_and_gives_its_handle() -> None:
    rig = Rig()
    found = rig.run("Find", "motor")
    assert (found.outcome, rig.cell.memory.held) == ("stop", found.result)
    assert rig.cell.memory.parts[found.result].kind == "motor"
    assert rig.world.ledger()["held"] == 1


def test_a_handle_is_no_number_of_the_world() -> None:
    rig = Rig()
    rig.world.strike("camera_dark", duration_s=30.0)  # what comes meanwhile is not counted
    rig.wait(70.0)
    number = int(rig.held("body").removeprefix("part"))
    assert number < rig.plant.gripper.number  # type: ignore[union-attr]


def test_find_by_variant_takes_that_variant_only() -> None:
    kit = kit_from(
        '[belt]\ninterval_s = 4.0\n[[part]]\nkind = "cap"\nvariants = ["cap_a", "cap_b"]\nmix = { cap_b = 0.5 }'
    )
    for seed in range(8):
        rig = Rig(seed=seed, kit=kit)
        rig.held("cap_b")
        assert rig.plant.gripper.variant == "cap_b"  # type: ignore[union-attr]


def test_find_waits_for_a_part_and_aborts_when_none_comes() -> None:
    rig = Rig()
    rig.world.strike("starved_kind", part="motor", duration_s=1000.0)
    rig.wait(60.0)
    waiting = rig.begin("Find", "motor")
    rig.wait(30.0)
    assert waiting.outcome is None
    assert rig.finish(waiting).outcome == "abort"
    assert rig.cell.arm.owner is None
    assert rig.cell.arm.queue == []


def test_find_takes_a_part_that_comes_while_it_waits() -> None:
    rig = Rig()
    rig.world.strike("starved_kind", part="motor", duration_s=70.0)
    rig.wait(50.0)
    assert rig.run("Find", "motor").outcome == "stop"
    assert rig.scheduler.now > 70.0


def test_find_of_what_is_no_part_aborts_but_not_at_the_same_instant() -> None:
    rig = Rig()
    running = rig.begin_routine(paced(rig.routines["Find"], rig.scheduler)("moter"))
    assert running.outcome is None
    rig.finish(running)
    assert (running.outcome, running.reason, rig.scheduler.now) == ("abort", "no part is called moter", 0.2)


def test_find_aborts_and_reports_motion_when_the_gripper_closes_on_nothing() -> None:
    rig = Rig()
    finding = rig.begin("Find", "motor")
    assert not rig.world.strike("part_moved")  # the gripper is not about to close
    rig.plant.attempts.append(lambda: rig.world.strike("part_moved"))
    rig.finish(finding)
    assert finding.outcome == "abort"
    assert rig.reports == ["AM"]
    assert rig.holds("AM") is False
    assert rig.world.ledger()["held"] == 0
    assert rig.run("Find", "motor").outcome == "stop"


def test_a_part_that_leaves_with_the_belt_is_no_evidence_of_motion() -> None:
    rig = Rig()
    located = rig.run("Locate", "motor").result
    rig.wait(60.0)
    assert rig.run("Get", located).outcome == "abort"
    assert rig.reports == []


def test_get_of_a_tracked_part_follows_it_where_it_goes() -> None:
    rig = Rig()
    located = rig.run("Locate", "motor").result
    track, get = rig.begin("Track", located), rig.begin("Get", located)
    rig.plant.attempts.append(lambda: rig.world.strike("part_moved"))
    rig.finish(get)
    track.abandon()
    assert get.outcome == "stop"
    assert rig.cell.memory.held == located
    assert "AM" in rig.reports  # sensed all the same
    assert rig.cell.memory.parts[located].follower is None


def test_get_without_tracking_misses_a_part_that_moved() -> None:
    rig = Rig()
    located = rig.run("Locate", "motor").result
    rig.plant.attempts.append(lambda: rig.world.strike("part_moved"))
    assert rig.run("Get", located).outcome == "abort"


def test_get_of_what_is_held_already_stops_at_once() -> None:
    rig = Rig()
    part = rig.held()
    sent = rig.cell.arm.commands.sent
    assert rig.run("Get", part).outcome == "stop"
    assert rig.cell.arm.commands.sent == sent


def test_get_of_an_unknown_part_aborts() -> None:
    assert Rig().run("Get", "part99").outcome == "abort"


def test_two_locates_do_not_claim_the_same_part() -> None:
    rig = Rig()
    first, second = rig.begin("Locate", "motor"), rig.begin("Locate", "motor")
    rig.finish(first)
    rig.finish(second)
    assert first.result != second.result


def test_track_ends_only_by_being_disabled() -> None:
    rig = Rig()
    track = rig.begin("Track", rig.run("Locate", "cap").result)
    rig.wait(30.0)
    assert track.outcome is None
    track.abandon()


def test_put_back_returns_a_part_to_the_belt_and_needs_nothing_if_it_is_not_held() -> None:
    rig = Rig()
    part = rig.held()
    on_belt = rig.world.ledger()["on_belt"]
    assert rig.run("PutBack", part).outcome == "stop"
    assert rig.world.ledger()["held"] == 0
    assert rig.world.ledger()["on_belt"] >= on_belt
    sent = rig.cell.arm.commands.sent
    assert rig.run("PutBack", part).outcome == "stop"
    assert rig.cell.arm.commands.sent == sent


def test_a_tray_comes_from_the_stack_with_its_tag_read() -> None:
    rig = Rig()
    tray = rig.run("Find", "tray").result
    assert rig.cell.memory.trays[tray].tag.startswith("tag")
    assert rig.world.trays()["held"] == 1


def test_find_resumes_a_tray_that_stands_there_when_there_is_no_place_for_another() -> None:
    rig = Rig()
    tray = rig.tray()
    stacked = rig.world.trays()["stack"]
    assert rig.run("Find", "tray").result == tray
    assert rig.run("Locate", "tray").result == tray
    assert rig.run("Get", tray).outcome == "stop"
    assert rig.run("Test", "tray", tray).outcome == "stop"
    assert rig.run("Move", tray, "trayarea").outcome == "stop"
    assert rig.world.trays()["stack"] == stacked


def test_an_empty_stack_is_waited_for() -> None:
    rig = Rig(kit=kit_from('[trays]\nstock = 1\n[[part]]\nkind = "cap"'))
    rig.run("Move", rig.tray(), "trayarea")
    rig.run("Deliver", "tray1")
    assert rig.plant.stack == []
    assert rig.run("Find", "tray").outcome == "stop"
    assert rig.world.trays()["arrived"] == 9


@pytest.mark.parametrize("after", [0.1, 0.4, 1.5, 3.0])
def test_abandoning_find_leaves_no_command_and_no_claim(after: float) -> None:
    rig = Rig()
    finding = rig.begin("Find", "motor")
    rig.wait(after)
    finding.abandon()
    assert (rig.cell.arm.owner, rig.cell.arm.live, rig.cell.arm.queue) == (None, "", [])
    assert rig.world.balanced(), rig.world.findings
    assert rig.run("Find", "cap").outcome == "stop"


def test_a_part_of_another_kind_in_the_gripper_is_put_back() -> None:
    rig = Rig()
    located = rig.run("Locate", "motor").result
    record = rig.cell.memory.parts[located]
    other = next(iter(rig.plant.belt.parts["cap"].values()))
    record.u, record.y = other.u, other.y
    assert rig.run("Get", located).outcome == "abort"
    assert rig.world.ledger()["held"] == 0


def test_looking_for_what_the_standing_tray_already_has_finds_that_and_does_nothing() -> None:
    rig = Rig()
    tray = rig.tray()
    rig.run("FindGetInsert", "motor", tray)
    rig.wait(1.0)
    sent, now = rig.cell.arm.commands.sent, rig.scheduler.now
    part = rig.run("Find", "motor").result
    assert rig.run("Locate", "motor_a").result == part
    steps = (
        ("AwaitArrival", "motor"),
        ("Get", part),
        ("Test", "motor", part),
        ("Insert", part, tray),
        ("PutBack", part),
    )
    assert [rig.run(*step).outcome for step in steps] == ["stop"] * 5
    assert (rig.cell.arm.commands.sent, rig.scheduler.now) == (sent, now)
    assert rig.run("Find", "cap").result != part


def test_what_was_taken_out_of_the_tray_is_looked_for_again_once_that_is_known() -> None:
    rig = Rig()
    tray = rig.tray()
    rig.run("FindGetInsert", "motor", tray)
    rig.wait(1.0)
    rig.world.strike("part_removed_from_tray")
    placed = rig.run("Find", "motor").result
    assert rig.run("SlotVacant", tray, "motor").outcome == "stop"
    assert rig.run("Insert", placed, tray).outcome == "abort"
    fresh = rig.run("Find", "motor").result
    assert fresh != placed
    assert rig.run("Insert", fresh, tray).outcome == "stop"
    assert rig.world.ledger()["in_trays"] == 1


def test_what_somebody_else_put_into_the_tray_is_found_there_once_that_is_known() -> None:
    rig = Rig()
    tray = rig.tray()
    rig.world.strike("part_added_to_tray", part="motor")
    rig.run("SlotVacant", tray, "motor")
    sent = rig.cell.arm.commands.sent
    part = rig.run("Find", "motor").result
    assert rig.run("Insert", part, tray).outcome == "stop"
    assert rig.cell.arm.commands.sent == sent


def test_with_several_trays_standing_nothing_is_taken_for_settled() -> None:
    rig = Rig(kit=kit_from('[trays]\nplaces = 2\n[[part]]\nkind = "cap"'))
    first, second = rig.tray(), rig.tray()
    rig.run("FindGetInsert", "cap", first)
    part = rig.run("Find", "cap").result
    assert rig.run("Insert", part, second).outcome == "stop"
    assert rig.world.ledger()["in_trays"] == 2
