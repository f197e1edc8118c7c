"""The journal: what was acknowledged survives, what was torn is not read, and what is damaged is said."""

from __future__ import annotations

from collections import Counter
from pathlib import Path
from random import Random

import pytest

from planner_reactor.errors import DiskError, InputError
from planner_reactor.reactor import journal as journals
from planner_reactor.reactor.committed import Committed, Taken
from planner_reactor.reactor.disks import FileDisk
from planner_reactor.reactor.journal import (
    HEADER,
    Assumed,
    Begun,
    Decided,
    Halted,
    Journal,
    State,
    after,
    framed,
)
from tests.reactor.damage import as_a_journal_writes, damaged, in_one_file
from tests.reactor.disks import TornDisk
from tests.reactor.journals import adaptation, fold, history, written


def test_what_was_written_is_recovered(tmp_path: Path) -> None:
    path = tmp_path / "reactor.journal"
    journal = Journal(FileDisk(path))
    journal.recover()
    for record in history(20):
        journal.write(record)
    again = Journal(FileDisk(path))
    recovery = again.recover()
    assert (recovery.state, recovery.lost) == (journal.state, 0)
    assert again.state.committed.clauses[20] == "P[20] = SIT[S0]<k> :; SUCCEED[S0, k]"


def test_an_adaptation_counts_only_once_it_is_decided() -> None:
    begun = fold([Begun(adaptation(1), 0.0)])
    assert begun.committed == Committed(highest_label=1)
    assert [a.id for a in begun.open] == [1]
    assert after(begun, Decided(1, "applied", 1.0)).committed.versions == {"S1": 1}
    refused = after(begun, Decided(1, "refused", 1.0))
    assert refused.committed == Committed(taken=Taken(1), highest_label=1)
    assert not refused.open


@pytest.mark.parametrize("renewed", [False, True])
def test_cut_at_any_byte_or_with_any_bit_flipped_it_is_what_was_written_before(
    renewed: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A thousand adaptations: `python -m tests.reactor.damage`."""
    monkeypatch.setattr(journals, "RENEW_AFTER", 8)
    files = as_a_journal_writes(8) if renewed else [in_one_file(8)]
    assert len(files) == (3 if renewed else 1)
    for file in files:
        found = list(damaged(file, wholly=0.02))
        assert [problem for _, problem in found if problem] == []
        counts = Counter(kind for kind, _ in found)
        assert counts["cut"] == len(file.content) - len(HEADER)
        assert counts["flip"] == 8 * counts["cut"]


def test_a_reader_that_does_not_ask_for_check_sums_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(journals, "crc32", lambda content, start=0: 0)
    assert any(problem for _, problem in damaged(in_one_file(2), wholly=0.0))


def test_a_run_of_bytes_that_could_begin_a_record_is_passed_over(monkeypatch: pytest.MonkeyPatch) -> None:
    looked_at = []
    frame = journals._frame
    monkeypatch.setattr(journals, "_frame", lambda content, place: looked_at.append(place) or frame(content, place))
    torn = HEADER + b"\xa5" * 100_000
    assert Journal(TornDisk(torn)).recover() == journals.Recovery(State(), lost=100_000)
    assert len(looked_at) < 10


def test_damage_before_sound_records_is_told_from_a_torn_end_and_kept_aside() -> None:
    content = bytearray(written(history(6)))
    torn = TornDisk(bytes(content[:-3]))
    recovery = Journal(torn).recover()
    assert (recovery.damaged, recovery.lost > 0, torn.aside) == (False, True, [])
    content[60] ^= 1
    damaged = TornDisk(bytes(content))
    assert Journal(damaged).recover().damaged
    assert damaged.aside == [bytes(content)]
    assert damaged.durable == HEADER


def test_what_is_no_journal_is_not_overwritten() -> None:
    disk = TornDisk(b"P[1] = SIT[s] :; STOP\n" * 3)
    with pytest.raises(InputError, match="no journal"):
        Journal(disk).recover()
    assert disk.durable.startswith(b"P[1]")


def test_a_journal_torn_in_its_header_begins_anew() -> None:
    disk = TornDisk(HEADER[:7])
    assert Journal(disk).recover().lost == 7
    assert disk.durable == HEADER


def test_a_write_is_durable_when_it_returns() -> None:
    for seed in range(50):
        disk, random = TornDisk(), Random(seed)
        journal = Journal(disk)
        journal.recover()
        for record in history(9)[: random.randint(1, 18)]:
            journal.write(record)
        acknowledged = journal.state
        disk.append(framed(Halted(True, 0.0), 99))  # under way when the power goes
        disk.crash(random)
        assert Journal(disk).recover().state in (acknowledged, after(acknowledged, Halted(True, 0.0)))


def test_several_records_are_one_write() -> None:
    disk = TornDisk()
    journal = Journal(disk)
    journal.recover()
    journal.write(Begun(adaptation(1), 0.0), Decided(1, "applied", 0.0))
    assert disk.syncs == 1
    assert journal.state.committed.highest_label == 1


def test_snapshots_keep_a_journal_short_and_say_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(journals, "RENEW_AFTER", 8)
    disk = TornDisk()
    journal = Journal(disk)
    journal.recover()
    longest = 0
    for record in history(100):
        journal.write(record)
        longest = max(longest, journal.records)
        assert journal.records <= max(8, len(journal.state.committed.clauses))
        assert Journal(TornDisk(disk.durable)).recover().state == journal.state
    assert 8 <= longest < len(list(history(100))) / 2
    assert journal.state == fold(history(100))


@pytest.mark.parametrize("fault", ["full", "sync"])
def test_what_cannot_be_made_durable_does_not_count_and_is_a_gap(fault: str) -> None:
    disk = TornDisk()
    journal = Journal(disk)
    journal.recover()
    journal.write(Begun(adaptation(1), 0.0))
    kept = journal.state
    disk.room, disk.sync_fails = (len(disk.durable) + 9, False) if fault == "full" else (10**9, True)
    with pytest.raises(DiskError):
        journal.write(Decided(1, "applied", 1.0))
    assert (journal.state, journal.gaps) == (kept, 1)
    disk.room, disk.sync_fails = 10**9, False
    journal.write(Decided(1, "applied", 2.0))  # begun anew: nothing is appended to what may be torn
    disk.crash(Random(1))
    assert Journal(disk).recover() == journals.Recovery(journal.state)
    assert journal.state.committed.versions == {"S1": 1}


def test_what_has_happened_anyway_counts_though_it_could_not_be_written() -> None:
    disk = TornDisk()
    journal = Journal(disk)
    journal.recover()
    disk.room = 0
    assert not journal.note(Assumed("A1", False, 1.0))
    assert journal.state.committed.failed == ("A1",)
    disk.room = 10**9
    journal.write(Halted(True, 2.0))
    assert Journal(disk).recover().state.committed.failed == ("A1",)


def test_ids_are_kept_in_little_space() -> None:
    taken = Taken()
    for number in Random(3).sample(range(1, 1001), 1000):
        taken = taken.with_(number)
    assert taken == Taken(1000)
    assert 1000 in taken
    assert 1001 not in taken


def test_a_new_epoch_counts_anew_and_shuts_out_the_old() -> None:
    state = fold([*history(3), Begun(adaptation(1, epoch=2), 9.0)])
    assert (state.committed.epoch, state.committed.taken) == (2, Taken())


def test_an_older_epoch_never_takes_the_place_of_a_newer_one() -> None:
    state = fold([Begun(adaptation(1, epoch=2), 0.0), Begun(adaptation(2, epoch=1), 1.0)])
    assert state.committed.epoch == 2


def test_the_state_of_a_fold_is_a_value() -> None:
    assert fold(history(5)) == fold(history(5))
    assert fold([]) == State()


def test_a_file_that_cannot_be_written_says_so(tmp_path: Path) -> None:
    disk = FileDisk(tmp_path / "nowhere" / "reactor.journal")
    with pytest.raises(DiskError, match=r"reactor\.journal: No such file"):
        disk.append(b"x")
    assert disk.read() == b""


def test_damaged_files_are_kept_beside_each_other(tmp_path: Path) -> None:
    disk = FileDisk(tmp_path / "j")
    disk.set_aside(b"one")
    disk.set_aside(b"two")
    assert sorted(p.read_bytes() for p in tmp_path.iterdir()) == [b"one", b"two"]
