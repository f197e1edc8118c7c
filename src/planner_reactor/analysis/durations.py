"""Arithmetic on durations of which some are only names: each name stands for more than 0 seconds (docs/analysis.md).

Numbers are numbers; `greatest` and `least` choose where order is certain, and leave the rest standing as `max(a, b)`.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from math import inf
from typing import Any

from planner_reactor.rs.constraints import implies
from planner_reactor.rs.unknowns import Applied, Compared, Constraint, Sum, Symbolic, Unknown, split, unknowns


def positive(values: Sequence[Any]) -> list[Constraint]:
    """That every name among these values stands for more than 0."""
    return [Compared(-u, "<") for u in dict.fromkeys(u for v in values for u in unknowns(v))]


def at_most(low: Any, high: Any, known: Sequence[Constraint] = ()) -> bool:
    """Is the one certainly no more than the other?"""
    if high == inf:
        return True
    difference = low - high
    if not isinstance(difference, Symbolic):
        return bool(difference <= 0)
    return implies([*positive([difference]), *known], Compared(difference, "<="))  # type: ignore[arg-type]


def less(low: Any, high: Any, known: Sequence[Constraint] = ()) -> bool | None:
    """Is the one less than the other? None: it depends on what the names stand for."""
    if low == inf or high == inf:
        return bool(low != inf)
    difference = low - high
    if not isinstance(difference, Symbolic):
        return bool(difference < 0)
    rows = [*positive([difference]), *known]
    if implies(rows, Compared(difference, "<")):  # type: ignore[arg-type]
        return True
    return False if implies(rows, Compared(-difference, "<=")) else None


def greatest(*values: Any) -> Any:
    """The greatest; where order is open, `max` of those that may be."""
    return _chosen("max", values, lambda one, other: at_most(one, other))


def least(*values: Any) -> Any:
    """The least; where order is open, `min` of those that may be."""
    return _chosen("min", values, lambda one, other: at_most(other, one))


def _chosen(name: str, values: Sequence[Any], beaten: Any) -> Any:
    flat = list(dict.fromkeys(v for value in values for v in _parts(name, value)))
    kept: list[Any] = []
    for n, value in enumerate(flat):
        others = [*kept, *flat[n + 1 :]]
        if not any(beaten(value, other) for other in others):
            kept.append(value)
    if len(kept) <= 1:
        return kept[0] if kept else (flat[-1] if flat else 0)
    return Applied(name, tuple(sorted(kept, key=repr)))


def _parts(name: str, value: Any) -> Iterator[Any]:
    if isinstance(value, Applied) and value.function == name:
        yield from value.arguments
    else:
        yield value


def valued(value: Any, given: Mapping[str, float]) -> Any:
    """The duration with names replaced by numbers; what is still open stays."""
    match value:
        case Unknown(name):
            return given.get(name, value)
        case Applied("max" | "min" as name, arguments):
            return (greatest if name == "max" else least)(*(valued(a, given) for a in arguments))
        case Applied(function, arguments):
            return Applied(function, tuple(valued(a, given) for a in arguments))
        case Sum():
            factors, constant = split(value)
            return sum((valued(part, given) * factor for part, factor in factors.items()), constant)
    return value
