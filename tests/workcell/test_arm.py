"""One arm: its queue with and without the placing order, what it holds for nobody, its commands."""

from __future__ import annotations

import pytest

from planner_reactor.workcell.kit import SERVOMOTOR

from .driving import Rig, together


def placed(rig: Rig) -> list[str]:
    assert rig.trace is not None
    targets = [e.data["target"] for e in rig.trace.of("part_moved_to")]
    return [target.split(":")[1] for target in targets if ":" in target]


def test_processes_begun_together_are_served_in_the_kits_order() -> None:
    rig = Rig()
    tray = rig.tray()
    kinds = ("body", "cap", "motor")  # begun in another order
    rig.finish(rig.begin_routine(together(rig, *(rig.call("FindGetInsert", kind, tray) for kind in kinds))))
    assert placed(rig) == list(SERVOMOTOR.order)


def test_in_the_fixed_order_a_starved_part_keeps_the_later_ones_back() -> None:
    rig = Rig()
    tray = rig.tray()
    rig.world.strike("starved_kind", part="motor", duration_s=75.0)
    rig.wait(36.0)  # the last one has passed
    kinds = [rig.begin("FindGetInsert", kind, tray) for kind in ("cap", "motor")]
    rig.wait(13.0)
    assert (placed(rig), rig.holds("AO")) == ([], None)
    rig.wait(6.0)
    assert rig.holds("AO") is False
    assert rig.cell.arm.starved() == "motor"
    for one in kinds:
        rig.finish(one)
    assert placed(rig) == ["motor", "cap"]


def test_after_awaiting_their_arrival_parts_are_taken_as_they_come() -> None:
    rig = Rig()
    tray = rig.tray()
    rig.world.strike("starved_kind", part="motor", duration_s=80.0)
    rig.wait(60.0)

    def opportunistic(kind: str):  # type: ignore[no-untyped-def]
        yield from rig.call("AwaitArrival", kind)
        yield from rig.call("FindGetInsert", kind, tray)

    rig.finish(rig.begin_routine(together(rig, *(opportunistic(kind) for kind in ("motor", "body", "cap")))))
    assert placed(rig)[-1] == "motor"


def test_an_opportunity_that_is_gone_aborts_instead_of_keeping_others_back() -> None:
    rig = Rig()
    rig.run("AwaitArrival", "motor")
    rig.world.strike("starved_kind", part="motor", duration_s=500.0)
    finding = rig.begin("Find", "motor")
    for part in list(rig.plant.belt.parts["motor"].values()):
        rig.plant.take_from_belt(part, "test")
    rig.finish(finding, within=10.0)
    assert (finding.outcome, rig.cell.arm.queue) == ("abort", [])


def test_a_locate_in_the_fixed_order_keeps_later_kinds_back_too() -> None:
    rig = Rig()
    tray = rig.tray()
    rig.world.strike("starved_kind", part="motor", duration_s=100.0)
    rig.wait(60.0)
    locating, placing = rig.begin("Locate", "motor"), rig.begin("FindGetInsert", "cap", tray)
    rig.wait(20.0)
    assert placed(rig) == []
    locating.abandon()
    assert rig.finish(placing, within=10.0).outcome == "stop"


def test_what_is_held_for_nobody_is_put_back_after_some_seconds() -> None:
    rig = Rig()
    rig.held("motor")
    assert rig.cell.arm.reconciling
    rig.wait(rig.plant.calibration.reconcile_s + rig.plant.calibration.put_back_s + 0.1)
    assert rig.world.ledger()["held"] == 0
    assert rig.cell.memory.held == ""
    assert not rig.cell.arm.reconciling


def test_a_tray_held_for_nobody_goes_back_onto_the_stack_and_moving_it_then_aborts() -> None:
    rig = Rig()
    tray = rig.run("Find", "tray").result
    rig.wait(10.0)
    assert rig.world.trays()["stack"] == 12
    assert rig.run("Move", tray, "trayarea").outcome == "abort"
    again = rig.run("Find", "tray").result
    assert again != tray
    assert rig.run("Move", again, "trayarea").outcome == "stop"


def test_a_reaction_withdrawn_between_find_and_insert_cannot_block_the_arm_for_ever() -> None:
    rig = Rig()
    tray = rig.tray()
    rig.held("motor")
    assert rig.run("FindGetInsert", "cap", tray, within=20.0).outcome == "stop"


def test_taking_up_what_is_held_stops_the_putting_away() -> None:
    rig = Rig()
    tray, part = rig.tray(), rig.held("motor")
    rig.wait(rig.plant.calibration.reconcile_s - 0.1)
    assert rig.run("Insert", part, tray).outcome == "stop"


def test_what_is_being_put_away_can_no_longer_be_inserted() -> None:
    rig = Rig()
    tray, part = rig.tray(), rig.held("motor")
    rig.wait(rig.plant.calibration.reconcile_s + 0.1)
    assert rig.run("Insert", part, tray).outcome == "abort"
    assert rig.world.balanced(), rig.world.findings


def test_something_that_slipped_away_unnoticed_does_not_block_the_arm() -> None:
    rig = Rig()
    rig.held("motor")
    rig.world.strike("part_dropped")
    assert rig.run("Find", "cap").outcome == "stop"


@pytest.mark.parametrize(
    "name", ["Find", "Get", "Locate", "PutBack", "Insert", "Test", "SlotVacant", "Deliver", "Move"]
)
@pytest.mark.parametrize("after", [0.0, 0.1, 0.6, 2.0, 4.0])
def test_every_command_is_done_or_abandoned_and_none_stays_live(name: str, after: float) -> None:
    rig = Rig()
    tray = rig.tray() if name not in ("Move", "Locate", "Find") else ""
    if name in ("Insert", "Test", "PutBack", "SlotVacant"):
        part = rig.held("motor")
    elif name == "Get":
        part = rig.run("Locate", "motor").result
    elif name == "Move":
        part = rig.run("Find", "tray").result
    else:
        part = "motor"
    arguments = {
        "Insert": (part, tray), "Test": ("motor", part), "SlotVacant": (tray, "motor"), "Deliver": (tray,),
        "Move": (part, "trayarea"),
    }.get(name, (part,))  # fmt: skip
    running = rig.begin(name, *arguments)
    rig.wait(after)
    if running.outcome is None:
        running.abandon()
    assert (rig.cell.arm.owner, rig.cell.arm.live) == (None, "")
    assert rig.world.balanced(), rig.world.findings
    rig.wait(15.0)
    assert rig.world.balanced(), rig.world.findings
    assert rig.world.ledger()["held"] + rig.world.trays()["held"] == 0
    books = rig.world.commands()
    assert books["sent"] == books["done"] + books["abandoned"]


def test_a_thing_held_that_nobody_will_see_to_is_a_finding() -> None:
    rig = Rig()
    rig.held("motor")
    rig.cell.arm._reconcile.cancel()  # type: ignore[union-attr]
    rig.cell.arm._reconcile = None
    assert not rig.world.balanced()
    assert rig.world.findings[-1].law == "held"


def test_a_command_that_is_lost_is_a_finding() -> None:
    rig = Rig()
    rig.held("motor")
    rig.cell.arm.commands.sent += 1
    assert not rig.world.balanced()
    assert rig.world.findings[0].law == "commands"
