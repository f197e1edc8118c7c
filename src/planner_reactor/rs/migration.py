"""What becomes of the arguments of a queued ASSERT when its situation takes others (MIGRATE in docs/language.md).

Each new argument is said in one value: a whole number is the place, from 1, of an old argument; a name is that of a
function of the host, which is given all the old ones.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

from planner_reactor.rs.expressions import EvaluationError, applied
from planner_reactor.rs.terms import Value


def migrated(
    old: tuple[Value, ...], how: Sequence[Value], functions: Mapping[str, Callable[..., Value]]
) -> tuple[Value, ...] | None:
    """The new arguments, or None if one of them cannot be worked out."""
    try:
        return tuple(_one(old, way, functions) for way in how)
    except EvaluationError:
        return None


def _one(old: tuple[Value, ...], way: Value, functions: Mapping[str, Callable[..., Value]]) -> Value:
    if isinstance(way, str):
        return applied(way, list(old), functions)
    if isinstance(way, int) and 1 <= way <= len(old):
        return old[way - 1]
    raise EvaluationError(f"there is no argument {way!r}, there are {len(old)}")
