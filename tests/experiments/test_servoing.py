"""Planner, reactor and a world of RS processes, live: tracked, reached, awaited, and changed between (X §5)."""

from __future__ import annotations

from pathlib import Path

import pytest

from planner_reactor.experiments import acquiring, tracking
from planner_reactor.experiments.figures_servo import draw_contact, draw_error, draw_sweep, draw_switching
from planner_reactor.experiments.loop import Loop
from planner_reactor.experiments.servoing import Scene, play

STANDING = {"p": 0.0, "a": 0.0}


def test_the_reactor_gets_track_when_the_object_is_seen_to_move() -> None:
    run = play(Scene(kind="tracking", starts=STANDING, until=20.0))
    assert dict(run.loop.planner.relaxed) == {"Still": "forced"}
    assert [e.data["purpose"] for e in run.loop.trace.of("adaptation_applied")] == ["goal Keep", "give up Still: Keep"]
    assert "OUT[m1" in run.loop.reactor.text()
    assert (run.loop.reactor.laws.interruptions, run.loop.reactor.laws.violations) == (0, [])
    assert (run.loop.planner.breaches, dict(run.loop.planner.withheld)) == ((), {})


def test_an_object_that_stands_still_is_never_tracked() -> None:
    run = play(Scene(kind="tracking", starts=STANDING, constants={"eps": 0.0}, until=20.0))
    assert dict(run.loop.planner.relaxed) == {}
    assert len(run.world.gauge.courses["a"]) == 1
    assert "OUT[m1" not in run.loop.reactor.text()


def test_one_seed_is_one_run() -> None:
    scene = acquiring.scene(acquiring.Trial("move", 3))
    assert play(scene).loop.trace.hash == play(scene).loop.trace.hash


@pytest.mark.parametrize("seed", [1, 2])
def test_track_keeps_the_object_in_view_when_it_is_dense_enough_and_fails_when_it_is_not(seed: int) -> None:
    assert tracking.one(tracking.Trial(0.4, seed, 60.0))["in_view"] >= 0.99
    assert tracking.one(tracking.Trial(2.0, seed, 60.0))["in_view"] < 0.95


def test_where_it_fails_follows_from_the_texts() -> None:
    assert all(check.holds for check in tracking.checks(0.4))
    assert {c.name for c in tracking.checks(2.0) if not c.holds} == {"reads", "corrects", "covers"}


@pytest.mark.parametrize("seed", range(1, 6))
def test_guarded_move_acquires_what_moves_at_random(seed: int) -> None:
    row = acquiring.one(acquiring.Trial("move", seed))
    assert (row["taken"], row["lost"], row["violations"], row["interruptions"]) == (1, 0, [], 0)
    assert row["moves"] > 0


@pytest.mark.parametrize("seed", range(1, 6))
def test_guarded_wait_acquires_without_a_motion(seed: int) -> None:
    row = acquiring.one(acquiring.Trial("wait", seed))
    assert (row["taken"], row["lost"], row["moves"], row["grips"]) == (1, 0, 0, 1)


def test_the_reaction_changes_with_the_belt_and_no_object_is_lost() -> None:
    row = acquiring.one(acquiring.Trial("switch", 1, 120.0))
    assert row["strikes"] == row["changes"] > 1
    assert (row["lost"], row["violations"], row["interruptions"]) == (0, [], 0)
    assert row["taken"] > 5


def test_the_stop_button_stops_the_robot_and_not_the_world() -> None:
    scene = acquiring.scene(acquiring.Trial("move", 4))

    def press(loop: Loop) -> None:
        loop.scheduler.call_at(1.0, loop.reactor.halt)

    gauge = play(scene, watch=press).world.gauge
    assert gauge.courses["pr"][-1][0] < 1.0 + 0.3  # what the motor has taken it finishes
    assert gauge.courses["p"][-1][0] > 50.0


def test_the_figures_are_drawn(tmp_path: Path) -> None:
    run = play(acquiring.scene(acquiring.Trial("switch", 1, 80.0)))
    rows = [{"way": way, "contact_s": 1.0 + n, "moves": n} for way in ("move", "wait") for n in range(3)]
    sweep = [{"period": p, "mean": 1.0, "least": 0.9, "runs": 2} for p in (0.5, 1.0)]
    written = [
        *draw_error([tracking.course(tracking.played(tracking.Trial(0.4, 1, 5.0)))], 1.0, tmp_path),
        *draw_sweep(sweep, {"corrects": 0.9, "reads": 1.0}, tmp_path),
        *draw_contact(rows, tmp_path),
        *draw_switching(acquiring.story(run), tmp_path),
    ]
    assert {file.stem for file in written} == {"tracking_error", "tracking_sweep", "contact", "switching"}
    assert all(file.stat().st_size > 5000 for file in written)
