"""Each fault strikes, is sensed, leaves the books balanced; trusting behaviour pays, careful copes."""

from __future__ import annotations

import pytest

from planner_reactor.workcell.audit import audit
from planner_reactor.workcell.disturbances import DISTURBANCES
from planner_reactor.workcell.evidence import ASSUMPTIONS
from planner_reactor.workcell.faults import FaultSchedule, faults_from

from .driving import Rig, build_kits, careful_kit, trusting_kit

STRUCK_BY_ITSELF = [kind for kind in DISTURBANCES if kind != "downstream_ready"]
COSTS_A_KIT = {
    "bad_parts": "bad",
    "damaged_trays": "damaged tray",
    "variants": "wrong variant",
    "filled_tray": "damaged",
    "part_removed_from_tray": "missing",
    "part_added_to_tray": "damaged",
    "downstream_blocked": "refused",
}


def poll(rig: Rig) -> None:
    """Ask every monitor each two seconds, as ASSUMONITOR does."""
    for assumption in ASSUMPTIONS:
        rig.holds(assumption)
    rig.scheduler.call_after(2.0, lambda: poll(rig))


def struck(kind: str, kit: object, *, until: float = 500.0, seed: int = 3, extra: str = "") -> Rig:
    """A run of 500 s in which the fault strikes at 100 s."""
    rig = Rig(seed=seed)
    text = f'[[fault]]\nat = 100.0\nkind = "{kind}"\n{extra}\n'
    if kind == "downstream_blocked":
        text += '[[fault]]\nat = 170.0\nkind = "downstream_ready"\n'
    schedule = FaultSchedule(faults_from(text, rig.world), rig.world, rig.scheduler)
    poll(rig)
    build_kits(rig, kit, until=until)
    assert schedule.unstruck() == ()
    return rig


@pytest.mark.parametrize("kind", STRUCK_BY_ITSELF)
@pytest.mark.parametrize("kit", [trusting_kit, careful_kit])
def test_it_strikes_is_sensed_and_leaves_the_books_balanced(kind: str, kit: object) -> None:
    rig = struck(kind, kit)
    assert rig.trace is not None
    for fault in rig.world.struck:
        assert fault.struck_s >= 100.0
        assert fault.sensed_s is not None
        assert fault.sensed_s >= fault.struck_s
    assert rig.world.balanced(), rig.world.findings
    audited = audit(rig.trace.events)
    assert audited.mistakes == []
    assert audited.ledger() == rig.world.ledger()
    assert audited.tray_ledger() == rig.world.trays()


@pytest.mark.parametrize("kind", COSTS_A_KIT)
def test_trusting_behaviour_loses_a_kit_and_the_record_says_to_what(kind: str) -> None:
    rig = struck(kind, trusting_kit)
    lost = rig.world.report()["rejections"]
    assert lost
    for one in lost:
        assert one["reasons"] == [COSTS_A_KIT[kind]]
        assert one["faults"] == [kind]
        assert one["assumptions"] == [DISTURBANCES[kind].breaks]
    assert rig.world.report()["faults"][0]["kits_lost"] == len(lost)


@pytest.mark.parametrize("kind", STRUCK_BY_ITSELF)
@pytest.mark.parametrize("seed", [3, 4])
def test_careful_behaviour_loses_none_and_goes_on(kind: str, seed: int) -> None:
    rig = struck(kind, careful_kit, seed=seed)
    kits = rig.world.report()["kits"]
    assert kits["rejected"] == 0
    assert kits["completed"] >= 5


def test_a_moved_tray_stops_trusting_behaviour_for_good() -> None:
    trusting, careful = struck("tray_moved", trusting_kit), struck("tray_moved", careful_kit)
    assert trusting.plant.downstream.completed <= 4
    assert trusting.plant.books.parts["rejected"] > 10
    assert careful.plant.downstream.completed >= 10
    assert careful.plant.books.parts["rejected"] == 0


def test_parts_that_keep_moving_delay_trusting_behaviour_much_longer() -> None:
    extra = "count = 12"
    trusting, careful = (
        struck("part_moved", trusting_kit, extra=extra),
        struck("part_moved", careful_kit, extra=extra),
    )
    quiet, quiet_careful = Rig(seed=3), Rig(seed=3)
    build_kits(quiet, trusting_kit, until=500.0)
    build_kits(quiet_careful, careful_kit, until=500.0)
    assert trusting.cell.evidence.counts["AM"] == 12
    assert quiet.plant.downstream.completed - trusting.plant.downstream.completed >= 1
    assert quiet_careful.plant.downstream.completed - careful.plant.downstream.completed <= 1


def test_an_arrival_order_other_than_assumed_halves_the_output_of_the_fixed_order() -> None:
    extra = "duration_s = 5000.0"
    trusting = struck("arrival_order", trusting_kit, extra=extra, until=2000.0)
    careful = struck("arrival_order", careful_kit, extra=extra, until=2000.0)
    assert careful.plant.downstream.completed > 1.3 * trusting.plant.downstream.completed


def test_downstream_ready_is_sensed_and_reinstates() -> None:
    rig = struck("downstream_blocked", careful_kit)
    blocked, ready = rig.world.struck
    assert (blocked.sensed_s, ready.sensed_s) == (100.0, 170.0)
    assert rig.holds("ADD") is True


def test_a_promise_of_downstream_outlasts_a_breakdown() -> None:
    rig = Rig()
    rig.tray()
    assert rig.run("AwaitReady").outcome == "stop"
    rig.world.strike("downstream_blocked")
    assert rig.run("Deliver", "tray1").outcome == "stop"
    assert rig.plant.downstream.rejections[0].reasons == ("missing",)  # taken, and judged


def test_nobody_reaches_under_a_working_arm() -> None:
    rig = Rig()
    tray, part = rig.tray(), rig.held()
    inserting = rig.begin("Insert", part, tray)
    rig.wait(2.8)
    assert rig.plant.arm_over_trays
    assert not rig.world.strike("tray_moved")
    rig.finish(inserting)
    rig.wait(1.0)
    assert rig.world.strike("tray_moved")


def test_a_fault_of_one_kind_of_part_spares_the_others() -> None:
    rig = struck("variants", trusting_kit, extra='part = "cap"\nvariant = "cap_b"\ncount = 6')
    assert rig.trace is not None
    seen = {e.data["variant"] for e in rig.trace.of("part_arrived")}
    assert seen == {"motor_a", "cap_a", "cap_b", "body_a"}
    assert rig.plant.downstream.rejections == []  # cap_b is an accepted substitute


def test_parts_can_be_moved_and_taken_while_the_gripper_is_elsewhere() -> None:
    rig = Rig()
    before = dict(rig.world.ledger())
    assert rig.world.strike("part_moved", closing=False, part="cap", along_mm=-5000.0)
    assert rig.world.strike("part_taken", closing=False)
    after = rig.world.ledger()
    assert (after["taken"], after["on_belt"]) == (1, before["on_belt"] - 1)
    assert rig.world.balanced()
