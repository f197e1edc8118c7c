"""The journal: what must survive a crash, append-only (docs/reactor.md, law 8).

    record  =  A5 · length (4) · number (4) · CRC-32 of length, number and content (4) · content (MessagePack)

Recovery folds the longest prefix of sound records. An adaptation counts from its `Decided(applied)` on, which is
synced after the last drain has ended and before the first KILL: a crash before it leaves the old structure, a crash
after it the new one. Now and then a snapshot takes the place of everything before it, so that recovery does not take
longer as the reactor grows older.

A write that fails leaves nobody knowing what is on the disk: from then on nothing is appended, and the next write
begins the journal anew, as one snapshot. What could not be written meanwhile is counted as `gaps`.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from typing import Literal, TypeAlias
from zlib import crc32

import msgspec
from msgspec.structs import replace

from planner_reactor.errors import DiskError, InputError
from planner_reactor.link.messages import Adaptation
from planner_reactor.reactor.committed import Committed
from planner_reactor.reactor.disks import Disk

HEADER = b"planner-reactor journal 1\n"
MARK = 0xA5
FRAME = 13
"""Bytes before the content of a record."""

LARGEST = 16_000_000
"""Bytes of the largest record that is read."""

_BEGINNING = re.compile(b"\xa5(?=\x00)")
"""How a record begins: the length of none needs its first byte."""

RENEW_AFTER = 256
"""Records after which a snapshot takes their place; more if it is larger: what it costs is shared among them."""

Outcome: TypeAlias = Literal["applied", "refused", "timed_out"]


class Begun(msgspec.Struct, frozen=True, tag="begun"):
    """An adaptation was admitted; nothing of it counts yet."""

    adaptation: Adaptation
    time: float


class Decided(msgspec.Struct, frozen=True, tag="decided"):
    """An adaptation is applied from here on, or came to nothing."""

    id: int
    outcome: Outcome
    time: float
    epoch: int = 0


class Claimed(msgspec.Struct, frozen=True, tag="claimed"):
    """A planner that begins was given this epoch: those before it have no say any more."""

    epoch: int
    time: float


class Assumed(msgspec.Struct, frozen=True, tag="assumed"):
    """An assumption was found to fail, or to hold again."""

    assumption: str
    holds: bool
    time: float


class Halted(msgspec.Struct, frozen=True, tag="halted"):
    """The stop button was pressed (law 15), or released by an explicit reset."""

    halted: bool
    time: float


class Left(msgspec.Struct, frozen=True, tag="left"):
    """A reaction ended by itself: it is of the structure no more."""

    label: int
    time: float


class Started(msgspec.Struct, frozen=True, tag="started"):
    """A reactor began to act on what this journal says: the next incarnation."""

    time: float


class State(msgspec.Struct, frozen=True):
    """What a journal says: the structure, and the adaptations that were begun and not decided."""

    committed: Committed = Committed()
    open: tuple[Adaptation, ...] = ()
    incarnation: int = 0


class Snapshot(msgspec.Struct, frozen=True, tag="snapshot"):
    """What all records before it come to."""

    state: State
    time: float


Record: TypeAlias = Begun | Decided | Claimed | Assumed | Halted | Left | Started | Snapshot

_encode = msgspec.msgpack.Encoder(enc_hook=dict).encode  # persistent mappings are written as plain ones
_decode = msgspec.msgpack.Decoder(Record).decode


class Reading(msgspec.Struct, frozen=True):
    """What the first records of a journal come to: `records` of them, `place` bytes with its header."""

    state: State = State()
    place: int = len(HEADER)
    records: int = 0


NOTHING = Reading()
"""Its header."""


class Recovery(msgspec.Struct, frozen=True):
    """What was found: `lost` bytes at the end are no valid record; `damaged` if valid ones stood behind them.

    A torn end is what a crash leaves, and nothing that was acknowledged. Damage is not: something did not keep what it
    had taken, and people must know.
    """

    state: State
    lost: int = 0
    damaged: bool = False


class Journal:
    """Writes records on one disk. `recover` comes first; `state` is what the records so far come to."""

    def __init__(self, disk: Disk) -> None:
        self._disk = disk
        self.state = State()
        self.records = 0  # since the last snapshot
        self.gaps = 0
        self.trusted = True  # is all that was written known to be there?

    def recover(self) -> Recovery:
        """Read what survived, and cut off what is no record; `InputError` if this is no journal."""
        content = self._disk.read()
        if len(content) < len(HEADER) and HEADER.startswith(content):  # nothing yet, or torn at its very beginning
            self._disk.replace(HEADER)
            return Recovery(self.state, lost=len(content))
        if not content.startswith(HEADER):
            raise InputError(f"this is no journal: it begins with {content[: len(HEADER)]!r}, expected {HEADER!r}")
        found = read(content)
        self.state, self.records = found.state, found.records
        if len(content) > found.place:
            recovery = Recovery(self.state, len(content) - found.place, damaged=any_record(content, found.place))
            if recovery.damaged:
                self._disk.set_aside(content)
            self._disk.replace(content[: found.place])
            return recovery
        return Recovery(self.state)

    def write(self, *records: Record, sync: bool = True) -> None:
        """Make these durable, all or none in effect; `DiskError` if that cannot be done, and then none counts.

        Without `sync` they are durable together with the next record that is synced.
        """
        state, number = self.state, self.records
        for record in records:
            state = after(state, record)
        try:
            if self.trusted and number + len(records) <= max(RENEW_AFTER, len(state.committed.clauses)):
                self._disk.append(b"".join(framed(r, number + n) for n, r in enumerate(records, 1)))
                if sync:
                    self._disk.sync()
                number += len(records)
            else:
                self._disk.replace(HEADER + framed(Snapshot(state, records[-1].time), 1))
                number = 1
        except DiskError:
            self.gaps += len(records)
            self.trusted = False
            raise
        self.state, self.records, self.trusted = state, number, True

    def note(self, record: Record, *, sync: bool = True) -> bool:
        """Write what has happened anyway: if it cannot be made durable it counts all the same, and is a gap."""
        try:
            self.write(record, sync=sync)
        except DiskError:
            self.state = after(self.state, record)
            return False
        return True

    def renew(self, time: float) -> bool:
        """If it is not known what is on the disk, begin anew with what the state is; is it known now?"""
        if not self.trusted:
            try:
                self._disk.replace(HEADER + framed(Snapshot(self.state, time), 1))
            except DiskError:
                return False
            self.records, self.trusted = 1, True
        return True


def framed(record: Record, number: int) -> bytes:
    """A record as bytes; `number` counts the records of its file from 1."""
    content = _encode(record)
    head = len(content).to_bytes(4, "big") + number.to_bytes(4, "big")
    return bytes([MARK]) + head + crc32(head + content).to_bytes(4, "big") + content


def read(content: bytes | bytearray, since: Reading = NOTHING) -> Reading:
    """What all sound records come to, up to the first that is not. What was read before is not read again: `since`."""
    state, place, records = since.state, since.place, since.records
    while (frame := _frame(content, place)) is not None:
        number, body = frame
        if number != records + 1:
            break
        try:
            state = after(state, _decode(body))
        except (msgspec.MsgspecError, RecursionError, UnicodeDecodeError):
            break
        place, records = place + FRAME + len(body), number
    return Reading(state, place, records)


def any_record(content: bytes | bytearray, place: int) -> bool:
    """Is there a sound record anywhere from here on?"""
    return any(_frame(content, found.start()) is not None for found in _BEGINNING.finditer(content, place))


def _frame(content: bytes | bytearray, place: int) -> tuple[int, bytes | bytearray] | None:
    """(number, content) of the record at a place, if there is a whole and sound one."""
    start = place + FRAME
    if start > len(content) or content[place] != MARK:
        return None
    head = content[place + 1 : place + 9]
    length = int.from_bytes(head[:4], "big")
    if length > LARGEST or start + length > len(content):
        return None
    body = content[start : start + length]
    if crc32(body, crc32(head)) != int.from_bytes(content[place + 9 : start], "big"):
        return None
    return int.from_bytes(head[4:], "big"), body


def fold(records: Iterable[Record]) -> State:
    """What these records come to."""
    state = State()
    for record in records:
        state = after(state, record)
    return state


def after(state: State, record: Record) -> State:
    """What a state is after one more record."""
    committed = state.committed
    match record:
        case Snapshot(snapshot):
            return snapshot
        case Begun(adaptation):
            return replace(state, committed=committed.begun(adaptation), open=(*state.open, adaptation))
        case Decided(number, outcome, epoch=epoch):
            decided = committed.decided(number, epoch)
            for adaptation in state.open:
                if (adaptation.id, adaptation.epoch) == (number, epoch) and outcome == "applied":
                    decided = committed.after(adaptation)
            still = tuple(a for a in state.open if (a.id, a.epoch) != (number, epoch))
            return replace(state, committed=decided, open=still)
        case Claimed(epoch):
            return replace(state, committed=committed.claimed(epoch))
        case Assumed(assumption, holds):
            return replace(state, committed=committed.told(assumption, holds=holds))
        case Halted(halted):
            return replace(state, committed=replace(committed, halted=halted))
        case Left(label):
            return replace(state, committed=committed.without(label))
        case Started():
            return replace(state, incarnation=state.incarnation + 1)
