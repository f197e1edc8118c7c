"""The cell's run in words: what a person wants to hear of its events, and how its report is counted.

For programs that show runs of any world and know no word of this one. Nothing here looks into the cell: events and
the report are all that it reads.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from planner_reactor.trace import Event
from planner_reactor.workcell.disturbances import DISTURBANCES

PRODUCTS = "kits"
"""What the cell makes."""

MEANING = {
    "AQ": "all parts are good",
    "AS": "there is one variant of each part",
    "AF": "trays arrive empty",
    "ACT": "parts stay in the tray",
    "ACP": "nobody else fills kits",
    "ADT": "trays stay where they were put",
    "AM": "parts do not move",
    "ADD": "downstream is ready",
    "AO": "parts are placed in a fixed order",
}
"""What each assumption of R §8.2 says, while it is held."""

CONTINUING = {"downstream_ready": "downstream_blocked"}
"""Kinds of fault that end another one: they can strike only after it."""


def verdict(event: Event) -> bool | None:
    """Was a kit completed (True) or rejected (False)? None: the event is about something else."""
    return bool(event.data["accepted"]) if event.kind == "kit_judged" else None


def counted(report: Mapping[str, Any]) -> tuple[int, int]:
    """Kits completed and rejected, from the cell's report."""
    return report["kits"]["completed"], report["kits"]["rejected"]


def told(event: Event) -> str | None:
    """What happened in the cell, in a few words; None for what is not worth telling."""
    match event.kind:
        case "kit_judged" if event.data["accepted"]:
            return "a kit is completed"
        case "kit_judged":
            return f"a kit is rejected: {', '.join(event.data['reasons'])}"
        case "fault_struck":
            happens = (DISTURBANCES[event.data["fault"]].strike.__doc__ or event.data["fault"]).strip()
            return happens.partition(" (`")[0].rstrip(".") + "."
        case _:
            return None
