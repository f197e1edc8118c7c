"""A case that fails, with fewer faults: delta debugging over its fault list (Zeller and Hildebrandt 2002, ddmin)."""

from __future__ import annotations

from collections.abc import Callable

from msgspec.structs import replace

from planner_reactor.simulation.cases import Case, Fault


def shrunk(case: Case, fails: Callable[[Case], bool], *, tries: int = 200) -> Case:
    """A case with a fault list of which nothing can be left out, as far as so many tries show it."""
    left = tries

    def still(faults: tuple[Fault, ...]) -> bool:
        nonlocal left
        left -= 1
        return left >= 0 and fails(replace(case, faults=faults))

    faults, parts = case.faults, 2
    if faults and still(()):
        return replace(case, faults=())
    while len(faults) >= 2 and left > 0:
        size = -(-len(faults) // parts)
        without = [faults[:n] + faults[n + size :] for n in range(0, len(faults), size)]
        smaller = next((rest for rest in without if still(rest)), None)
        if smaller is not None:
            faults, parts = smaller, max(2, parts - 1)
        elif parts >= len(faults):
            break
        else:
            parts = min(len(faults), 2 * parts)
    return replace(case, faults=faults)
