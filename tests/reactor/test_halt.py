"""Halt wins: after the stop button nothing acts until an explicit reset (law 15)."""

from __future__ import annotations

from planner_reactor.reactor.journal import Journal
from tests.reactor.disks import TornDisk
from tests.reactor.driving import FIRST, SECOND, Bench


def halted(journal: Journal | None = None, *, at: float = 3.0) -> Bench:
    bench = Bench(journal=journal)
    bench.at(0.0, FIRST)
    bench.scheduler.call_at(at, bench.reactor.halt)
    bench.run(20.0)
    return bench


def test_after_halt_nothing_acts() -> None:
    bench = halted()
    assert bench.times("entered", situation="part")[-1] <= 3.0
    assert bench.reactor.commands() == 0
    assert bench.reactor.situations.instances == {}
    assert bench.reactor.laws.violations == []


def test_the_process_that_ran_is_abandoned_once() -> None:
    bench = halted()
    assert bench.abandoned == ["old"]


def test_an_adaptation_is_refused_and_one_under_way_comes_to_nothing() -> None:
    bench = Bench()
    bench.at(0.0, FIRST)
    bench.at(3.0, SECOND)
    bench.scheduler.call_at(3.5, bench.reactor.halt)
    bench.at(5.0, SECOND)
    bench.run(9.0)
    assert [p.cause for p in bench.perceptions() if p.kind == "adaptation_refused"] == ["halted", "halted"]
    assert sorted(bench.reactor.journal.state.committed.clauses) == [0, 1, 2, 3]
    assert bench.reactor.laws.violations == []


def test_a_reset_brings_back_what_was_committed() -> None:
    bench = halted()
    bench.reactor.reset()
    bench.run(30.0)
    assert sorted(bench.reactor.reactions) == [0, 1, 2, 3]
    assert bench.times("entered", situation="part")[-1] > 25.0
    assert bench.reactor.laws.violations == []


def test_a_crash_does_not_release_the_stop_button() -> None:
    disk = TornDisk()
    halted(Journal(disk))
    again = Bench(journal=Journal(TornDisk(disk.durable)))
    again.run(10.0)
    assert again.times("entered") == []
    again.reactor.reset()
    again.run(20.0)
    assert again.times("entered", situation="part")


def test_what_had_failed_fails_though_the_reactor_begins_halted() -> None:
    disk = TornDisk()
    bench = Bench(journal=Journal(disk))
    bench.at(0.0, FIRST)
    bench.scheduler.call_at(2.5, lambda: bench.flags.update(A=False))
    bench.scheduler.call_at(4.0, bench.reactor.halt)
    bench.run(5.0)
    again = Bench(journal=Journal(TornDisk(disk.durable)))
    assert list(again.reactor.failed) == ["A"]
    again.host.report("A", True, "somebody saw it")  # nobody may ever say it again
    assert again.reactor.failed == {}
    assert [p.subject for p in again.perceptions() if p.kind == "assumption_holds"] == ["A"]
    again.reactor.reset()
    again.run(6.0)
    assert again.times("entered", situation="part")
    assert again.reactor.laws.violations == []


def test_halting_twice_or_resetting_what_runs_changes_nothing() -> None:
    bench = Bench()
    bench.at(0.0, FIRST)
    bench.run(1.0)
    bench.reactor.reset()
    bench.run(5.0)
    assert bench.times("reset") == []
    bench.reactor.halt()
    bench.reactor.halt()
    bench.run(9.0)
    assert len(bench.times("halted")) == 1
