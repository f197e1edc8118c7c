"""Which faults strike when: one of each kind in turn, or at random by a seed.

Only what the world says of itself is used: the kinds of its faults and their parameters. What is peculiar to a kind
(that it would last for ever, that it ends another) the caller says.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from random import Random
from typing import Any

from planner_reactor.errors import InputError, nearest
from planner_reactor.runtime import World
from planner_reactor.workcell.faults import Fault

SHORTEST, LONGEST = 20.0, 150.0
"""Seconds for which a fault lasts that would last for ever."""


def in_turn(
    world: World, kinds: Sequence[str], *, begin: float, apart: float, endless: Mapping[str, str]
) -> tuple[Fault, ...]:
    """One fault of each of these kinds, so many seconds apart."""
    return tuple(
        Fault(begin + n * apart, kind, _ended(world, kind, endless, apart / 2)) for n, kind in enumerate(kinds)
    )


def at_random(
    world: World,
    seed: int,
    *,
    count: int,
    begin: float,
    end: float,
    endless: Mapping[str, str],
    leave_out: Collection[str] = (),
) -> tuple[Fault, ...]:
    """So many faults of random kinds between two instants (seconds), by time; the same for the same seed."""
    draw = Random(f"faults {seed}")
    kinds = [kind for kind in sorted(world.faults) if kind not in leave_out]
    found = []
    for _ in range(count):
        kind = draw.choice(kinds)
        at = round(draw.uniform(begin, end), 3)
        found.append(Fault(at, kind, _ended(world, kind, endless, round(draw.uniform(SHORTEST, LONGEST), 3))))
    return tuple(sorted(found, key=lambda fault: fault.at))


def _ended(world: World, kind: str, endless: Mapping[str, str], seconds: float) -> dict[str, Any]:
    if kind not in world.faults:
        raise InputError(f"unknown fault {kind}, {nearest(kind, world.faults)}")
    return {endless[kind]: seconds} if kind in endless else {}
