"""The cell's run in words: what a person wants to hear of its events, and how its report is counted.

For programs that show runs of any world and know no word of this one. Nothing here looks into the cell: events and
the report are all that it reads.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import msgspec

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

PAPERS_NOTES = (
    "papers' clock: the durations of the planner of 1994, and an arm 3.3 times slower than ours. Its pace is not "
    "printed; it follows from no stub having been reached in the 14 s before the first ideal reactor was there.",
    "AM: a part slides away just as the gripper closes on it, so the fault of 152 s strikes when it next does.",
    "AS: the planner issues the next adaptation of a situation when the last one is in; on the papers' clock those for "
    "AS wait for those for AQ, and these for situations to end.",
    "40 s and 42 s, 11 s and 14 s: the papers contradict themselves there.",
)
"""What has to be said of a replay of the papers' run in this cell."""

ENDLESS = {"downstream_blocked": "duration_s"}
"""Kinds of fault that last for ever, unless this parameter says otherwise."""

ENDING = ("downstream_ready",)
"""Kinds of fault that end another one, and cannot strike without it."""

EACH = tuple(next(k for k, d in DISTURBANCES.items() if d.breaks == assumption) for assumption in MEANING)
"""One kind of fault for each assumption."""


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
            happens = happens.partition(" (")[0].rstrip(".")
            return happens[:1].lower() + happens[1:]
        case _:
            return None


class Loss(msgspec.Struct, frozen=True):
    """A kit that was rejected: when (seconds), why, and the kinds of fault that spoiled it."""

    time: float
    reasons: tuple[str, ...]
    faults: tuple[str, ...]


def lost(report: Mapping[str, Any]) -> list[Loss]:
    """The kits that were rejected, from the cell's report."""
    return [Loss(r["time_s"], tuple(r["reasons"]), tuple(r["faults"])) for r in report["rejections"]]
