"""When two processes are the same: strong bisimilarity with outcomes, by partition refinement.

Two processes are equal if they offer the same labels (passing time included) into equal states, and end alike: with
the same outcome and, if `bindings` are visible, the same results. Algebraic laws (docs/language.md, Laws) are claims of
this kind. Causes of aborts and where a term stood in the text are not seen.
"""

from __future__ import annotations

from collections.abc import Hashable

import msgspec

from planner_reactor.analysis.explore import canonical, successors
from planner_reactor.errors import BudgetError
from planner_reactor.rs.configurations import Config, Label, World
from planner_reactor.rs.evolves import started
from planner_reactor.rs.states import Ended
from planner_reactor.rs.terms import Process


class Behaviour(msgspec.Struct, frozen=True):
    """A finite labelled transition system: `moves[i]` are the (label, state) pairs of state i; 0 is the first."""

    moves: tuple[tuple[tuple[Label, int], ...], ...]
    ends: tuple[Hashable, ...]


def behaviour(process: Process, world: World, *, bindings: bool = False, limit: int = 5_000) -> Behaviour:
    """The transition system of a process; `BudgetError` above `limit` states."""
    first = canonical(started(process, world))
    numbers = {first: 0}
    waiting = [first]
    moves: list[tuple[tuple[Label, int], ...]] = []
    for state in waiting:  # grows while it is read
        found = []
        for step in successors(state, world):
            after = canonical(step.after)
            if after not in numbers:
                if len(numbers) >= limit:
                    raise BudgetError("states", f"more than {limit} states")
                numbers[after] = len(numbers)
                waiting.append(after)
            found.append((step.label, numbers[after]))
        moves.append(tuple(found))
    return Behaviour(tuple(moves), tuple(_end(state, bindings) for state in waiting))


def _end(state: Config, bindings: bool) -> Hashable:
    (_, term) = state.roots[-1]
    if not isinstance(term, Ended):
        return None
    return (term.ok, term.bindings) if bindings else term.ok


def bisimilar(p: Process, q: Process, world: World, *, bindings: bool = False, limit: int = 5_000) -> bool:
    """Are the two processes strongly bisimilar, outcomes included?"""
    left = behaviour(p, world, bindings=bindings, limit=limit)
    right = behaviour(q, world, bindings=bindings, limit=limit)
    shift = len(left.moves)
    moves = [*left.moves, *(tuple((label, s + shift) for label, s in m) for m in right.moves)]
    classes = _refined(moves, [*left.ends, *right.ends])
    return classes[0] == classes[shift]


def _refined(moves: list[tuple[tuple[Label, int], ...]], ends: list[Hashable]) -> list[int]:
    """The coarsest partition of states that respects ends and moves, as a class number for each state."""
    classes = _numbered(ends)
    while True:
        signatures: list[Hashable] = [
            (classes[i], frozenset((label, classes[s]) for label, s in m)) for i, m in enumerate(moves)
        ]
        finer = _numbered(signatures)
        if max(finer) == max(classes):
            return classes
        classes = finer


def _numbered(keys: list[Hashable]) -> list[int]:
    numbers: dict[Hashable, int] = {}
    return [numbers.setdefault(key, len(numbers)) for key in keys]
