"""Every byte of a journal cut at, every bit of it flipped: what is recovered is what was written before (row 3).

A record is read from its own bytes and its number alone, so what stands before the damage is read once for all of its
bytes (`Reading`), and each case goes on from there. That this reads as a whole recovery does is asked of a case in each
record, by `Journal.recover` on a disk.

    python -m tests.reactor.damage [ADAPTATIONS]      # 1,000: a few minutes; ends with 1 if anything was wrong
"""

from __future__ import annotations

import sys
import time
from collections import Counter
from collections.abc import Iterator
from itertools import pairwise
from random import Random

import msgspec
from msgspec.structs import replace

from planner_reactor.errors import InputError
from planner_reactor.reactor.journal import (
    FRAME,
    HEADER,
    Journal,
    Reading,
    Recovery,
    State,
    after,
    any_record,
    read,
)
from planner_reactor.simulation.disks import SimulatedDisk
from tests.reactor.journals import history, written


class File(msgspec.Struct):
    """A file, and what had been written once it held so many records, the first state with none."""

    content: bytes
    states: list[State]


class Kept(SimulatedDisk):
    """A disk that keeps every file that another was put in the place of."""

    def __init__(self) -> None:
        super().__init__()
        self.files: list[bytes] = []

    def replace(self, content: bytes) -> None:
        self.files.append(self.read())
        super().replace(content)


def in_one_file(many: int) -> File:
    """So many adaptations without a snapshot."""
    records, states = history(many), [State()]
    for record in records:
        states.append(plain(after(states[-1], record)))
    return File(written(records), states)


def as_a_journal_writes(many: int) -> list[File]:
    """The files, one in the place of the other, that a journal of so many adaptations is; each begins with a snapshot.
    """
    disk, states = Kept(), [[State()]]
    journal = Journal(disk)
    journal.recover()
    disk.files.clear()
    for record in history(many):
        journal.write(record)
        if journal.records == 1 and len(states[-1]) > 1:
            states.append([State()])
        states[-1].append(plain(journal.state))
    return [File(*pair) for pair in zip([*disk.files, disk.read()], states, strict=True)]


def plain(state: State) -> State:
    """The same with plain mappings, which cost nothing to compare however old they are."""
    known = state.committed
    mappings = {"clauses": dict(known.clauses), "versions": dict(known.versions), "rests_on": dict(known.rests_on)}
    return replace(state, committed=replace(known, **mappings))

def damaged(file: File, *, wholly: float) -> Iterator[tuple[str, str]]:
    """Each case by its kind, and what is wrong with it, "" if nothing; a share, `wholly`, is recovered on a disk too.
    """
    draw = Random(1)
    readings = _readings(file)
    for reading, state in zip(readings, file.states, strict=True):
        yield "read", "" if reading.state == state else f"{reading.records} records are read otherwise than written"
    for cases in (_in_header(file.content), _cuts(file.content, readings), _flips(file.content, readings)):
        for kind, content, reading, damage in cases:
            problem = _wrong(content, reading, damage) if kind != "header" else ""
            if not problem and (kind == "header" or draw.random() < wholly):
                problem = _wholly_wrong(bytes(content), reading, damage)
            yield kind, problem and f"{kind}, after {reading.records} records: {problem}"


Case = tuple[str, bytearray, Reading, bool]
"""Its kind; the content; what must be read of it; is it more than a torn end?"""


def _readings(file: File) -> list[Reading]:
    """What so many records are read as, each from the one before."""
    found = [Reading()]
    while (place := found[-1].place) < len(file.content):
        end = place + FRAME + int.from_bytes(file.content[place + 1 : place + 5], "big")
        reading = read(file.content[:end], found[-1])
        assert reading.place == end, f"record {reading.records + 1} is not read"
        found.append(replace(reading, state=plain(reading.state)))
    return found


def _in_header(whole: bytes) -> Iterator[Case]:
    """Torn in its first bytes it begins anew; with a wrong one it is no journal."""
    for place in range(len(HEADER)):
        yield "header", bytearray(whole[:place]), Reading(place=0), False
        for bit in range(8):
            content = bytearray(whole)
            content[place] ^= 1 << bit
            yield "header", content, Reading(place=0), True


def _cuts(whole: bytes, readings: list[Reading]) -> Iterator[Case]:
    content = bytearray(whole)
    for reading in reversed(readings[:-1]):
        while len(content) > reading.place:
            del content[-1:]
            yield "cut", content, reading, False


def _flips(whole: bytes, readings: list[Reading]) -> Iterator[Case]:
    content = bytearray(whole)
    for reading, following in pairwise(readings):
        for place in range(reading.place, following.place):
            for bit in range(8):
                content[place] ^= 1 << bit
                yield "flip", content, reading, following.place < len(content)
                content[place] ^= 1 << bit


def _wrong(content: bytearray, wanted: Reading, damage: bool) -> str:
    """Read on from what stands before the damage."""
    found = read(content, wanted)
    if (found.place, found.records) != (wanted.place, wanted.records) or found.state != wanted.state:
        return f"read as {found.records} records, {found.place} bytes"
    return "" if any_record(content, found.place) is damage else f"damage is not {damage}"


def _wholly_wrong(content: bytes, wanted: Reading, damage: bool) -> str:
    """Recovered by a journal on a disk."""
    disk = SimulatedDisk(content)
    journal = Journal(disk)
    try:
        recovery = journal.recover()
    except InputError:
        return "" if damage and not wanted.place and disk.read() == content else "taken for no journal"
    lost = len(content) - wanted.place
    kept = content[: wanted.place] or HEADER
    if recovery != Recovery(wanted.state, lost, damage) or disk.read() != kept:
        return f"recovered with {recovery.lost} bytes lost, expected {lost}"
    return "" if disk.aside == ([content] if damage else []) else "not kept aside"


def main() -> None:
    many = int(sys.argv[1]) if len(sys.argv) > 1 else 1_000
    began, counts, wrong = time.process_time(), Counter[str](), 0
    files = [(in_one_file(many), 0.000_01), *((file, 0.000_2) for file in as_a_journal_writes(many))]
    for file, wholly in files:
        for kind, problem in damaged(file, wholly=wholly):
            counts[kind] += 1
            if problem:
                wrong += 1
                print(problem, flush=True)
    size = sum(len(file.content) for file, _ in files)
    print(f"{many:,} adaptations, {len(files)} files, {size:,} bytes; {dict(counts)}; {wrong} wrong recoveries;"
          f" {time.process_time() - began:.0f} s of CPU time")  # fmt: skip
    raise SystemExit(wrong > 0)


if __name__ == "__main__":
    main()
