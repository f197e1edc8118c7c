"""Work that can be interrupted: a generator that yields after every unit of it and returns what it came to.

Perceptions arrive while the planner thinks. A step of the planner does at most so many units, then it listens;
the rest is done in the steps that follow, or given up if what was perceived makes it useless. A unit is one
choice of the search, one group repeated, one step looked after: some tens of microseconds, whatever the size
of the domain.
"""

from __future__ import annotations

from collections.abc import Generator
from typing import TypeAlias, TypeVar

_T = TypeVar("_T")
Work: TypeAlias = Generator[None, None, _T]


def advance(work: Work[_T], units: int) -> tuple[_T | None, int]:
    """Do at most so many units: what the work came to if it is done, else None, and the units that are left."""
    try:
        while units > 0:
            units -= 1
            next(work)
    except StopIteration as done:
        result: _T = done.value
        return result, units
    return None, 0


def finish(work: Work[_T]) -> _T:
    """Do all of it."""
    while True:
        try:
            next(work)
        except StopIteration as done:
            result: _T = done.value
            return result
