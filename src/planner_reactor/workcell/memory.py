"""The cell's own record: what it has seen, what it holds, what it has done. The sensory model of R §8.3.

The handles that programs pass around ("part17", "tray3") point in here, never to the things themselves: a
handle is given when something is first seen, and what is known of it may be out of date or wrong. Parts in a
new picture are matched to what is remembered by place alone. What has left the cell is forgotten; its handle
is still known to have been given, so that a late process finds its work already done.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

from planner_reactor.workcell.calibration import Calibration
from planner_reactor.workcell.kit import KitSpec
from planner_reactor.workcell.sensors import Follower, Glimpse

FORGET_AFTER = 2
"""Pictures in which a part is missing before it is forgotten."""


@dataclass(slots=True)
class PartRecord:
    """What is remembered of a part: on the belt (at `u`, `y`), in the gripper, or in a tray."""

    handle: str
    kind: str
    u: float
    y: float
    votes: dict[str, int] = field(default_factory=dict)
    missed: int = 0
    state: Literal["belt", "held", "placed"] = "belt"
    tested: bool = False
    claimed_until: float = -1.0
    opportunistic: bool = False
    follower: Follower | None = None

    @property
    def variant(self) -> str:
        """What it looked like most often."""
        return max(self.votes, key=lambda variant: self.votes[variant]) if self.votes else ""


@dataclass(slots=True)
class TrayRecord:
    """What is remembered of a tray: its tag and pose once seen, what was put in, what else is known to be in
    it.
    """

    handle: str
    state: Literal["stack", "held", "area", "left"] = "stack"
    tag: str = ""
    pose: tuple[float, float] = (0.0, 0.0)
    place: int = -1
    contents: dict[str, str] = field(default_factory=dict)  # slot → what we put there, or a process found there
    came_filled: set[str] = field(default_factory=set)  # slots seen filled when it was taken from the stack
    glimpsed: set[str] = field(default_factory=set)  # slots that a monitor saw filled by others
    gone: set[str] = field(default_factory=set)  # slots that a monitor saw vacant though they should be filled
    tested: bool = False

    def blames(self, slot: str) -> str:
        """A slot is filled, and not by us: the assumption that this speaks against."""
        return "AF" if slot in self.came_filled else "ACP"

    def expects(self, slot: str) -> bool:
        """Should something be in the slot, by all that was done and seen?"""
        return slot in self.contents or slot in self.came_filled or slot in self.glimpsed

    def as_expected(self) -> bool:
        """Is nothing but the known contents expected in it, and nothing of them known to be gone?"""
        return not self.gone and self.came_filled <= self.contents.keys() and self.glimpsed <= self.contents.keys()

    def fill(self, slot: str, handle: str) -> None:
        """This part is in the slot."""
        self.contents[slot] = handle
        self.gone.discard(slot)

    def vacate(self, slot: str) -> str:
        """The slot was seen vacant: forget what should be in it; gives the handle of what we had put there,
        or ''.
        """
        for slots in (self.came_filled, self.glimpsed, self.gone):
            slots.discard(slot)
        return self.contents.pop(slot, "")

    def done(self, slot: str) -> bool:
        """Is the slot filled, as far as is known?"""
        return slot in self.contents


class Memory:
    """All that one cell remembers."""

    def __init__(self, kit: KitSpec, calibration: Calibration) -> None:
        self.held = ""
        self.parts: dict[str, PartRecord] = {}
        self.trays: dict[str, TrayRecord] = {}
        self.due = dict.fromkeys(kit.kinds, 0)  # arrivals that were awaited and not yet used (AO relaxed)
        self.last_seen = {variant: 0.0 for part in kit.parts for variant in part.variants}
        self._on_belt: dict[str, list[PartRecord]] = {kind: [] for kind in kit.kinds}
        self._kit = kit
        self._calibration = calibration
        self._length = calibration.belt_speed * kit.dwell_s
        self._parts_given = 0
        self._trays_given = 0

    def see(self, glimpse: Glimpse, now: float) -> PartRecord:
        """A part was seen: the one remembered at that place, or a new one."""
        tolerance = self._calibration.seen_tolerance
        self.last_seen[glimpse.variant] = now
        for record in self._on_belt[glimpse.kind]:
            if abs(record.u - glimpse.u) <= tolerance and abs(record.y - glimpse.y) <= tolerance:
                record.u, record.y, record.missed = glimpse.u, glimpse.y, 0
                break
        else:
            self._parts_given += 1
            record = PartRecord(f"part{self._parts_given}", glimpse.kind, glimpse.u, glimpse.y)
            self.parts[record.handle] = record
            self._on_belt[glimpse.kind].append(record)
        record.votes[glimpse.variant] = record.votes.get(glimpse.variant, 0) + (3 if glimpse.certain else 1)
        return record

    def see_all(self, kind: str, glimpses: list[Glimpse], now: float) -> list[PartRecord]:
        """One picture of all parts of a kind: what was remembered and is missing twice is forgotten."""
        seen = [self.see(glimpse, now) for glimpse in glimpses]
        handles = {record.handle for record in seen}
        for record in list(self._on_belt[kind]):
            if record.handle not in handles:
                record.missed += 1
            if record.missed >= FORGET_AFTER or self.travelled(record, now) > self._length:
                self.forget(record)
        return seen

    def travelled(self, record: PartRecord, when: float) -> float:
        """How far along the belt (m) it will be, as far as is known."""
        return record.u + self._calibration.belt_speed * when

    def rides(self, record: PartRecord, when: float) -> bool:
        """Should it still be on the belt (with a margin at its end)?"""
        return self.travelled(record, when) < self._length - 0.03

    def candidate(self, wanted: str, now: float, lead_s: float) -> PartRecord | None:
        """The remembered part of a kind or variant that will leave first but can still be reached in
        `lead_s`.
        """
        kind = self._kit.kind_of[wanted]
        best: PartRecord | None = None
        for record in self._on_belt[kind]:
            if not self.rides(record, now + lead_s) or (wanted != kind and record.variant != wanted):
                continue
            if best is None or (record.claimed_until < now, record.u) > (best.claimed_until < now, best.u):
                best = record
        return best

    def sees_other(self, kind: str, now: float) -> bool:
        """Is a part of another kind remembered on the belt?"""
        return any(
            self.travelled(record, now) < self._length
            for other, records in self._on_belt.items()
            if other != kind
            for record in records
        )

    def prune(self, kind: str, now: float) -> None:
        """Forget the parts of a kind that have passed the belt's end."""
        for record in [r for r in self._on_belt[kind] if self.travelled(r, now) > self._length]:
            self.forget(record)

    def forget(self, record: PartRecord) -> None:
        """It is no longer where it was, nor anywhere known."""
        self.parts.pop(record.handle, None)
        if record.state == "belt":
            self._on_belt[record.kind].remove(record)
        if self.held == record.handle:
            self.held = ""

    def drop(self, record: PartRecord) -> None:
        """As `forget`, whether or not it is still remembered."""
        if record.handle in self.parts:
            self.forget(record)

    def grip(self, record: PartRecord, kind: str, variant: str) -> None:
        """It is in the gripper, and the palm camera says what it is."""
        self._on_belt[record.kind].remove(record)
        record.kind, record.votes, record.state = kind, {variant: 1}, "held"
        self.held = record.handle

    def new_tray(self) -> TrayRecord:
        """A handle for the topmost tray of the stack."""
        self._trays_given += 1
        tray = TrayRecord(f"tray{self._trays_given}")
        self.trays[tray.handle] = tray
        return tray

    def note(self, tray: TrayRecord, slot: str) -> None:
        """A process found the slot filled, and not by us: what is in it gets a handle."""
        self._parts_given += 1
        record = PartRecord(f"part{self._parts_given}", slot, 0.0, 0.0, state="placed")
        self.parts[record.handle] = record
        tray.fill(slot, record.handle)

    def settled(self, kind: str) -> str:
        """What is already in the slot of this kind of the one tray that stands there, or ''."""
        standing = [tray for tray in self.trays.values() if tray.state == "area"]
        return standing[0].contents.get(kind, "") if len(standing) == 1 else ""

    def tray_taken(self, tray: TrayRecord, tag: str) -> None:
        """It is in the gripper, and the palm camera reads its tag: what was remembered under another handle
        is void.
        """
        for other in [other for other in self.trays.values() if other.tag == tag and other is not tray]:
            del self.trays[other.handle]
        tray.tag, tray.state = tag, "held"
        self.held = tray.handle

    def tray_left(self, tray: TrayRecord) -> None:
        """It left the cell, with all that was in it."""
        tray.state = "left"
        self.trays.pop(tray.handle, None)
        for handle in tray.contents.values():
            self.parts.pop(handle, None)
        if self.held == tray.handle:
            self.held = ""

    def let_go(self) -> None:
        """The gripper is empty: a part that was held is nowhere known, a tray is on the stack again."""
        handle, self.held = self.held, ""
        if handle in self.parts:
            self.forget(self.parts[handle])
        elif handle in self.trays:
            self.trays[handle].state = "stack"

    def was_given(self, handle: str) -> bool:
        """Was this handle ever given?"""
        for prefix, given in (("part", self._parts_given), ("tray", self._trays_given)):
            number = handle.removeprefix(prefix)
            if number != handle and number.isdecimal():
                return 0 < int(number) <= given
        return False
