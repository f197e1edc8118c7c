"""The books: every part and every tray is somewhere, once, after every event (law 11 of the reactor's laws).

    parts  arrived = on_belt + held + in_trays + shipped + rejected + passed + taken
    trays  arrived = stack + held + area + shipped + rejected

`Books` enters each move; `World.happened` compares the books with what the containers really hold. A
difference is a `Finding`, typed and kept, never an exception: the run goes on and the laws see it.
"""

from __future__ import annotations

from collections.abc import Mapping

import msgspec

from planner_reactor.trace import Trace
from planner_reactor.workcell.things import Part, Place, Tray, TrayPlace

PART_ACCOUNTS: Mapping[Place, str] = {
    "belt": "on_belt",
    "gripper": "held",
    "tray": "in_trays",
    "shipped": "shipped",
    "rejected": "rejected",
    "passed": "passed",
    "taken": "taken",
}
TRAY_ACCOUNTS: Mapping[TrayPlace, str] = {
    "stack": "stack",
    "gripper": "held",
    "area": "area",
    "shipped": "shipped",
    "rejected": "rejected",
}

COUNTED = (
    "parts on the belt",
    "parts held",
    "parts in trays",
    "trays stacked",
    "trays held",
    "trays in the area",
)
"""What can be counted, in the order of `Books.differences`."""


class Finding(msgspec.Struct, frozen=True):
    """A law of the cell that did not hold: which, when, and what was counted against what was expected."""

    law: str
    time: float
    message: str


class Books:
    """The accounts of parts and trays. `trace` (if any) hears of every entry."""

    __slots__ = ("parts", "parts_arrived", "trace", "trays", "trays_arrived")

    def __init__(self, trace: Trace | None = None) -> None:
        self.trace = trace
        self.parts_arrived = 0
        self.trays_arrived = 0
        self.parts = dict.fromkeys(PART_ACCOUNTS.values(), 0)
        self.trays = dict.fromkeys(TRAY_ACCOUNTS.values(), 0)

    def part_arrived(self, part: Part, place: Place, *, at: str, why: str = "") -> None:
        """A part comes into the cell, at `place` (more exactly `at`)."""
        part.place = place
        self.parts_arrived += 1
        self.parts[PART_ACCOUNTS[place]] += 1
        if self.trace is not None:
            self.trace.record(
                "part_arrived", part=part.number, part_kind=part.kind, variant=part.variant, good=part.good,
                at=at, why=why,
            )  # fmt: skip

    def part_moved(self, part: Part, place: Place, *, source: str, target: str, why: str = "") -> None:
        """A part goes from where it is to `place` (more exactly: from `source` to `target`)."""
        if part.place != "nowhere":
            self.parts[PART_ACCOUNTS[part.place]] -= 1
        part.place = place
        self.parts[PART_ACCOUNTS[place]] += 1
        if self.trace is not None:
            self.trace.record("part_moved_to", part=part.number, source=source, target=target, why=why)

    def tray_arrived(self, tray: Tray) -> None:
        """A tray comes onto the stack."""
        tray.place = "stack"
        self.trays_arrived += 1
        self.trays["stack"] += 1
        if self.trace is not None:
            self.trace.record("tray_arrived", tray=tray.number)

    def tray_moved(self, tray: Tray, place: TrayPlace, *, why: str = "") -> None:
        """A tray goes from where it is to `place`."""
        source = tray.place
        if source != "nowhere":
            self.trays[TRAY_ACCOUNTS[source]] -= 1
        tray.place = place
        self.trays[TRAY_ACCOUNTS[place]] += 1
        if self.trace is not None:
            self.trace.record("tray_moved_to", tray=tray.number, source=source, target=place, why=why)

    def differences(self, counted: tuple[int, int, int, int, int, int]) -> tuple[str, ...]:
        """What the books say otherwise than a count of the containers, and sums that do not come out.

        `counted`: parts on the belt, held, in trays; trays on the stack, held, in the tray area.
        """
        parts, trays = self.parts, self.trays
        booked = (
            parts["on_belt"],
            parts["held"],
            parts["in_trays"],
            trays["stack"],
            trays["held"],
            trays["area"],
        )
        if (
            booked == counted
            and sum(parts.values()) == self.parts_arrived
            and sum(trays.values()) == self.trays_arrived
        ):
            return ()
        wrong = [
            f"{name}: books {books}, counted {count}"
            for name, books, count in zip(COUNTED, booked, counted, strict=True)
            if books != count
        ]
        for what, arrived, accounts in (
            ("parts", self.parts_arrived, parts),
            ("trays", self.trays_arrived, trays),
        ):
            if sum(accounts.values()) != arrived:
                wrong.append(f"{what}: arrived {arrived}, accounted for {sum(accounts.values())}")
        return tuple(wrong)
