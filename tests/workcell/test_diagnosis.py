"""Kitting with the monitor of an assumption missing: the planner infers from failed situations that it is false."""

from __future__ import annotations

from typing import Any

import pytest

from planner_reactor.experiments.loop import Loop
from planner_reactor.logic.reader import read_domain
from planner_reactor.planner import Planner
from planner_reactor.runtime import Host, Scheduler
from planner_reactor.trace import Trace
from planner_reactor.workcell.domains import shipped_domain
from planner_reactor.workcell.evidence import ASSUMPTIONS
from planner_reactor.workcell.host import host as kitting

DOMAIN = read_domain(shipped_domain(), file="kitting.itl")
FAULTS: dict[str, tuple[str, dict[str, Any]]] = {
    "ADT": ("tray_moved", {}),
    "ADD": ("downstream_blocked", {}),
    "AO": ("starved_kind", {"part": "motor", "duration_s": 400.0}),
    "AF": ("filled_tray", {}),
    "ACP": ("part_added_to_tray", {}),
}
"""What breaks each assumption so that situations fail. (Bad parts, wrong variants and missing parts make no process
fail: without a sensor nothing shows them, and nothing is diagnosed.)"""


def run(missing: tuple[str, ...], fault: str | None, seed: int, *, patience: int | None = None) -> Planner:
    """Ten minutes of a cell where nobody senses some assumptions, and one of them fails from 120 s on."""

    def blinded(scheduler: Scheduler, trace: Trace) -> Host:
        host = kitting(scheduler, trace=trace)
        for assumption in missing:
            del host.assumptions[assumption]
        told = host.report

        def report(assumption: str, holds: bool, evidence: str = "") -> None:
            if assumption in host.assumptions:
                told(assumption, holds, evidence)

        host.report = report  # type: ignore[method-assign]
        return host

    loop = Loop(Planner(DOMAIN, relax=(), patience=patience), blinded, seed=seed, keep_trace=False)

    def strike() -> None:
        kind, parameters = FAULTS[fault or ""]
        assert loop.host.world is not None
        if not loop.host.world.strike(kind, **parameters):
            loop.scheduler.call_after(1.0, strike)

    for time in range(120, 420, 50) if fault else ():
        loop.scheduler.call_at(time, strike)
    loop.run(until=600.0)
    assert loop.reactor.laws.violations == []
    return loop.planner


@pytest.mark.parametrize("seed", [1, 2])
@pytest.mark.parametrize("assumption", FAULTS)
def test_the_one_that_nobody_senses_is_named(assumption: str, seed: int) -> None:
    best = run((assumption,), assumption, seed).diagnoses[0]
    assert best.assumptions == (assumption,)
    assert best.confidence > 0.5


@pytest.mark.parametrize("assumption", ASSUMPTIONS)
def test_an_undisturbed_cell_gives_nothing_to_diagnose_whatever_is_not_sensed(assumption: str) -> None:
    assert run((assumption,), None, 1).diagnoses == ()


def test_without_any_monitor_only_what_the_linkage_tells_apart_is_told_apart() -> None:
    assert run(ASSUMPTIONS, "ADD", 1).diagnoses[0].assumptions == ("ADD",)  # FinishTray alone rests on it
    first, second, *_ = run(ASSUMPTIONS, "ACP", 1).diagnoses
    assert {first.assumptions, second.assumptions} == {("AF",), ("ACP",)}  # the same situations rest on both
    assert first.confidence < 0.6


def test_with_patience_the_planner_acts_on_it() -> None:
    planner = run(("ADT",), "ADT", 1, patience=4)
    assert planner.relaxed == {"ADT": "forced"}


def test_all_is_sensed_is_told_in_the_usual_way() -> None:
    assert run((), "ADT", 1).relaxed == {"ADT": "forced"}
