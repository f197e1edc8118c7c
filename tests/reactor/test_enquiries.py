"""A planner that begins is told how the reactor stands, and has an epoch of its own; repeats are answered again."""

from __future__ import annotations

import pytest
from msgspec.structs import replace

from planner_reactor.errors import RefusedError
from planner_reactor.link.codec import LARGEST_STANDING, decode, encode
from planner_reactor.link.messages import Enquiry
from planner_reactor.reactor.journal import Journal
from tests.reactor.disks import TornDisk
from tests.reactor.driving import FIRST, SECOND, Bench


def told(bench: Bench, kind: str) -> list[tuple[str, str, int]]:
    return [(p.subject, p.cause, p.epoch) for p in bench.perceptions() if p.kind == kind]


@pytest.fixture
def bench() -> Bench:
    bench = Bench(journal=Journal(TornDisk()))
    bench.at(0.0, FIRST)
    bench.run(3.0)
    return bench


def test_the_standing_is_the_committed_structure(bench: Bench) -> None:
    standing = bench.reactor.enquire(Enquiry(enquirer=7))
    assert (standing.enquirer, standing.epoch, standing.highest_label) == (7, 1, 3)
    assert standing.versions == {"work": 1, "part": 1}
    assert standing.rests_on == {"work": (), "part": ("A",)}
    assert standing.clauses[0] == "P[0] = STOP :; ASSERT[work]"
    assert decode(encode(standing), largest=LARGEST_STANDING) == standing


def test_each_enquirer_has_an_epoch_of_its_own_also_after_a_crash() -> None:
    disk = TornDisk()
    epochs = []
    for _ in range(3):
        bench = Bench(journal=Journal(disk))
        epochs += [bench.reactor.enquire(Enquiry(enquirer=1)).epoch for _ in range(2)]
        disk.crash(bench.scheduler.random("power"))
    assert epochs == [1, 2, 3, 4, 5, 6]


def test_the_planner_before_has_no_say_any_more(bench: Bench) -> None:
    epoch = bench.reactor.enquire(Enquiry(enquirer=2)).epoch
    bench.perceptions()
    bench.reactor.receive(SECOND)
    bench.reactor.receive(replace(SECOND, epoch=epoch, id=1))
    bench.run(9.0)
    assert told(bench, "adaptation_refused") == [("2", "epoch", 0)]
    assert sorted(bench.reactor.reactions) == [0, 1, 4]
    assert bench.reactor.laws.violations == []


def test_what_the_planner_before_has_under_way_is_taken_back_and_nothing_is_held(bench: Bench) -> None:
    bench.reactor.receive(SECOND)
    bench.run(3.5)
    assert bench.reactor.transactions.under_way
    standing = bench.reactor.enquire(Enquiry(enquirer=2))
    bench.run(3.6)
    assert told(bench, "adaptation_refused") == [("2", "epoch", 0)]
    assert list(bench.reactor.situations.held) == []
    bench.run(9.0)
    assert sorted(standing.clauses) == sorted(bench.reactor.reactions) == [0, 1, 2, 3]
    assert bench.reactor.laws.violations == []


def test_a_higher_epoch_takes_over_also_without_enquiring(bench: Bench) -> None:
    bench.reactor.receive(SECOND)
    bench.run(3.5)
    other = replace(SECOND, epoch=5, definitions="P[9] = ASSUMONITOR[B, 500]", changes=(), kills=(3,), adds=(9,))
    bench.reactor.receive(other)
    bench.run(3.6)
    assert sorted(bench.reactor.reactions) == [0, 1, 2, 9]
    outcomes = {(p.kind, p.epoch) for p in bench.perceptions() if p.kind.startswith("adaptation") and p.subject == "2"}
    assert outcomes == {("adaptation_refused", 0), ("adaptation_applied", 5)}
    assert bench.reactor.journal.state.committed.taken.above == (2,)
    assert bench.reactor.laws.violations == []


def test_a_full_disk_gives_no_epoch(bench: Bench) -> None:
    disk = TornDisk()
    other = Bench(journal=Journal(disk))
    disk.room = 0
    with pytest.raises(RefusedError, match="epoch 1 cannot be made durable"):
        other.reactor.enquire(Enquiry(enquirer=1))
    assert other.reactor.journal.state.committed.epoch == 0


def test_what_was_applied_is_acknowledged_again_and_not_applied_again() -> None:
    disk = TornDisk()
    bench = Bench(journal=Journal(disk))
    bench.at(0.0, FIRST)
    bench.at(1.0, FIRST)
    bench.run(2.0)
    assert told(bench, "adaptation_applied") == [("1", "", 0), ("1", "", 0)]
    again = Bench(journal=Journal(TornDisk(disk.durable)))
    again.at(1.0, FIRST)
    again.run(2.0)
    assert told(again, "adaptation_applied") == [("1", "", 0)]
    assert again.reactor.counts["applied"] == 0
    assert again.reactor.laws.violations == []


def test_another_adaptation_under_an_id_that_was_applied_is_no_repeat(bench: Bench) -> None:
    bench.reactor.receive(replace(SECOND, id=1))
    bench.run(9.0)
    assert told(bench, "adaptation_refused") == [("1", "repeated", 0)]


def test_what_the_planner_does_without_is_known_as_soon_as_it_says_so(bench: Bench) -> None:
    bench.reactor.receive(replace(SECOND, given_up=("A",)))
    assert bench.reactor.enquire(Enquiry(enquirer=1)).given_up == ("A",)
