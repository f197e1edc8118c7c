"""Which leaf runs which built-in process that needs no reactor: ports, time, tests (X §4.1, R §4.2)."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType

from planner_reactor.rs.comparisons import TESTS
from planner_reactor.rs.terms import Number, Variable
from planner_reactor.runtime.leaves import Never, Pass, Ran, Setting, Test, at_most, milliseconds
from planner_reactor.runtime.ports import In, Out, Ports
from planner_reactor.runtime.strands import Frame, Instruction


def _test(setting: Setting) -> Test:
    """The test itself is that of `rs.comparisons`; two integers, one of them constant, are compared at once."""
    rule, arguments = TESTS[setting.name], setting.arguments

    def holds(frame: Frame) -> bool:
        return rule(*arguments(frame))

    slot = setting.slots[0] if setting.slots else -1
    match setting.name, setting.terms:
        case ("GTR", (Variable(), Number(int(bound)))) if slot >= 0:

            def above(frame: Frame) -> bool:
                value = frame[slot]
                return value > bound if value.__class__ is int else holds(frame)

            return Test(setting, above)
        case ("LST", (Variable(), Number(int(bound)))) if slot >= 0:

            def below(frame: Frame) -> bool:
                value = frame[slot]
                return value < bound if value.__class__ is int else holds(frame)

            return Test(setting, below)
        case _:
            return Test(setting, holds)


LEAVES: Mapping[str, Callable[[Setting, Ports], Instruction]] = MappingProxyType(
    {
        "GTR": lambda setting, ports: _test(setting),
        "LST": lambda setting, ports: _test(setting),
        "Equal": lambda setting, ports: _test(setting),
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
