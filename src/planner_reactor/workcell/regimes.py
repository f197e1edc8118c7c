"""Regimes of the cell: for each of the nine assumptions, what keeps it false for as long as a run lasts (R §6.2, §10).

An assumption that failed once, and is true again, tells little of a reactor; here each false one is broken again and
again, at instants that differ from assumption to assumption. What is not named is left alone, and holds. All of it
happens in the world: what a program knows of it, it knows by its sensors.

The belt is short (`SHORT_BELT`): a part passes in 16 s, so that waiting for its turn costs it. Times are seconds.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from functools import partial
from typing import Any

import msgspec

from planner_reactor.errors import InputError, nearest
from planner_reactor.runtime.scheduler import Scheduler
from planner_reactor.workcell.kit import SERVOMOTOR
from planner_reactor.workcell.world import World

SHORT_BELT = replace(SERVOMOTOR, dwell_s=16.0)
"""The servomotor of R Fig. 7, beside a belt of 40 cm."""

ORDER_LASTS = 30.0
"""Seconds for which one kind comes, where kinds come by turns."""

FOR_EVER = 1e9


class Breaking(msgspec.Struct, frozen=True):
    """What breaks an assumption: a kind of fault from `first` on every `period` seconds (0: once, and for ever).

    With `each_kind` it strikes one kind of part after the other; every second time `turned` is added.
    """

    kind: str
    first: float
    period: float
    parameters: dict[str, Any] = msgspec.field(default_factory=dict)
    each_kind: bool = False
    turned: dict[str, Any] = msgspec.field(default_factory=dict)


BREAKING: dict[str, Breaking] = {
    "AQ": Breaking("bad_parts", 5.0, 40.0, {"count": 2, "share": 0.5}, each_kind=True),
    "AS": Breaking("variants", 15.0, 60.0, {"count": 2}, each_kind=True),
    "AF": Breaking("filled_tray", 8.0, 56.0, each_kind=True),
    "ACT": Breaking("part_removed_from_tray", 35.0, 80.0),
    "ACP": Breaking("part_added_to_tray", 55.0, 80.0),
    "ADT": Breaking("tray_moved", 25.0, 60.0, turned={"along_mm": -60.0}),
    "AM": Breaking("part_moved", 5.0, 2.5),
    "ADD": Breaking("downstream_blocked", 45.0, 60.0, {"duration_s": 25.0}),
    "AO": Breaking("arrival_order", 1.0, 0.0, {"reversed": True, "phase_s": ORDER_LASTS, "duration_s": FOR_EVER}),
}
"""By assumption."""


class Regime:
    """The regime in which exactly these are false, from `begin` on; each is broken `apart` times as rarely.

    A fault strikes as soon as it can; the next of its kind is due a period later, so that none pile up.
    """

    def __init__(self, false: Iterable[str], *, apart: float = 1.0) -> None:
        for name in false:
            if name not in BREAKING:
                raise InputError(f"unknown assumption {name}, {nearest(name, BREAKING) or 'expected one of the nine'}")
        self._false = tuple(false)
        self._apart = apart

    def begin(self, world: World, scheduler: Scheduler) -> None:
        """Let it happen in this world, on this clock."""
        for name in self._false:
            breaking = BREAKING[name]
            scheduler.call_after(breaking.first, partial(self._due, breaking, 0, world, scheduler))

    def _due(self, breaking: Breaking, times: int, world: World, scheduler: Scheduler) -> None:
        if not self._strikes(breaking, times, world, scheduler):
            world.attempts.append(partial(self._strikes, breaking, times, world, scheduler))

    def _strikes(self, breaking: Breaking, times: int, world: World, scheduler: Scheduler) -> bool:
        if not world.strike(breaking.kind, **parameters(breaking, times)):
            return False
        if breaking.period:
            again = partial(self._due, breaking, times + 1, world, scheduler)
            scheduler.call_after(breaking.period * self._apart, again)
        return True


def parameters(breaking: Breaking, times: int) -> dict[str, Any]:
    """Of the fault, after it has struck so many times."""
    kinds = SHORT_BELT.order
    struck = {"part": kinds[times % len(kinds)]} if breaking.each_kind else {}
    return {**breaking.parameters, **struck, **(breaking.turned if times % 2 else {})}
