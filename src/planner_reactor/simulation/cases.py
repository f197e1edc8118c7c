"""What is simulated, as values: a case is a world, a seed, a length and a list of faults; all else follows from it.

A fault strikes at an instant (seconds), or, if it names a point, at the next such point inside an adaptation from then
on. So a fault list can be made shorter without what is left losing its sense.
"""

from __future__ import annotations

from collections.abc import Mapping
from random import Random
from typing import Literal

import msgspec

from planner_reactor.workcell.disturbances import DISTURBANCES

World = Literal["workshop", "cell"]
Kind = Literal[
    "crash", "power", "storm", "cut", "silent_reactor", "silent_planner", "planner", "leader", "stale", "full", "sync",
    "halt", "flap", "unknown", "stuck", "noise", "raise", "hang", "drive", "jump", "crowd", "replay", "world",
    "nothing",
]  # fmt: skip
Point = Literal[
    "received", "appending", "appended", "synced", "draining", "inhibited", "removed", "retired", "renewed", "added",
    "uninhibited", "applied", "refused", "timed_out", "told", "restoring",
]  # fmt: skip

POINTS: tuple[Point, ...] = Point.__args__  # type: ignore[attr-defined]
KINDS: tuple[Kind, ...] = Kind.__args__  # type: ignore[attr-defined]
INSIDE: tuple[Kind, ...] = ("crash", "crash", "crash", "power", "power", "cut", "planner", "halt", "full", "sync")
"""What strikes at points, the more often the more it is named."""

WEIGHTS: Mapping[Kind, int] = {
    "crash": 2, "power": 2, "storm": 1, "cut": 3, "silent_reactor": 2, "silent_planner": 2, "planner": 2, "leader": 2,
    "stale": 2, "full": 1, "sync": 1, "halt": 1, "flap": 2, "unknown": 2, "stuck": 2, "noise": 1, "raise": 3, "hang": 1,
    "drive": 3, "jump": 2, "replay": 2,
}  # fmt: skip

CELL: Mapping[Kind, int] = {
    "crash": 3, "power": 3, "cut": 2, "silent_reactor": 1, "silent_planner": 1, "full": 1, "sync": 1, "halt": 1,
    "jump": 1, "world": 6,
}  # fmt: skip
"""The same for the cell, whose planner cannot be replaced while it stands."""


class Fault(msgspec.Struct, frozen=True, omit_defaults=True):
    """`seconds`: how long it lasts, if it lasts. `what` belongs to the kind: an assumption, a fault of the world."""

    kind: Kind
    at: float
    point: Point | None = None
    seconds: float = 0.0
    what: str = ""


class Case(msgspec.Struct, frozen=True, omit_defaults=True):
    """`seconds`: how long faults strike; then they cease, and all has to come to rest (law 17)."""

    world: World
    seed: int
    seconds: float
    faults: tuple[Fault, ...] = ()


def drawn(world: World, seed: int, seconds: float) -> Case:
    """The case of a seed: a fault inside an adaptation every 90 s or so, and another at any time every 180 s."""
    draw = Random(f"case {world} {seed}")
    faults = []
    kinds, weights = list(WEIGHTS), list(WEIGHTS.values())
    every = 90.0 if world == "workshop" else 200.0
    for _ in range(int(seconds / every)):
        at = round(draw.uniform(5.0, seconds), 2)
        kind = draw.choice(INSIDE)
        if world == "cell" and kind == "planner":
            kind = "crash"
        faults.append(Fault(kind, at, draw.choice(POINTS), _lasts(draw)))
    if world == "cell":
        kinds, weights = list(CELL), list(CELL.values())
    for _ in range(int(seconds / (2 * every))):
        (kind,) = draw.choices(kinds, weights)
        what = f"A{draw.randrange(3)}" if kind in ("flap", "unknown", "stuck") else ""
        if kind == "world":
            what = draw.choice(sorted(DISTURBANCES))
        faults.append(Fault(kind, round(draw.uniform(5.0, seconds), 2), None, _lasts(draw), what))
    if world == "workshop" and draw.random() < 0.05:
        faults.append(Fault("crowd", round(draw.uniform(5.0, seconds / 2), 2), None, 15.0))
    return Case(world, seed, seconds, tuple(sorted(faults, key=lambda f: (f.at, f.kind))))


def _lasts(draw: Random) -> float:
    return round(draw.choice((draw.uniform(0.2, 3.0), draw.uniform(3.0, 40.0))), 2)
