"""Kits can be built before there is a planner, by a scripted controller; and the world by itself."""

from __future__ import annotations

import statistics
from itertools import pairwise

import pytest

from planner_reactor.workcell.calibration import PINNED
from planner_reactor.workcell.kit import SERVOMOTOR, kit_from, plain_kit

from .driving import Rig, build_kits, careful_kit, trusting_kit


@pytest.mark.parametrize("kit", [trusting_kit, careful_kit])
def test_fifty_kits(kit: object) -> None:
    rig = Rig(target=50)
    build_kits(rig, kit)
    assert rig.world.finished()
    assert rig.world.report()["kits"] == {"completed": 50, "rejected": 0}
    assert rig.world.ledger()["shipped"] == 150
    assert rig.world.balanced()


def test_an_undisturbed_kit_takes_the_time_that_the_calibration_says() -> None:
    rig = Rig(target=20, traced=False)
    build_kits(rig, trusting_kit)
    assert rig.scheduler.now / 20 == pytest.approx(PINNED.kit_s(3), rel=0.05)


@pytest.mark.parametrize("kinds", [1, 7, 100])
@pytest.mark.parametrize("kit", [trusting_kit, careful_kit])
def test_kits_of_many_kinds(kinds: int, kit: object) -> None:
    rig = Rig(kit=plain_kit(kinds), target=1, traced=False)
    build_kits(rig, kit)
    assert rig.world.report()["kits"] == {"completed": 1, "rejected": 0}
    assert rig.scheduler.now < 2 * PINNED.kit_s(kinds)


def test_arrivals_are_stochastic_with_the_mean_that_the_kit_says() -> None:
    rig = Rig()
    rig.wait(3000.0)
    assert rig.trace is not None
    for kind in SERVOMOTOR.parts:
        times = [e.time for e in rig.trace.of("part_arrived") if e.data["part_kind"] == kind.kind and e.time > 0]
        gaps = [b - a for a, b in pairwise(times)]
        assert statistics.mean(gaps) == pytest.approx(kind.interval_s, rel=0.05)
        assert statistics.stdev(gaps) > 0.1 * kind.interval_s


def test_parts_that_nobody_takes_leave_at_the_belts_end() -> None:
    rig = Rig()
    rig.wait(500.0)
    assert rig.world.ledger()["passed"] > 60
    assert rig.world.ledger()["on_belt"] == pytest.approx(9, abs=3)


def test_the_same_seed_gives_the_same_run_and_another_seed_another() -> None:
    def run(seed: int) -> str:
        rig = Rig(target=5, seed=seed)
        build_kits(rig, careful_kit)
        assert rig.trace is not None
        return rig.trace.hash

    assert run(1) == run(1)
    assert run(1) != run(2)


def test_what_is_drawn_in_one_place_does_not_shift_what_arrives() -> None:
    def arrivals(kit: object) -> list[tuple[float, str]]:
        rig = Rig(seed=4)
        build_kits(rig, kit, until=200.0)
        assert rig.trace is not None
        return [(e.time, e.data["part_kind"]) for e in rig.trace.of("part_arrived")]

    assert arrivals(trusting_kit) == arrivals(careful_kit)


def test_background_quality_and_mix_are_as_the_kit_says() -> None:
    text = '[[part]]\nkind = "cap"\nquality = 0.7\nvariants = ["a", "b"]\nmix = { b = 0.4 }\ninterval_s = 1.0'
    rig = Rig(kit=kit_from(text))
    rig.wait(2000.0)
    assert rig.trace is not None
    seen = [e.data for e in rig.trace.of("part_arrived")]
    assert sum(d["good"] for d in seen) / len(seen) == pytest.approx(0.7, abs=0.04)
    assert sum(d["variant"] == "b" for d in seen) / len(seen) == pytest.approx(0.4, abs=0.04)


def test_a_kit_costs_few_events() -> None:
    """What makes the cell cheap: nothing in it is polled."""
    rig = Rig(target=40)
    build_kits(rig, trusting_kit)
    assert rig.trace is not None
    assert rig.trace.count / 40 < 30
