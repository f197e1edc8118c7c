"""What sensors say of an assumption, and how much it takes to believe them (R §8.3, R §10; docs/hosts.md).

A sensor may answer `True`, `False` or `None` (it cannot tell), or with a `Reading` that also says when it was taken and
what the raw signal was, so that a reading that is too old, or a signal that never changes, can be told from news. A
`Caution` says how an assumption's readings are taken; without one the last reading counts, at once.
"""

from __future__ import annotations

from math import inf
from typing import TypeAlias

import msgspec

from planner_reactor.errors import InputError


class Reading(msgspec.Struct, frozen=True):
    """One answer of a sensor: `taken` at this instant (seconds), from this raw `signal` (None: it has none)."""

    holds: bool | None
    taken: float
    signal: object = None


Sensed: TypeAlias = "bool | Reading | None"


class Caution(msgspec.Struct, frozen=True, kw_only=True):
    """How the readings of one assumption are taken.

    It fails when `fails` of the last `window` readings that say anything say so. It holds again only after it has held
    for `hold_on` seconds. The planner is told of at most one change of mind in `hold_off` seconds; what rests on it is
    disabled at once, whoever is told. A reading taken more than `stale` seconds ago says nothing, nor does one whose
    signal has been the same for `stuck` seconds.
    """

    fails: int = 1
    window: int = 1
    hold_on: float = 0.0
    hold_off: float = 0.0
    stale: float = inf
    stuck: float = inf

    def __post_init__(self) -> None:
        if not 1 <= self.fails <= self.window:
            raise InputError(f"{self.fails} of {self.window} readings, expected at least 1 of at least as many")
        for name in ("hold_on", "hold_off", "stale", "stuck"):
            if not (value := getattr(self, name)) >= 0:
                raise InputError(f"{name} is {value!r}, expected seconds, 0 or more")


PLAIN = Caution()
"""The last reading counts, at once: what the papers do."""
