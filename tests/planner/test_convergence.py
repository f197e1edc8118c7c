"""The planner gets nearer to its end with every adaptation: (9), (10), (11) of R §6.2, watched while it runs."""

from __future__ import annotations

import itertools
import random
from pathlib import Path

import pytest

from planner_reactor.planner import Planner
from planner_reactor.planner.convergence import Convergence
from tests.planner.driving import GREENHOUSE, KITTING, PAPERS, TRIED, applied, kitting, perception, reinstatable, settle

DOMAINS = (KITTING, TRIED, PAPERS, GREENHOUSE)


@pytest.mark.parametrize("path", DOMAINS, ids=lambda path: path.stem)
def test_what_is_lacking_goes_down_with_every_adaptation_and_comes_to_nothing(path: Path) -> None:
    """(11), for each set of assumptions on the way from all of them to none."""
    planner = Planner(kitting(path), verify=False)
    before, assumed = planner.lacking, planner.relaxed.keys() | set()
    while (step := planner.step()) is not None:
        for adaptation in step.adaptations:
            planner.perceive(applied(adaptation))
            if planner.relaxed.keys() == assumed and step.kind == "refine":
                assert planner.lacking < before
        before, assumed = planner.lacking, planner.relaxed.keys() | set()
    assert not any(planner.lacking)
    assert planner.breaches == ()


@pytest.mark.parametrize("path", DOMAINS, ids=lambda path: path.stem)
def test_every_relaxation_leaves_less_that_is_unlikely(path: Path) -> None:
    """(9): l(ω) goes down with each, and is never below nothing."""
    planner = Planner(kitting(path), verify=False)
    levels = [planner.unlikelihood]
    while (step := planner.step()) is not None:
        if step.kind == "relax":
            levels.append(planner.unlikelihood)
        for adaptation in step.adaptations:
            planner.perceive(applied(adaptation))
    assert len(levels) > 3
    assert all(later < earlier for earlier, later in itertools.pairwise(levels))
    assert levels[-1] >= 0


@pytest.mark.parametrize("seed", range(15))
def test_no_failures_in_any_order_lead_it_astray(seed: int) -> None:
    rng = random.Random(seed)
    domain = kitting(rng.choice(DOMAINS))
    planner = Planner(domain, verify=False)
    for _ in range(400):
        step = planner.step()
        for adaptation in step.adaptations if step else ():
            planner.perceive(applied(adaptation))
        if rng.random() < 0.03:
            planner.perceive(perception("assumption_failure", rng.choice(list(domain.assumptions))))
        if step is None:
            break
    assert planner.breaches == ()


@pytest.mark.parametrize("path", [KITTING, GREENHOUSE], ids=lambda path: path.stem)
def test_nor_do_assumptions_that_return(path: Path) -> None:
    """What has lost a caller is planned again: without ACT, FinishTray asserts FillTray, and with it no more."""
    domain = reinstatable(path)
    planner = Planner(domain, relax=(), verify=False)
    settle(planner)
    for name in domain.assumptions:
        for kind in ("assumption_failure", "assumption_holds"):
            planner.perceive(perception(kind, name))  # type: ignore[arg-type]
            before = planner.lacking
            while (step := planner.step()) is not None:
                for adaptation in step.adaptations:
                    planner.perceive(applied(adaptation))
                    assert step.kind != "refine" or planner.lacking < before
                before = planner.lacking
    assert len(planner.relaxations) == 2 * len(domain.assumptions)
    assert planner.breaches == ()


def test_a_reduction_that_opens_what_stands_above_it_would_be_seen() -> None:
    planner = Planner(kitting(), relax="none", verify=False)
    settle(planner)
    upper, lower = planner.model.named("FillTray"), planner.model.named("LacksMotor")
    assert upper is not None
    assert lower is not None
    watch = Convergence()
    watch.reduced(upper, (lower,))
    assert watch.breaches == []
    watch.reduced(lower, (upper,))
    assert watch.breaches == ["(11): LacksMotor was closed, and FillTray, not below it, was opened"]


def test_a_relaxation_that_leaves_more_would_be_seen() -> None:
    watch = Convergence()
    watch.relaxed("AQ", 2.0, 1.5)
    assert watch.breaches == []
    watch.relaxed("AQ", 2.0, 2.5)
    assert watch.breaches == ["(9): without AQ l is 2.5, it was 2"]
