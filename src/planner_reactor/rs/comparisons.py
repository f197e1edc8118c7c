"""The tests GTR, LST and Equal (R §4.2, X §5): what they compare, in analysis and in execution alike.

What is not a number is neither greater nor less than anything; Equal compares numbers within a tolerance.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType

from planner_reactor.rs.expressions import is_number
from planner_reactor.rs.terms import Value
from planner_reactor.rs.unknowns import Symbolic
from planner_reactor.rs.unknowns import equal as decided_equal

TOLERANCE = 1e-9
"""By how much equal numbers may differ, unless a test says otherwise."""


def greater(a: Value, b: Value) -> bool:
    return is_number(a) and is_number(b) and a > b  # type: ignore[operator]


def less(a: Value, b: Value) -> bool:
    return greater(b, a)


def equal(a: Value, b: Value, tolerance: Value = TOLERANCE) -> bool:
    if isinstance(a, Symbolic) or isinstance(b, Symbolic):
        return decided_equal(a, b, tolerance)
    if is_number(a) and is_number(b) and is_number(tolerance):
        return bool(abs(a - b) <= tolerance)  # type: ignore[operator]
    return a == b


TESTS: Mapping[str, Callable[..., bool]] = MappingProxyType({"GTR": greater, "LST": less, "Equal": equal})
