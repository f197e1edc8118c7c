"""After a crash a reactor stands on its last committed structure: wholly the old one or wholly the new one (law 8)."""

from __future__ import annotations

import pytest
from msgspec.structs import replace

from planner_reactor.errors import InputError
from planner_reactor.reactor.doubts import Doubts
from planner_reactor.reactor.journal import Journal
from planner_reactor.runtime import Host
from tests.reactor.disks import TornDisk
from tests.reactor.driving import FIRST, SECOND, Bench


def survivor(disk: TornDisk) -> Bench:
    """The reactor that is started on what this disk holds."""
    return Bench(journal=Journal(TornDisk(disk.durable)))


def test_what_was_applied_is_there_again_and_acts() -> None:
    disk = TornDisk()
    bench = Bench(journal=Journal(disk))
    bench.at(0.0, FIRST)
    bench.at(3.0, SECOND)
    bench.run(10.0)
    again = survivor(disk)
    again.run(10.0)
    assert again.reactor.text() == bench.reactor.text()
    assert again.reactor.versions == bench.reactor.versions
    assert again.times("entered", situation="part")
    assert again.reactor.laws.violations == []
    assert again.perceptions()[0].kind == "restarted"


@pytest.mark.parametrize("moment", [0.0, 2.9, 3.0, 3.5, 3.9999, 4.0, 5.0])
def test_a_crash_at_any_moment_leaves_the_old_structure_or_the_new(moment: float) -> None:
    disk = TornDisk()
    bench = Bench(journal=Journal(disk))
    bench.at(0.0, FIRST)
    bench.at(3.0, SECOND)
    bench.run(moment)
    again = survivor(disk)
    again.run(10.0)
    assert sorted(again.reactor.reactions) == ([0, 1, 4] if moment >= 4.0 else [0, 1, 2, 3])
    assert list(again.reactor.situations.held) == []
    assert again.reactor.laws.violations == []


def test_a_crash_at_every_byte_that_was_written_leaves_a_committed_structure() -> None:
    disk = TornDisk()
    bench = Bench(journal=Journal(disk))
    bench.at(0.0, FIRST)
    bench.at(3.0, SECOND)
    bench.run(10.0)
    seen = set()
    for cut in range(26, len(disk.durable) + 1):
        journal = Journal(TornDisk(disk.durable[:cut]))
        journal.recover()
        seen.add(tuple(sorted(journal.state.committed.clauses)))
    assert seen == {(), (0, 1, 2, 3), (0, 1, 4)}


def test_what_was_under_way_came_to_nothing_and_the_planner_is_told() -> None:
    disk = TornDisk()
    bench = Bench(journal=Journal(disk))
    bench.at(0.0, FIRST)
    bench.at(3.0, SECOND)
    bench.run(3.5)
    disk.sync()  # so that the beginning of the second is there as well
    again = survivor(disk)
    told = [(p.kind, p.subject, p.cause) for p in again.perceptions()]
    assert told == [("adaptation_refused", "2", "restarted"), ("restarted", "sound", "")]
    assert again.reactor.journal.state.open == ()


def test_an_id_that_was_taken_before_the_crash_is_not_taken_again() -> None:
    disk = TornDisk()
    bench = Bench(journal=Journal(disk))
    bench.at(0.0, FIRST)
    bench.run(1.0)
    again = survivor(disk)
    again.at(1.0, replace(SECOND, id=1))
    again.run(2.0)
    assert [p.cause for p in again.perceptions() if p.kind == "adaptation_refused"] == ["repeated"]


def test_an_assumption_that_had_failed_fails_until_it_is_sensed_to_hold() -> None:
    disk = TornDisk()
    bench = Bench(journal=Journal(disk))
    bench.at(0.0, FIRST)
    bench.scheduler.call_at(2.5, lambda: bench.flags.update(A=False))
    bench.run(4.0)
    again = survivor(disk)
    assert list(again.reactor.failed) == ["A"]
    again.run(3.0)
    assert again.times("entered", situation="part") == []
    again.reactor.assumption_sensed("A", True)
    again.run(6.0)
    assert again.times("entered", situation="part")
    assert again.reactor.laws.violations == []


def test_a_failure_that_only_a_process_noticed_is_told_by_the_next_incarnation_too() -> None:
    """What was told of it may have gone with the process; it is told until nothing rests on it."""
    disk = TornDisk()
    bench = Bench(journal=Journal(disk))
    bench.at(0.0, FIRST)
    bench.scheduler.call_at(3.0, lambda: bench.host.report("A", False, "it slipped"))
    bench.run(3.5)
    again = survivor(disk)
    again.at(6.5, SECOND)
    again.run(20.0)
    assert again.times("assumption_failure", assumption="A") == [2.0, 4.0, 6.0]


def test_a_return_that_may_have_been_told_to_nobody_is_told_once_more() -> None:
    disk = TornDisk()
    bench = Bench(journal=Journal(disk))
    hold = replace(FIRST, definitions=FIRST.definitions + "P[9] = HOLDMONITOR[A, 1000]", adds=(*FIRST.adds, 9))
    bench.at(0.0, hold)
    bench.scheduler.call_at(4.2, lambda: bench.flags.update(A=False))
    bench.scheduler.call_at(8.2, lambda: bench.flags.update(A=True))
    bench.run(9.5)
    assert bench.times("assumption_holds") == [9.0]
    again = survivor(disk)
    again.run(10.0)
    assert again.times("assumption_holds", assumption="A") == [1.0]


def test_a_full_disk_stops_adaptations_and_nothing_else() -> None:
    disk = TornDisk()
    bench = Bench(journal=Journal(disk))
    bench.at(0.0, FIRST)
    bench.run(3.0)
    disk.room = 0
    bench.reactor.receive(SECOND)
    bench.run(9.0)
    assert len(bench.times("entered", situation="part")) > 3
    assert bench.reactor.journal.gaps == 2  # that it began, and that it came to nothing
    told = [(p.kind, p.subject, p.cause) for p in bench.perceptions() if p.kind != "adaptation_applied"]
    assert told == [("error", "journal", "the disk takes nothing")]  # at once: a crash would forget that it was refused
    disk.room = 10**9
    bench.run(11.0)
    assert [(p.kind, p.cause) for p in bench.perceptions()] == [("adaptation_refused", "disk")]
    assert bench.reactor.laws.violations == []


def test_a_disk_that_fills_during_the_drain_takes_the_adaptation_back() -> None:
    disk = TornDisk()
    bench = Bench(journal=Journal(disk))
    bench.at(0.0, FIRST)
    bench.at(3.0, SECOND)
    bench.scheduler.call_at(3.5, lambda: setattr(disk, "room", 0))
    bench.scheduler.call_at(6.0, lambda: setattr(disk, "room", 10**9))
    bench.run(3.0)
    before = bench.reactor.text()
    bench.run(5.9)
    assert bench.reactor.text() == before
    assert not [p for p in bench.perceptions() if p.kind == "adaptation_refused"]  # nobody knows what the disk holds
    bench.run(9.0)
    assert bench.reactor.text() == before
    assert [p.cause for p in bench.perceptions() if p.kind == "adaptation_refused"] == ["disk"]
    assert list(bench.reactor.situations.held) == []
    assert bench.times("entered", situation="part")[-1] > 6.0
    assert bench.reactor.laws.violations == []


def recovered(content: bytes) -> tuple[int, ...]:
    """The labels that a reactor would run that is started on this."""
    journal = Journal(TornDisk(content))
    journal.recover()
    return tuple(sorted(journal.state.committed.clauses))


@pytest.mark.parametrize("hasty", [False, True])
def test_a_refusal_is_told_once_no_crash_can_bring_the_adaptation_back(
    hasty: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    if hasty:  # the defect that this is there for
        monkeypatch.setattr(Doubts, "settle", lambda self, told, *, doubtful: told())
    disk = TornDisk()
    bench = Bench(journal=Journal(disk))
    bench.at(0.0, FIRST)
    bench.at(3.0, SECOND)
    bench.scheduler.call_at(3.5, lambda: setattr(disk, "sync_fails", True))
    bench.scheduler.call_at(6.0, lambda: setattr(disk, "sync_fails", False))
    bench.run(5.0)
    assert recovered(disk.read()) == (0, 1, 4)  # appended, not synced: a crash may bring it back, or not
    assert recovered(disk.durable) == (0, 1, 2, 3)
    refused = [p for p in bench.perceptions() if p.kind == "adaptation_refused"]
    assert bool(refused) == hasty
    bench.run(9.0)
    assert hasty or [p.cause for p in bench.perceptions() if p.kind == "adaptation_refused"] == ["disk"]
    assert hasty or recovered(disk.read()) == (0, 1, 2, 3)


def test_a_journal_of_another_host_is_not_run() -> None:
    disk = TornDisk()
    bench = Bench(journal=Journal(disk))
    bench.at(0.0, FIRST)
    bench.run(1.0)
    with pytest.raises(InputError, match=r"another host.*Do"):
        Bench(journal=Journal(TornDisk(disk.durable)), host=Host("other"))


def test_each_start_is_another_incarnation() -> None:
    disk = TornDisk()
    for count in (1, 2, 3):
        assert Bench(journal=Journal(disk)).reactor.journal.state.incarnation == count


def test_a_reaction_that_ended_by_itself_does_not_come_back() -> None:
    disk = TornDisk()
    bench = Bench(journal=Journal(disk))
    once = "P[0] = Do[asked, 1] : REPORT[answer, 42]\n" + FIRST.definitions.replace("P[0]", "P[9]")
    bench.at(0.0, replace(FIRST, definitions=once, adds=(3, 2, 1, 9, 0)))
    bench.run(5.0)
    assert bench.reactor.laws.violations == []
    assert len([p for p in bench.perceptions() if p.kind == "information"]) == 1
    again = survivor(disk)
    again.run(5.0)
    assert not [p for p in again.perceptions() if p.kind == "information"]
    assert again.reactor.laws.violations == []
