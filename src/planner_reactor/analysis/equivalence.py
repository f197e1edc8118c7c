"""When two processes are the same: bisimilarity with outcomes, strong, or branching with some labels hidden.

Two processes are equal if they offer the same labels (passing time included) into equal states, and end alike: with
the same outcome and, if `bindings` are visible, the same results. Algebraic laws (docs/language.md, Laws) are claims of
this kind. Causes of aborts and where a term stood in the text are not seen. `partitions` does the work.

Branching bisimilarity hides labels that nobody outside sees, such as rendezvous at a local port; a process that can go
on for ever by itself is told from one that cannot (divergence).
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence

import msgspec

from planner_reactor.analysis.partitions import branching, quotient, strong
from planner_reactor.analysis.transitions import Transitions, build
from planner_reactor.rs.configurations import Label, World
from planner_reactor.rs.evolves import started
from planner_reactor.rs.terms import Process, Value

LIMIT = 5_000
"""States that one side of a comparison may have, unless a caller says otherwise."""


HIDDEN: Label = ("hidden", (), "ok", ())
"""What is left of a label that nobody outside sees."""


class Behaviour(msgspec.Struct, frozen=True):
    """A finite labelled transition system: `moves[i]` are the (label, state) pairs of state i; 0 is the first."""

    moves: tuple[tuple[tuple[Label, int], ...], ...]
    ends: tuple[Hashable, ...]


def behaviour(process: Process, world: World, *, bindings: bool = False, limit: int = LIMIT) -> Behaviour:
    """The transition system of a process; `BudgetError` above `limit` states."""
    return seen(build(started(process, world), world, limit=limit), bindings=bindings)


def seen(transitions: Transitions, *, bindings: bool = False) -> Behaviour:
    """What an observer sees of a transition system: its moves, and how its last root has ended."""
    ends: list[Hashable] = []
    for state in range(len(transitions)):
        outcome = transitions.outcomes(state)[-1]
        ends.append(outcome if bindings or outcome is None else outcome[0])
    return Behaviour(tuple(transitions.moves), tuple(ends))


def bisimilar(p: Process, q: Process, world: World, *, bindings: bool = False, limit: int = LIMIT) -> bool:
    """Are the two processes strongly bisimilar, outcomes included?"""
    return same(*(behaviour(each, world, bindings=bindings, limit=limit) for each in (p, q)))


def branching_bisimilar(
    p: Process,
    q: Process,
    world: World,
    *,
    hidden: Callable[[Label], bool],
    bindings: bool = False,
    limit: int = LIMIT,
) -> bool:
    """Are the two processes branching bisimilar with divergence, if nobody sees the labels that are `hidden`?"""
    return same(*(behaviour(each, world, bindings=bindings, limit=limit) for each in (p, q)), hidden=hidden)


def same(left: Behaviour, right: Behaviour, *, hidden: Callable[[Label], bool] | None = None) -> bool:
    """Are the first states bisimilar: strongly, or branching if some labels are hidden?"""
    shift = len(left.moves)
    moves = [*left.moves, *(tuple((label, s + shift) for label, s in m) for m in right.moves)]
    classes = classified(moves, [*left.ends, *right.ends], hidden)
    return classes[0] == classes[shift]


def reduced(whole: Behaviour, *, hidden: Callable[[Label], bool] | None = None) -> Behaviour:
    """The least transition system that is bisimilar: strongly, or branching if some labels are `HIDDEN`."""
    moves, unseen = whole.moves, None
    if hidden is not None:
        moves = tuple(tuple((HIDDEN if hidden(label) else label, s) for label, s in m) for m in moves)
        unseen = HIDDEN.__eq__
    classes = classified(moves, whole.ends, unseen)
    ends: list[Hashable] = [None] * (max(classes) + 1)
    for state, c in enumerate(classes):
        ends[c] = ends[c] if whole.ends[state] is None else whole.ends[state]
    return Behaviour(tuple(map(tuple, quotient(moves, classes, unseen))), tuple(ends))


def classified(
    moves: Sequence[Sequence[tuple[Label, int]]], ends: Sequence[Hashable], hidden: Callable[[Label], bool] | None
) -> list[int]:
    """The class of each state, numbered in order of their first state."""
    return strong(moves, ends) if hidden is None else branching(moves, ends, hidden)


def at_ports(*ports: Value) -> Callable[[Label], bool]:
    """Hides rendezvous at these ports."""
    return lambda label: label[0] == "COM" and label[1][0] in ports
