"""Fault lists: typed rows in any order, good errors, striking at the first instant at which they can."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pytest

from planner_reactor.errors import InputError
from planner_reactor.runtime import Scheduler, VirtualClock
from planner_reactor.workcell.disturbances import DISTURBANCES
from planner_reactor.workcell.evidence import ASSUMPTIONS
from planner_reactor.workcell.faults import FaultSchedule, faults_from, read_faults
from planner_reactor.workcell.papers import papers_faults, planner_durations

from .driving import Rig, build_kits, trusting_kit


def refused(text: str) -> str:
    with pytest.raises(InputError) as caught:
        faults_from(text, Rig().world, file="f.toml")
    return str(caught.value)


def test_every_assumption_is_broken_by_some_fault() -> None:
    assert {d.breaks for d in DISTURBANCES.values()} >= set(ASSUMPTIONS)


def test_rows_come_in_any_order_and_every_parameter_has_a_default(tmp_path: Path) -> None:
    file = tmp_path / "f.toml"
    rows = "".join(f'[[fault]]\nat = {500 - n}\nkind = "{kind}"\n' for n, kind in enumerate(DISTURBANCES))
    file.write_text(rows, encoding="utf-8")
    faults = read_faults(file, Rig().world)
    assert len(faults) == len(DISTURBANCES)
    assert [fault.at for fault in faults] == sorted(fault.at for fault in faults)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ('[[fault]]\nat = 1\nkind = "part_moved"\n[[fault]]\nat = 3\nkind = "tray_mooved"',
         "f.toml:6:1: unknown fault 'tray_mooved', did you mean tray_moved?"),
        ('[[fault]]\nat = 1\nkind = "part_moved"\nalong = 3.0',
         "f.toml:4:1: unknown parameter 'along' of part_moved, did you mean along_mm?"),
        ('[[fault]]\nat = 1\nkind = "bad_parts"\ncount = "many"',
         "'count' is 'many', expected a whole number"),
        ('[[fault]]\nat = 1\nkind = "bad_parts"\ncount = 0', "'count' is 0, expected at least 1"),
        ('[[fault]]\nat = 1\nkind = "bad_parts"\nshare = 1.5', "'share' is 1.5, expected above 0 to 1"),
        ('[[fault]]\nat = 1\nkind = "bad_parts"\npart = "moter"',
         "'moter' is no part kind, did you mean motor?"),
        ('[[fault]]\nat = 1\nkind = "variants"\npart = "cap"\nvariant = "cab_c"', "did you mean cap_c?"),
        ('[[fault]]\nat = 1\nkind = "part_moved"\nclosing = 1', "'closing' is 1, expected true or false"),
        ('[[fault]]\nkind = "part_moved"', "f.toml:1:1: a fault without 'at', expected seconds"),
        ('[[fault]]\nat = "soon"\nkind = "part_moved"', "f.toml:2:1: 'at' is 'soon'"),
        ('[[fault]]\nat = -1\nkind = "part_moved"', "expected seconds, 0 or more"),
        ("[[fault]]\nat = nan\nkind = 'part_moved'", "expected seconds, 0 or more"),
        ("[[fault]]\nat = 1", "a fault without 'kind'"),
        ("[[faults]]\nat = 1", "f.toml:1:1: unknown key 'faults', expected [[fault]] tables"),
        ("fault = 3", "expected [[fault]] tables"),
        ("[[fault]\nat = 1", "f.toml:1:8: Expected ']]'"),
    ],
)  # fmt: skip
def test_a_wrong_row_is_refused_with_place_and_nearest_name(text: str, said: str) -> None:
    assert said in refused(text)


def test_a_wrong_request_to_the_world_is_an_input_error() -> None:
    with pytest.raises(InputError, match="did you mean part_taken"):
        Rig().world.strike("part_token")
    with pytest.raises(InputError, match="it has no parameters"):
        Rig().world.strike("downstream_ready", now=True)


def test_a_fault_waits_for_the_first_instant_at_which_it_can_strike() -> None:
    rig = Rig(target=2)
    schedule = FaultSchedule(
        faults_from('[[fault]]\nat = 3.0\nkind = "part_removed_from_tray"', rig.world),
        rig.world,
        rig.scheduler,
    )
    build_kits(rig, trusting_kit)
    assert rig.trace is not None
    first = next(e for e in rig.trace.of("part_moved_to") if ":" in e.data["target"])
    (fault,) = rig.world.struck
    assert fault.struck_s >= first.time > 3.0
    assert schedule.unstruck() == ()


def test_a_fault_that_never_could_strike_is_told() -> None:
    rig = Rig(target=1)
    text = '[[fault]]\nat = 1.0\nkind = "downstream_ready"'
    schedule = FaultSchedule(faults_from(text, rig.world), rig.world, rig.scheduler)
    build_kits(rig, trusting_kit)
    assert [fault.kind for fault in schedule.unstruck()] == ["downstream_ready"]
    assert rig.world.struck == []


class Fussy:
    """Another world, without `attempts` and `refusal`: it can be struck from its third asking on."""

    faults: Mapping[str, Mapping[str, Any]] = {"crack": {"depth": 1.0}}

    def __init__(self) -> None:
        self.asked = 0

    def strike(self, kind: str, **parameters: Any) -> bool:
        self.asked += 1
        return self.asked == 3


def test_a_fault_list_serves_any_world() -> None:
    world, scheduler = Fussy(), Scheduler(VirtualClock())
    schedule = FaultSchedule(faults_from('[[fault]]\nat = 2\nkind = "crack"\ndepth = 3', world), world, scheduler)
    scheduler.run(until=10.0)
    assert (world.asked, schedule.unstruck()) == (3, ())
    with pytest.raises(InputError, match="did you mean depth"):
        faults_from('[[fault]]\nat = 2\nkind = "crack"\ndeth = 3', world)
    with pytest.raises(InputError, match="expected a number"):
        faults_from('[[fault]]\nat = 2\nkind = "crack"\ndepth = "x"', world)


def test_the_papers_run_is_there_as_data() -> None:
    rig = Rig()
    struck = [(fault.at, fault.kind) for fault in papers_faults(rig.world)]
    assert struck == [(152.0, "part_moved"), (215.0, "downstream_blocked"), (357.0, "downstream_ready")]
    durations = planner_durations()
    assert (durations.first_adaptation_s, durations.normal["AQ"], durations.normal["AS"]) == (26.0, 6.0, 30.0)
    assert durations.first_adaptation_s + 4 * durations.refinement_s == pytest.approx(40.0)
