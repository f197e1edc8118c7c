"""What relaxing adds: Choose, AwaitArrival, Test, LocateTray, SlotVacant, Verify, AwaitReady."""

from __future__ import annotations

from planner_reactor.workcell.kit import kit_from

from .driving import Rig


def test_choose_names_the_wanted_variant_while_it_is_in_sight() -> None:
    assert Rig().run("Choose", "motor").result == "motor_a"


def test_choose_names_a_substitute_only_when_the_wanted_variant_is_starved() -> None:
    kit = kit_from(
        '[[part]]\nkind = "cap"\nvariants = ["cap_a", "cap_b", "cap_c"]\nsubstitutes = ["cap_b"]\nmix = { cap_b = 1.0 }'
    )
    rig = Rig(kit=kit)
    assert rig.run("Choose", "cap").result == "cap_a"
    rig.wait(20.0)
    assert rig.run("Choose", "cap").result == "cap_b"
    assert rig.holds("AS") is False


def test_choose_never_names_a_variant_that_downstream_refuses() -> None:
    kit = kit_from('[[part]]\nkind = "cap"\nvariants = ["cap_a", "cap_c"]\nmix = { cap_c = 1.0 }')
    rig = Rig(kit=kit)
    rig.wait(60.0)
    assert rig.run("Choose", "cap").result == "cap_a"


def test_trays_have_no_variants_and_are_always_there() -> None:
    rig = Rig()
    assert rig.run("Choose", "tray").result == "tray"
    assert rig.run("AwaitArrival", "tray").outcome == "stop"


def test_await_arrival_ends_when_one_comes() -> None:
    rig = Rig()
    rig.world.strike("starved_kind", part="motor", duration_s=70.0)
    rig.wait(50.0)
    assert rig.run("AwaitArrival", "motor").outcome == "stop"
    assert rig.scheduler.now > 70.0
    assert rig.cell.memory.due["motor"] == 1


def test_await_arrival_takes_long_starvation_as_evidence_against_the_order() -> None:
    rig = Rig()
    rig.world.strike("starved_kind", part="motor", duration_s=1000.0)
    rig.wait(50.0)
    assert rig.run("AwaitArrival", "motor").outcome == "abort"
    assert rig.holds("AO") is False


def test_what_passes_its_test_stays_in_the_gripper_and_is_not_tested_twice() -> None:
    rig = Rig()
    part = rig.held()
    assert rig.run("Test", "motor", part).outcome == "stop"
    assert rig.cell.memory.held == part
    sent = rig.cell.arm.commands.sent
    assert rig.run("Test", "motor", part).outcome == "stop"
    assert rig.cell.arm.commands.sent == sent
    assert rig.holds("AQ") is True


def test_what_fails_its_test_is_discarded_before_the_abort() -> None:
    rig = Rig()
    rig.world.strike("bad_parts", part="motor", share=1.0)
    rig.wait(45.0)
    part = rig.held()
    assert rig.run("Test", "motor", part).outcome == "abort"
    assert (rig.world.ledger()["held"], rig.world.ledger()["rejected"]) == (0, 1)
    assert rig.holds("AQ") is False


def test_a_damaged_tray_fails_its_test() -> None:
    rig = Rig()
    rig.world.strike("damaged_trays")
    tray = rig.run("Find", "tray").result
    assert rig.run("Test", "tray", tray).outcome == "abort"
    assert rig.world.trays()["rejected"] == 1
    other = rig.run("Find", "tray").result
    assert rig.run("Test", "tray", other).outcome == "stop"


def test_testing_what_is_gone_aborts() -> None:
    rig = Rig()
    assert rig.run("Test", "motor", "part55").outcome == "abort"
    part = rig.held()
    rig.world.strike("part_dropped")
    assert rig.run("Test", "motor", part).outcome == "abort"
    assert rig.cell.memory.held == ""


def test_locate_tray_remembers_where_the_tray_is_now() -> None:
    rig = Rig()
    tray = rig.tray()
    rig.world.strike("tray_moved")
    assert rig.run("LocateTray", tray).outcome == "stop"
    assert rig.cell.memory.trays[tray].pose == next(iter(rig.plant.area.values())).pose
    assert rig.holds("ADT") is False


def test_slot_vacant_stops_for_a_vacant_slot_and_aborts_for_a_filled_one() -> None:
    rig = Rig()
    tray = rig.tray()
    assert rig.run("SlotVacant", tray, "motor").outcome == "stop"
    rig.world.strike("part_added_to_tray", part="motor")
    assert rig.run("SlotVacant", tray, "motor").outcome == "abort"
    assert rig.run("FindGetInsert", "motor", tray).outcome == "stop"  # known to be filled: nothing to do
    assert rig.world.ledger()["in_trays"] == 1


def test_slot_vacant_of_what_we_filled_is_no_evidence_against_anybody() -> None:
    rig = Rig()
    tray = rig.tray()
    rig.run("FindGetInsert", "motor", tray)
    assert rig.run("SlotVacant", tray, "motor").outcome == "abort"
    assert (rig.holds("AF"), rig.holds("ACP")) == (True, True)


def test_looking_into_the_slot_with_its_part_in_the_gripper_keeps_others_out_until_it_is_in() -> None:
    rig = Rig()
    tray, part = rig.tray(), rig.held()
    assert rig.run("SlotVacant", tray, "motor").outcome == "stop"
    assert not rig.world.strike("part_added_to_tray")
    assert rig.run("LocateTray", tray).outcome == "stop"
    assert not rig.world.strike("tray_moved")
    began = rig.scheduler.now
    assert rig.run("Insert", part, tray).outcome == "stop"
    assert rig.scheduler.now - began < 1.2  # the way there is done already


def test_verify_stops_for_a_full_tray_and_finds_what_went_missing() -> None:
    rig = Rig()
    tray = rig.tray()
    for kind in ("motor", "cap", "body"):
        rig.run("FindGetInsert", kind, tray)
    assert rig.run("Verify", tray).outcome == "stop"
    assert rig.holds("ACT") is True
    rig.wait(1.0)
    rig.world.strike("part_removed_from_tray", part="cap")
    assert rig.run("Verify", tray).reason == f"{tray} lacks cap"
    assert rig.holds("ACT") is False
    assert rig.run("FindGetInsert", "motor", tray).outcome == "stop"
    assert rig.run("FindGetInsert", "cap", tray).outcome == "stop"
    assert rig.run("Verify", tray).outcome == "stop"


def test_without_a_picture_looking_waits_and_says_neither_yes_nor_no() -> None:
    rig = Rig()
    tray = rig.tray()
    rig.world.strike("camera_dark", duration_s=10.0)
    looking = rig.begin("SlotVacant", tray, "motor")
    rig.wait(9.0)
    assert looking.outcome is None
    assert rig.finish(looking).outcome == "stop"
    assert rig.world.struck[0].sensed_s is not None


def test_a_lasting_darkness_ends_looking_and_finding_in_an_abort() -> None:
    rig = Rig()
    tray = rig.tray()
    rig.world.strike("camera_dark", duration_s=1000.0)
    assert rig.run("Verify", tray).outcome == "abort"
    assert rig.run("Find", "motor").outcome == "abort"


def test_await_ready_waits_for_downstreams_signal() -> None:
    rig = Rig()
    rig.world.strike("downstream_blocked", duration_s=30.0)
    waiting = rig.begin("AwaitReady")
    rig.wait(29.0)
    assert waiting.outcome is None
    rig.finish(waiting)
    assert (waiting.outcome, rig.scheduler.now) == ("stop", 30.0)


def test_await_ready_gives_up_after_its_patience() -> None:
    rig = Rig()
    rig.world.strike("downstream_blocked")
    assert rig.run("AwaitReady").outcome == "abort"
    assert rig.scheduler.now == rig.plant.calibration.patience_s
