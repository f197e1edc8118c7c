"""The transition systems' part of the table: safe adaptations side by side, beside SPIN on the same model."""

from __future__ import annotations

from types import ModuleType
from typing import Any

import bench_transitions

from planner_reactor.experiments import spin

Row = dict[str, Any]

GOALS = {("enumerated", 3): 0.4, ("enumerated", 4): 37.0, ("factored", 100): 2.0}
"""Seconds; what SPIN took where the goals were set."""

MEGABYTES = 64.0


def systems(peers: dict[str, ModuleType]) -> list[Row]:
    """Seconds, memory and states; SPIN's beside them if peers are measured and it is there."""
    rows = bench_transitions.ours()
    theirs = bench_transitions.theirs(rows) if peers and not spin.missing() else []
    return [made for row in rows for made in _compared(row, theirs)]


def _compared(row: Row, theirs: list[Row]) -> list[Row]:
    engine, k, coupled = row["engine"], row["k"], row["coupled"]
    rival = "SPIN, reduced" if engine == "reduced" else "SPIN"
    beside = next((r for r in theirs if (r["engine"], r["k"], r["coupled"]) == (rival, k, coupled)), None)
    name = f"{k} adaptations{', coupled' * coupled}, {engine}"
    found = [limited(name, "s", row["seconds"], GOALS.get((engine, k)), beside and beside["seconds"])]
    if engine == "reduced":
        found.append(limited(f"{name}: states", "", row["states"], None, beside and beside["states"]))
    if (engine, k) == ("enumerated", 4):
        found.append(limited(f"{name}: memory", "MB", row["megabytes"], MEGABYTES, beside and beside["megabytes"]))
    return found


def limited(name: str, unit: str, value: float, goal: float | None, theirs: float | None) -> Row:
    """A row in which less is better."""
    return {
        "name": name,
        "unit": unit,
        "ours": round(value, 3),
        "goal": goal,
        "of_goal": None if goal is None else round(goal / max(value, 1e-9), 2),
        "peers": {} if theirs is None else {"SPIN": round(theirs, 3)},
        "ratio": {} if theirs is None else {"SPIN": round(theirs / max(value, 1e-9), 2)},
    }
