"""Can the improved one do at least what the old one did? Inclusion of traces, seen through a few atoms.

Of each step only the visible atoms that are true at it count; steps at which none is true are hidden. Every visible
trace of the old system has to be one of the new system: R §6.2 asks of every change of a reactor that it be "at least
as capable", and under which assumptions is said by the environment that both run beside. What the new one must *not*
do is the same question the other way round.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable

import msgspec

from planner_reactor.analysis.observing import EVENTS, Atom
from planner_reactor.analysis.systems import System
from planner_reactor.rs.configurations import Label

ENDINGS = ("ended", "stuck")
"""States that count as a visible step once they are reached: how it all ends."""


class Refinement(msgspec.Struct, frozen=True):
    """Does the new system have every visible trace of the old one? If not: a shortest run of the old one that it has
    not, step by step, and what is seen of it (the last is what the new one cannot do). None: not decided.
    """

    holds: bool | None
    run: tuple[Label, ...] = ()
    trace: tuple[tuple[Atom, ...], ...] = ()


def refines(new: System, old: System) -> Refinement:
    """Are the visible traces of `old` among those of `new`? Both must have been built with the same atoms, which are
    what is visible.
    """
    if old.atoms != new.atoms:
        raise ValueError("old and new must be seen through the same atoms")
    for atom in old.atoms:
        if atom.word not in EVENTS and atom.word not in ENDINGS:
            raise ValueError(f"{atom} is not a step: only what happens can be compared")
    first = (0, _closed(new, {0}))
    before: dict[tuple[int, frozenset[int]], tuple[tuple[int, frozenset[int]], Label, int] | None] = {first: None}
    waiting = deque([first])
    undecided = not old.complete
    while waiting:
        here = state, possible = waiting.popleft()
        undecided |= any(n >= len(new.moves) for n in possible)
        for move in old.leaving(state):
            allowed = _after(new, possible, move.seen) if move.seen else possible
            if not allowed:
                if any(n >= len(new.moves) for n in possible):
                    continue
                return _failed(old, before, here, move.label, move.seen)
            there = (move.after, allowed)
            if there not in before:
                before[there] = (here, move.label, move.seen)
                waiting.append(there)
    return Refinement(None if undecided else True)


def _after(new: System, states: Iterable[int], seen: int) -> frozenset[int]:
    """Where the new system may be after it showed this."""
    return _closed(new, {move.after for n in states for move in new.leaving(n) if move.seen == seen})


def _closed(new: System, states: set[int]) -> frozenset[int]:
    """With everything that hidden steps lead to."""
    waiting = sorted(states)
    while waiting:
        for move in new.leaving(waiting.pop()):
            if not move.seen and move.after not in states:
                states.add(move.after)
                waiting.append(move.after)
    return frozenset(states)


def _failed(
    old: System,
    before: dict[tuple[int, frozenset[int]], tuple[tuple[int, frozenset[int]], Label, int] | None],
    here: tuple[int, frozenset[int]],
    label: Label,
    seen: int,
) -> Refinement:
    steps = [(label, seen)]
    while (step := before[here]) is not None:
        here, label, seen = step
        steps.append((label, seen))
    steps.reverse()
    shown = tuple(tuple(a for n, a in enumerate(old.atoms) if seen >> n & 1) for _, seen in steps if seen)
    return Refinement(False, tuple(label for label, _ in steps if label[2] != "idle"), shown)
