"""What can go wrong in a transition system, each with a shortest way to it.

    deadlock    nothing can happen any more, though something has not ended
    Zeno        a cycle along which time never gets its turn: in each of its states something is urgent
    livelock    from here on nothing but steps inside the program: no basic process ends, no time passes, nothing ends
    endless     a situation is active, and can never come to rest again

A `Lasso` is a path and the cycle that follows it; states are numbered breadth first, so the first culprit is a
nearest one.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Collection

from planner_reactor.analysis.lassos import Lasso
from planner_reactor.analysis.partitions import components
from planner_reactor.analysis.transitions import Transitions
from planner_reactor.rs.configurations import Label
from planner_reactor.rs.vocabulary import BUILT_IN

PASSING = frozenset({"TIME", "Delay", "SUSPEND", "Term", "REPORT"})
"""What a program shows by built-in processes: that time passes, or what it says."""


def is_progress(label: Label) -> bool:
    """Does the world notice this step: a basic process has ended, time has passed, something was reported?"""
    return label[0] in PASSING or not (label[0] in BUILT_IN or label[0] == "COM")


def deadlock(found: Transitions) -> Lasso | None:
    """A shortest way to where nothing can happen though something has not ended."""
    state = min(found.deadlocks, default=None)
    return None if state is None else Lasso(found.path(state), ())


def zeno(found: Transitions) -> Lasso | None:
    """A shortest way into a cycle that keeps time from passing."""
    hurried = [n for n, urgent in enumerate(found.urgent) if urgent]
    return _lasso(found, set(hurried))


def livelock(found: Transitions, progress: Callable[[Label], bool] = is_progress) -> Lasso | None:
    """A shortest way to where no progress can be made any more though steps go on for ever."""
    good = [n for n, moves in enumerate(found.moves) if not moves or any(progress(label) for label, _ in moves)]
    return _lasso(found, set(range(len(found))) - found.reaching(good))


def endless(found: Transitions, situation: str) -> Lasso | None:
    """A shortest way to where the situation is active and can never be at rest again."""
    active = [found.network.active(vector, situation) for vector in found.vectors]
    at_rest = found.reaching(n for n, is_active in enumerate(active) if not is_active)
    state = next((n for n in range(len(found)) if n not in at_rest), None)
    return None if state is None else Lasso(found.path(state), ())


def _lasso(found: Transitions, inside: Collection[int]) -> Lasso | None:
    """The nearest state on a cycle within these states, and a shortest such cycle."""
    after = [[s for _, s in moves if s in inside] if n in inside else [] for n, moves in enumerate(found.moves)]
    on_cycles = [(min(members), members) for members, loops in components(after) if loops]
    if not on_cycles:
        return None
    state, members = min(on_cycles)
    return Lasso(found.path(state), _cycle(found, state, set(members)))


def _cycle(found: Transitions, start: int, inside: Collection[int]) -> tuple[Label, ...]:
    came: dict[int, tuple[int, Label]] = {}
    waiting = deque([start])
    while waiting:
        here = waiting.popleft()
        for label, after in found.moves[here]:
            if after == start:
                labels = [label]
                while here != start:
                    here, label = came[here]
                    labels.append(label)
                return tuple(reversed(labels))
            if after in inside and after not in came:
                came[after] = here, label
                waiting.append(after)
    raise AssertionError("no cycle in a component that has one")
