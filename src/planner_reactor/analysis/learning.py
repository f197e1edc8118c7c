"""The open names of an environment model, learned from what was seen of it (X §7: "the former can only be addressed by
learning").

What a source of Definition 1 or 4 shows is (seconds, value) at a port. How long a value stands, γ + τ, and what the
next one differs by, δ, are expressions of the model in which some names are open: the model says what is to be
measured, the observations how much it is. They are taken now and then, so a change is known to lie between two.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import Any

import msgspec

from planner_reactor.analysis.denseness import Failure, Netlist
from planner_reactor.analysis.durations import valued
from planner_reactor.errors import InputError
from planner_reactor.rs.unknowns import Unknown, split

FEWEST = 3
"""Changes that have to be seen."""


class Observed(msgspec.Struct, frozen=True):
    """How a value changed: seconds between changes, each change, and how far each instant is known."""

    period: float
    steps: tuple[float, ...]
    error: float

    @property
    def mean(self) -> float:
        return sum(self.steps) / len(self.steps)

    @property
    def most(self) -> float:
        return max(map(abs, self.steps))


class Learned(msgspec.Struct, frozen=True):
    """What open names are: `values`, each within `errors` of it (for a bound that is drawn: it is at least that)."""

    values: Mapping[str, float]
    errors: Mapping[str, float]
    changes: int


def observed(readings: Sequence[tuple[float, float]]) -> Observed:
    """The changes in readings (seconds, value), in order of time. InputError for fewer than three.

    The period is the shortest time that fits all changes, so that changes which nobody saw do not count: n periods lie
    between two of them.
    """
    at = [((a + b) / 2, b - a, w - v) for (a, v), (b, w) in pairwise(readings) if abs(w - v) > 1e-9]
    if len(at) < FEWEST:
        raise InputError(f"{len(at)} changes in {len(readings)} readings, expected at least {FEWEST}")
    error = max(width for _, width, _ in at)
    gaps = [b - a for (a, _, _), (b, _, _) in pairwise(at)]
    period = min(gaps)
    for _ in range(3):  # each gap is a whole number of periods: take the mean over all
        counts = [max(1, round(gap / period)) for gap in gaps]
        period = sum(gaps) / sum(counts)
    steps = (step / times for (_, _, step), times in zip(at, [1, *counts], strict=True))
    return Observed(period, tuple(steps), error / sum(counts) * 2)


def learned(
    nets: Netlist, port: str, readings: Sequence[tuple[float, float]], given: Mapping[str, float] | None = None
) -> Learned:
    """The open names of the source at a port, from readings of what it shows.

    `given` are names that are known. InputError for a port that is no source, or of which nothing is open.
    """
    own = nets.local(port)
    if isinstance(own, Failure):
        raise InputError(str(own))
    if own.takes or own.resolution is None:
        ports = ", ".join(str(p) for takes in own.takes for p, _ in takes)
        raise InputError(f"{port} is no source: what it shows depends on {ports}")
    seen = observed(readings)
    values: dict[str, float] = {}
    errors: dict[str, float] = {}
    claims = [(own.delay + own.resolution, seen.period, seen.error)]
    drawn = own.change is not None and own.most is not None and own.change != own.most
    if own.most is not None:
        claims.append((own.most, seen.most if drawn else seen.mean, 0.0))
    for expression, measured, error in claims:
        name, value = _solved(valued(expression, {**(given or {}), **values}), measured)
        if name:
            values[name], errors[name] = value, error
    if not values:
        raise InputError(f"nothing is open in what {port} shows")
    return Learned(values, errors, len(seen.steps))


def _solved(expression: Any, measured: float) -> tuple[str, float]:
    """The one open name of an expression, and its value if the expression has that one."""
    factors, constant = split(expression)
    names = [part for part in factors if isinstance(part, Unknown)]
    if len(names) != 1 or len(factors) != 1:
        return "", 0.0
    return names[0].name, (measured - constant) / factors[names[0]]
