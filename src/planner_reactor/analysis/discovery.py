"""States as a breadth-first search meets them: 0, 1, … in that order, each with the step that met it first.

Because of the order, the steps that met the states first make up a shortest way to each. What the states are, and which
steps there are, is the caller's: configurations, vectors of integers, pairs with the state of an automaton.
"""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from typing import Generic, TypeAlias, TypeVar

from planner_reactor.rs.configurations import Label

S = TypeVar("S", bound=Hashable)

Origins: TypeAlias = Sequence[tuple[int, Label] | None]
"""For each state the one from which it was met first, and by which step; None for state 0."""


class Discovery(Generic[S]):
    """The states met so far. `states` may be read by a loop while it grows."""

    __slots__ = ("_numbers", "origins", "states")

    def __init__(self, start: S) -> None:
        self.states = [start]
        self.origins: list[tuple[int, Label] | None] = [None]
        self._numbers = {start: 0}

    def __len__(self) -> int:
        return len(self.states)

    def number(self, state: S, here: int, label: Label) -> int:
        """The number of the state to which a step leads from state `here`: a new one if it was never met."""
        number = self._numbers.setdefault(state, len(self.states))
        if number == len(self.states):
            self.states.append(state)
            self.origins.append((here, label))
        return number


def path(origins: Origins, state: int) -> tuple[Label, ...]:
    """The labels of a shortest way from state 0."""
    labels: list[Label] = []
    while (step := origins[state]) is not None:
        state, label = step
        labels.append(label)
    return tuple(reversed(labels))
