"""An auditor: recomputes the ledgers of a run from its trace alone, event by event.

It shares no code with the books that it checks. It follows every part and every tray by the events
`part_arrived`, `part_moved_to`, `tray_arrived`, `tray_moved_to`, and says what cannot be: a thing that leaves
from where it is not, that comes back from a final place, that arrives twice, or two parts in one slot or in
the gripper.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field

from planner_reactor.trace import Event

FINAL = ("shipped", "rejected", "passed", "taken")
_ACCOUNT = {"belt": "on_belt", "gripper": "held"}


@dataclass(slots=True)
class Audit:
    """What a trace says: where every part and tray is in the end, and what does not fit (`mistakes`)."""

    parts: dict[int, str] = field(default_factory=dict)
    trays: dict[int, str] = field(default_factory=dict)
    mistakes: list[str] = field(default_factory=list)
    events: int = 0
    accepted: int = 0
    rejected: int = 0
    _occupied: set[str] = field(default_factory=set)

    def ledger(self) -> dict[str, int]:
        """The parts account, with the keys of `World.ledger`."""
        accounts = dict.fromkeys(("on_belt", "held", "in_trays", *FINAL), 0)
        for place in self.parts.values():
            accounts["in_trays" if ":" in place else _ACCOUNT.get(place, place)] += 1
        return {"arrived": len(self.parts), **accounts}

    def tray_ledger(self) -> dict[str, int]:
        """The trays account, with the keys of `World.trays`."""
        accounts = dict.fromkeys(("stack", "held", "area", "shipped", "rejected"), 0)
        for place in self.trays.values():
            accounts["held" if place == "gripper" else place] += 1
        return {"arrived": len(self.trays), **accounts}

    def read(self, event: Event) -> None:
        """Take one event into account."""
        entry = event.data
        match event.kind:
            case "part_arrived":
                self._arrive(event, self.parts, entry["part"], entry["at"])
            case "part_moved_to":
                self._move(event, self.parts, entry["part"], entry["source"], entry["target"])
            case "tray_arrived":
                self._arrive(event, self.trays, entry["tray"], "stack")
            case "tray_moved_to":
                self._move(event, self.trays, entry["tray"], entry["source"], entry["target"])
            case "kit_judged":
                self.accepted += bool(entry["accepted"])
                self.rejected += not entry["accepted"]
            case _:
                return
        self.events += 1

    def _arrive(self, event: Event, things: dict[int, str], number: int, place: str) -> None:
        if number in things:
            self._mistake(event, f"{number} arrives a second time")
        self._settle(event, things, number, place)

    def _move(self, event: Event, things: dict[int, str], number: int, source: str, target: str) -> None:
        known = things.get(number)
        if known is None:
            self._mistake(event, f"{number} never arrived")
        elif known != source:
            self._mistake(event, f"{number} leaves {source}, but is in {known}")
        elif known in FINAL:
            self._mistake(event, f"{number} comes back from {known}")
        self._settle(event, things, number, target)

    def _settle(self, event: Event, things: dict[int, str], number: int, place: str) -> None:
        before = things.get(number, "")
        self._occupied.discard(before)
        if place == "gripper" or ":" in place:
            if place in self._occupied:
                self._mistake(event, f"{number} goes to {place}, which is not empty")
            self._occupied.add(place)
        things[number] = place

    def _mistake(self, event: Event, text: str) -> None:
        self.mistakes.append(f"event {event.number} at {event.time:.3f} s: {event.kind}: {text}")


def audit(events: Iterable[Event]) -> Audit:
    """The audit of a whole trace."""
    found = Audit()
    for event in events:
        found.read(event)
    return found
