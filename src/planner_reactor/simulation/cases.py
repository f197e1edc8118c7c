"""What is simulated, as values: a case is a world, a seed, a length and a list of faults; all else follows from it.

A fault strikes at an instant (seconds), or, if it names a point, at the next such point inside an adaptation from then
on. So a fault list can be made shorter without what is left losing its sense.
"""

from __future__ import annotations

from collections.abc import Mapping
from random import Random
from typing import Literal

import msgspec

from planner_reactor.workcell.disturbances import DISTURBANCES, PASSING

World = Literal["workshop", "cell"]
Kind = Literal[
    "crash", "power", "storm", "cut", "silent_reactor", "silent_planner", "planner", "leader", "stale", "full", "sync",
    "halt", "fails", "noticed", "flap", "unknown", "stuck", "noise", "late", "raise", "hang", "failing", "drive",
    "jump", "crowd", "replay", "version", "watchdog", "world", "nothing",
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
    "stale": 2, "full": 1, "sync": 1, "halt": 1, "fails": 4, "noticed": 2, "flap": 2, "unknown": 2, "stuck": 2,
    "noise": 2, "late": 2, "raise": 3, "hang": 2, "drive": 3, "jump": 2, "replay": 2, "version": 1, "watchdog": 1,
}  # fmt: skip

CELL: Mapping[Kind, int] = {
    "crash": 3, "power": 3, "cut": 2, "silent_reactor": 1, "silent_planner": 1, "planner": 4, "leader": 2, "full": 1,
    "sync": 1, "halt": 1, "jump": 1, "world": 8,
}  # fmt: skip
"""The same for the cell."""

FAILING = 0.05
"""The part of the workshop's cases in which everything fails for a while."""

TRUSTING = 0.5
"""The part of the cell's cases in which its planner gives up nothing but what fails."""

HELD = "holding"
"""What a crash of the cell waits for: something in the gripper."""


class Fault(msgspec.Struct, frozen=True, omit_defaults=True):
    """`seconds`: how long it lasts, if it lasts. `what` belongs to the kind: an assumption, a fault of the world."""

    kind: Kind
    at: float
    point: Point | None = None
    seconds: float = 0.0
    what: str = ""


class Case(msgspec.Struct, frozen=True, omit_defaults=True):
    """`seconds`: how long faults strike; then they cease, and all has to come to rest (law 17). `trusting`: the cell's
    planner gives up nothing but what fails, so that much comes back.
    """

    world: World
    seed: int
    seconds: float
    faults: tuple[Fault, ...] = ()
    trusting: bool = False


def drawn(world: World, seed: int, seconds: float) -> Case:
    """The case of a seed: a fault inside an adaptation every 90 s or so, and another at any time every 180 s.

    The cell's planner issues most of what it has to say in the first minutes: there half of the faults strike then.
    """
    draw = Random(f"case {world} {seed}")
    every, early = (90.0, seconds) if world == "workshop" else (200.0, min(60.0, seconds))

    def when() -> float:
        return round(draw.uniform(5.0, draw.choice((early, seconds))), 2)

    faults = [
        Fault(draw.choice(INSIDE), when(), draw.choice(POINTS), _lasts(draw)) for _ in range(int(seconds / every))
    ]
    kinds = WEIGHTS if world == "workshop" else CELL
    for kind in draw.choices(list(kinds), list(kinds.values()), k=int(seconds / (2 * every))):
        faults.append(Fault(kind, when(), None, _lasts(draw), _what(kind, draw)))
    if world == "cell":
        faults.append(Fault("crash", round(draw.uniform(60.0, seconds), 2), None, 0.0, HELD))
    elif draw.random() < FAILING:
        faults.append(Fault("failing", round(draw.uniform(5.0, seconds / 2), 2), None, 1.0))
    trusting = world == "cell" and draw.random() < TRUSTING
    if trusting:
        faults += [fault for _ in range(max(1, int(seconds / 450))) for fault in _passing(draw, seconds)]
    return Case(world, seed, seconds, tuple(sorted(faults, key=lambda f: (f.at, f.kind))), trusting)


def _passing(draw: Random, seconds: float) -> tuple[Fault, ...]:
    """Something goes wrong for good, and something for a while."""
    begins, ends = PASSING
    at = round(draw.uniform(30.0, seconds), 2)
    over = round(at + draw.uniform(20.0, 120.0), 2)
    wrong = Fault("world", round(draw.uniform(30.0, seconds), 2), what=_what("world", draw))
    return wrong, Fault("world", at, what=begins), Fault("world", over, what=ends)


def _what(kind: Kind, draw: Random) -> str:
    if kind == "world":
        return draw.choice(sorted(DISTURBANCES))
    return f"A{draw.randrange(3)}" if kind in ("fails", "flap", "unknown", "stuck", "noise", "late") else ""


def _lasts(draw: Random) -> float:
    return round(draw.choice((draw.uniform(0.2, 3.0), draw.uniform(3.0, 40.0))), 2)
