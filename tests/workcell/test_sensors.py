"""What is seen is not what is: noise, misses, confusions, darkness; and nothing else gets through."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest
from msgspec.structs import replace

import planner_reactor.workcell as workcell
from planner_reactor.workcell.calibration import PINNED
from planner_reactor.workcell.kit import kit_from
from planner_reactor.workcell.sensors import Glimpse

from .driving import Rig

ROBOT_SIDE = ("picking", "placing", "looking", "monitors", "watching", "memory", "evidence")
TRUTH = ("plant", "things", "belt", "world", "disturbances", "ledger")


@pytest.mark.parametrize("name", ROBOT_SIDE)
def test_processes_and_monitors_never_touch_the_truth(name: str) -> None:
    text = (Path(workcell.__file__).parent / f"{name}.py").read_text(encoding="utf-8")
    tree = ast.parse(text)
    imported = {
        node.module.rsplit(".", 1)[-1] for node in ast.walk(tree) if isinstance(node, ast.ImportFrom) and node.module
    }
    assert imported.isdisjoint(TRUTH)
    reached = {node.attr for node in ast.walk(tree) if isinstance(node, ast.Attribute)}
    assert reached.isdisjoint({"plant", "_plant", "marks", "good", "damaged", "number"})


def test_poses_are_noisy_but_good_enough_to_grasp() -> None:
    rig = Rig()
    glimpses = rig.cell.sensors.look("motor")
    assert glimpses
    true = [(part.u, part.y) for part in rig.plant.belt.parts["motor"].values()]
    away = [min(max(abs(g.u - u), abs(g.y - y)) for u, y in true) for g in glimpses]
    assert all(0 < a < PINNED.grasp_tolerance for a in away)


def test_a_picture_may_miss_a_part_and_show_the_wrong_variant_but_never_the_wrong_kind() -> None:
    rig = Rig(calibration=replace(PINNED, miss=0.3, variant_error=0.3))
    pictures = [rig.cell.sensors.look("motor") or [] for _ in range(200)]
    there = len(rig.plant.belt.parts["motor"])
    assert 0.6 < sum(map(len, pictures)) / (200 * there) < 0.8
    variants = [g.variant for picture in pictures for g in picture]
    assert 0.2 < sum(v != "motor_a" for v in variants) / len(variants) < 0.4
    assert {g.kind for picture in pictures for g in picture} == {"motor"}


def test_quality_is_nothing_that_a_camera_sees() -> None:
    assert "good" not in Glimpse.__slots__
    rig = Rig(kit=kit_from('[[part]]\nkind = "cap"\nquality = 0.5'))
    assert rig.cell.sensors.look("cap")


def test_in_the_dark_there_is_no_picture_rather_than_an_empty_one() -> None:
    rig = Rig()
    rig.tray()
    rig.world.strike("camera_dark", duration_s=5.0)
    sensors = rig.cell.sensors
    assert (sensors.look("motor"), sensors.trays(), sensors.follow(0.0, 0.0)) == (None, None, None)
    rig.wait(6.0)
    assert sensors.look("motor") is not None


def test_the_test_station_can_err_when_its_calibration_says_so() -> None:
    rig = Rig(calibration=replace(PINNED, test_error=1.0))
    assert rig.cell.sensors.test() is None
    rig.held()
    assert rig.cell.sensors.test() is False


def test_a_part_keeps_its_handle_while_it_rides_and_gets_a_new_one_when_it_was_moved_unseen() -> None:
    rig = Rig()
    memory, kind = rig.cell.memory, "motor"
    before = {r.handle for r in memory.parts.values() if r.kind == kind}
    rig.wait(3.0)
    rig.cell.look(kind)
    same = {r.handle for r in memory.parts.values() if r.kind == kind}
    assert before <= same
    rig.world.strike("part_moved", part=kind, closing=False)
    for _ in range(3):
        rig.cell.look(kind)
    assert before - {r.handle for r in memory.parts.values()}


def test_what_left_with_the_belt_is_forgotten() -> None:
    rig = Rig()
    rig.wait(1500.0)
    assert len(rig.cell.memory.parts) < 20


@pytest.mark.parametrize("handle", ["part1", "tray1"])
def test_a_handle_that_was_given_is_remembered_as_given(handle: str) -> None:
    rig = Rig()
    rig.tray()
    assert rig.cell.memory.was_given(handle)
    assert not rig.cell.memory.was_given(handle + "999")
    assert not rig.cell.memory.was_given("motor")
