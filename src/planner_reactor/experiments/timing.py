"""What the planner's thinking costs on the run's clock.

A step of the planner is computed at once, and its results leave the planner so many seconds later: a fixed charge
(deterministic, the default), its real processor time (`measured`: not deterministic, and the trace says so), or the
durations of a recorded planner, such as that of 1994.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Protocol

from planner_reactor.errors import InputError
from planner_reactor.planner.planner import Step

PER_STEP = 0.001
"""Seconds charged for a planner step, unless told otherwise."""


class PlannerTime(Protocol):
    """How long a step of the planner takes."""

    @property
    def deterministic(self) -> bool: ...

    def seconds(self, step: Step, outstanding: int, cpu: float) -> float:
        """Seconds for this step; `outstanding` segments were to be planned before it, `cpu` seconds were used."""


class Fixed:
    """The same charge for every step."""

    deterministic = True

    def __init__(self, per_step: float = PER_STEP) -> None:
        if not 0 <= per_step < float("inf"):
            raise InputError(f"planner time of {per_step} s a step, expected 0 or more")
        self._per_step = per_step

    def seconds(self, step: Step, outstanding: int, cpu: float) -> float:
        return self._per_step


class Measured:
    """The processor time that the step really took."""

    deterministic = False

    def seconds(self, step: Step, outstanding: int, cpu: float) -> float:
        return cpu


class Recorded:
    """The durations of a recorded planner: so long for the first adaptation, so long for each relaxation.

    The time of a relaxation is shared out among the segments that it needs, each taking its share before it is
    issued; a forced one takes `forced_first` seconds to its first adaptation and `forced` to all the others.
    """

    deterministic = True

    def __init__(
        self,
        *,
        first: float,
        refinement: float,
        forced_first: float,
        forced: float,
        normal: Mapping[str, float],
        other: float,
    ) -> None:
        self._first = first
        self._refinement = refinement
        self._forced_first = forced_first
        self._forced = forced
        self._normal = normal
        self._other = other
        self._issued = 0
        self._relaxation: tuple[str, str] | None = None
        self._share = 0.0

    def seconds(self, step: Step, outstanding: int, cpu: float) -> float:
        if not step.adaptations:
            return 0.0
        self._issued += 1
        if self._issued == 1:
            return self._first
        if not step.assumption:
            return self._refinement
        if self._relaxation != (step.cause, step.assumption):
            self._relaxation = (step.cause, step.assumption)
            return self._begin(step, max(1, outstanding))
        return self._share

    def _begin(self, step: Step, segments: int) -> float:
        if step.cause == "normal":
            self._share = self._normal.get(step.assumption, self._other) / segments
            return self._share
        self._share = self._forced / max(1, segments - 1)
        return self._forced_first
