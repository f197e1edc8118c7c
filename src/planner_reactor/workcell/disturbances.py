"""What can go wrong in the cell (R §8.1): each kind of fault, the assumption that it breaks, and how it
strikes.

A fault happens in the world; the program must find it out by its sensors. `strike` says False while it cannot
happen yet (no tray stands there, the gripper is not closing …) and is tried again after every event.
Parameters are typed by their defaults; `part = ""` means: the first kind in the kit's order, or any.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, TypeAlias

import msgspec

from planner_reactor.workcell.belt import Batch, Turns
from planner_reactor.workcell.plant import Plant
from planner_reactor.workcell.things import Part, Tray

REACH_IN_S = 3.0
"""Seconds between two disturbances of the tray area: one hand at a time."""

Parameters: TypeAlias = Mapping[str, Any]
Strike: TypeAlias = Callable[[Plant, int, Parameters], bool]


class Disturbance(msgspec.Struct, frozen=True):
    """A kind of fault. `breaks`: its assumption ("" for none); `sensed_by`: the evidence that shows it."""

    kind: str
    breaks: str
    sensed_by: tuple[str, ...]
    defaults: Parameters
    strike: Strike


DISTURBANCES: dict[str, Disturbance] = {}
"""Every kind of fault, by name."""

PASSING = ("downstream_blocked", "downstream_ready")
"""What begins and what ends the fault whose assumption comes back."""


def _kind(
    name: str, *, breaks: str = "", sensed_by: tuple[str, ...] = (), **defaults: Any
) -> Callable[[Strike], Strike]:
    """Enter a kind of fault; what breaks an assumption is sensed by evidence against it, if nothing else is
    said.
    """

    def enter(strike: Strike) -> Strike:
        DISTURBANCES[name] = Disturbance(name, breaks, sensed_by or (breaks,), defaults, strike)
        return strike

    return enter


@_kind("part_moved", breaks="AM", part="", along_mm=80.0, across_mm=0.0, count=1, closing=True)
def _part_moved(plant: Plant, mark: int, p: Parameters) -> bool:
    """A part slides away under the closing gripper (`count` times in a row)."""
    part = _at_gripper(plant, p)
    if part is None:
        return False
    plant.belt.shift(part, p["along_mm"] / 1000, p["across_mm"] / 1000)
    if p["count"] > 1:
        plant.attempts.append(lambda: _part_moved(plant, mark, {**p, "count": p["count"] - 1}))
    return True


@_kind("part_taken", breaks="AM", part="", closing=True)
def _part_taken(plant: Plant, mark: int, p: Parameters) -> bool:
    """Somebody takes a part off the belt, under the closing gripper."""
    part = _at_gripper(plant, p)
    if part is not None:
        plant.take_from_belt(part, "part_taken")
    return part is not None


@_kind("bad_parts", breaks="AQ", part="", count=2, share=0.5)
def _bad_parts(plant: Plant, mark: int, p: Parameters) -> bool:
    """A batch of bad quality: `share` of what arrives, until the arm has taken `count` of them."""
    batch = Batch(p["count"], p["share"], mark, until_taken=True)
    for kind, feeder in plant.belt.feeders.items():
        if p["part"] in ("", kind):
            feeder.batches.append(batch)
    return True


@_kind("variants", breaks="AS", part="", variant="", count=4, share=0.5)
def _variants(plant: Plant, mark: int, p: Parameters) -> bool:
    """Parts of another variant come along (`variant` "": one that downstream refuses)."""
    kind = p["part"] or plant.kit.order[0]
    part = plant.kit.by_kind[kind]
    others = part.misfits or part.substitutes
    variant = p["variant"] or (others[0] if others else "")
    if not variant:
        return False
    plant.belt.feeders[kind].batches.append(Batch(p["count"], p["share"], mark, variant))
    return True


@_kind("damaged_trays", breaks="AQ", count=1)
def _damaged_trays(plant: Plant, mark: int, p: Parameters) -> bool:
    """The topmost trays of the stack are damaged."""
    fit = [tray for tray in reversed(plant.stack) if tray.good][: p["count"]]
    for tray in fit:
        tray.good = False
        tray.marks = (*tray.marks, mark)
    return bool(fit)


@_kind("filled_tray", breaks="AF", part="", slots=1, good=True)
def _filled_tray(plant: Plant, mark: int, p: Parameters) -> bool:
    """The next tray is not empty."""
    if not plant.stack:
        return False
    tray = plant.stack[-1]
    kinds = [p["part"]] if p["part"] else list(plant.kit.order[: max(1, p["slots"])])
    for kind in kinds:
        if kind not in tray.slots:
            plant.add_to_tray(tray, _new_part(plant, kind, mark, p["good"]), "filled_tray")
    return True


@_kind("part_removed_from_tray", breaks="ACT", part="")
def _part_removed_from_tray(plant: Plant, mark: int, p: Parameters) -> bool:
    """Somebody takes a placed part away."""
    for tray in _reachable(plant):
        slots = [slot for slot in tray.slots if p["part"] in ("", slot)]
        if slots:
            tray.marks = (*tray.marks, mark)
            plant.reached_in = plant.scheduler.now
            plant.take_from_tray(tray, slots[0], "part_removed_from_tray")
            return True
    return False


@_kind("part_added_to_tray", breaks="ACP", sensed_by=("ACP", "AF"), part="", good=True)
def _part_added_to_tray(plant: Plant, mark: int, p: Parameters) -> bool:
    """Somebody else fills a slot."""
    for tray in _reachable(plant):
        vacant = [kind for kind in reversed(plant.kit.order) if kind not in tray.slots and p["part"] in ("", kind)]
        if vacant:
            plant.reached_in = plant.scheduler.now
            plant.add_to_tray(tray, _new_part(plant, vacant[0], mark, p["good"]), "part_added_to_tray")
            return True
    return False


@_kind("tray_moved", breaks="ADT", along_mm=60.0, across_mm=40.0)
def _tray_moved(plant: Plant, mark: int, p: Parameters) -> bool:
    """A tray is pushed aside."""
    for tray in _reachable(plant):
        tray.marks = (*tray.marks, mark)
        plant.reached_in = plant.scheduler.now
        tray.pose = (tray.pose[0] + p["along_mm"] / 1000, tray.pose[1] + p["across_mm"] / 1000)
        plant.happened()
        return True
    return False


@_kind("downstream_blocked", breaks="ADD", duration_s=0.0)
def _downstream_blocked(plant: Plant, mark: int, p: Parameters) -> bool:
    """Downstream takes no trays (`duration_s` 0: until downstream_ready)."""
    plant.downstream.block(mark)
    if p["duration_s"] > 0:
        plant.scheduler.call_after(p["duration_s"], plant.downstream.unblock)
    return True


@_kind("downstream_ready", sensed_by=("ready",))
def _downstream_ready(plant: Plant, mark: int, p: Parameters) -> bool:
    """Downstream takes trays again."""
    if plant.downstream.ready:
        return False
    plant.downstream.unblock()
    return True


@_kind("starved_kind", breaks="AO", part="", duration_s=0.0)
def _starved_kind(plant: Plant, mark: int, p: Parameters) -> bool:
    """One kind stays away (`duration_s` 0: two and a half passages of the belt)."""
    feeder = plant.belt.feeders[p["part"] or plant.kit.order[0]]
    feeder.away_until = plant.scheduler.now + (p["duration_s"] or 2.5 * plant.kit.dwell_s)
    return True


@_kind("arrival_order", breaks="AO", reversed=False, phase_s=0.0, duration_s=0.0)
def _arrival_order(plant: Plant, mark: int, p: Parameters) -> bool:
    """Kinds come one at a time, each in its turn (`phase_s` 0: one and a half passages of the belt)."""
    now = plant.scheduler.now
    order = tuple(reversed(plant.kit.order)) if p["reversed"] else plant.kit.order
    phase = p["phase_s"] or 1.5 * plant.kit.dwell_s
    plant.belt.turns = Turns(now, phase, now + (p["duration_s"] or 9 * phase), order)
    return True


@_kind("camera_dark", sensed_by=("camera",), duration_s=20.0)
def _camera_dark(plant: Plant, mark: int, p: Parameters) -> bool:
    """The global camera sees nothing."""
    plant.dark_until = plant.scheduler.now + p["duration_s"]
    return True


@_kind("part_dropped", sensed_by=("gripper",))
def _part_dropped(plant: Plant, mark: int, p: Parameters) -> bool:
    """The held part slips out of the gripper."""
    if not isinstance(plant.gripper, Part):
        return False
    plant.drop_held_part("part_dropped")
    return True


def _at_gripper(plant: Plant, p: Parameters) -> Part | None:
    """The part that the gripper is about to close on (or, not `closing`, the one that is furthest along)."""
    if p["closing"]:
        if plant.closing is None:
            return None
        part = plant.belt.under(*plant.closing, plant.calibration.grasp_tolerance)
        return part if part is not None and p["part"] in ("", part.kind) else None
    riding = [part for parts in plant.belt.parts.values() for part in parts.values() if p["part"] in ("", part.kind)]
    return min(riding, key=lambda part: part.u, default=None)


def _reachable(plant: Plant) -> list[Tray]:
    """The trays that somebody else can reach: nobody reaches under a working arm, nor two at once."""
    if plant.arm_over_trays or plant.scheduler.now < plant.reached_in + REACH_IN_S:
        return []
    return list(plant.area.values())


def _new_part(plant: Plant, kind: str, mark: int, good: bool) -> Part:
    return Part(next(plant.numbers), kind, plant.kit.by_kind[kind].wanted, good=good, marks=(mark,))
