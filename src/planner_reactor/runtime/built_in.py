"""Which leaf runs which built-in process that needs no reactor: ports, time, tests (X §4.1, R §4.2)."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType

from planner_reactor.rs.leaves import TESTS
from planner_reactor.rs.terms import Value
from planner_reactor.runtime.leaves import Never, Pass, Ran, Setting, Test, at_most, milliseconds
from planner_reactor.runtime.ports import In, Out, Ports
from planner_reactor.runtime.strands import Instruction


def _greater(a: Value, b: Value) -> bool:
    if a.__class__ is int and b.__class__ is int:
        return a > b
    return TESTS["GTR"](a, b)


def _less(a: Value, b: Value) -> bool:
    if a.__class__ is int and b.__class__ is int:
        return a < b
    return TESTS["LST"](a, b)


LEAVES: Mapping[str, Callable[[Setting, Ports], Instruction]] = MappingProxyType(
    {
        "GTR": lambda setting, ports: Test(setting, _greater),
        "LST": lambda setting, ports: Test(setting, _less),
        "Equal": lambda setting, ports: Test(setting, TESTS["Equal"]),
        "Ran": lambda setting, ports: Ran(setting),
        "Delay": lambda setting, ports: Pass(setting),
        "SUSPEND": lambda setting, ports: Pass(setting, milliseconds),
        "Term": lambda setting, ports: Pass(setting, at_most),
        "NIL": lambda setting, ports: Never(setting),
        "IN": In,
        "OUT": Out,
    }
)
"""By name; each makes the leaf of one call."""
