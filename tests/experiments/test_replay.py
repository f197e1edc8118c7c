"""Law 16: the same seed and inputs give the same trace; a world that is not like that is seen."""

from __future__ import annotations

import time

from planner_reactor.experiments.loop import Loop
from planner_reactor.experiments.replay import check_replay
from planner_reactor.experiments.runs import the_domain
from planner_reactor.planner import Planner
from planner_reactor.runtime import Host, Scheduler
from planner_reactor.trace import Trace
from planner_reactor.workcell.host import host


def made(*, leaks: bool) -> Loop:
    def world(scheduler: Scheduler, trace: Trace) -> Host:
        if leaks:  # seeded defect: something reads the wall clock
            scheduler.call_after(5.0, lambda: trace.record("leak", at=time.perf_counter_ns()))
        return host(scheduler, target=1, trace=trace)

    return Loop(Planner(the_domain()), world, seed=3)


def laws_broken(*, leaks: bool) -> set[int]:
    first = made(leaks=leaks)
    first.run(until=100.0)
    check_replay(first, made(leaks=leaks), until=100.0)
    return {violation.law for violation in first.reactor.laws.violations}


def test_a_run_is_replayed_and_agrees() -> None:
    assert laws_broken(leaks=False) == set()


def test_a_run_that_depends_on_the_wall_clock_is_seen() -> None:
    assert laws_broken(leaks=True) == {16}
