"""Labelled transition systems: everything that a program can do, as states and labelled moves between them.

`build` reaches every state of a configuration under `rs.evolves`, breadth first, so that a path is a shortest one.
States that differ only in the numbers of situation instances are one state. Time passes from one end of an age window
to the next. A `Transitions` is what reduction, comparison, export and properties stand on.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import TypeAlias

from planner_reactor.analysis.explore import canonical, successors
from planner_reactor.errors import BudgetError
from planner_reactor.rs.configurations import Config, Label, World
from planner_reactor.rs.states import Bindings, Ended

LIMIT = 200_000
"""States that are built unless a caller says otherwise."""

Move: TypeAlias = tuple[Label, int]
Outcome: TypeAlias = tuple[bool, Bindings] | None
"""How a root has ended: did it stop, with which results; None while it runs."""


class Transitions:
    """States 0, 1, … in the order of a shortest way to them; 0 is the first.

    `moves[i]` are the (label, next state) pairs of state i, `states[i]` is its configuration, `came_from[i]` the state
    and the label by which it was found.
    """

    complete = True

    def __init__(
        self,
        states: Sequence[Config],
        moves: Sequence[tuple[Move, ...]],
        came_from: Sequence[tuple[int, Label] | None],
    ) -> None:
        self.states = states
        self.moves = moves
        self.came_from = came_from

    def __len__(self) -> int:
        return len(self.moves)

    def __repr__(self) -> str:
        return f"Transitions({len(self)} states, {self.size} transitions, {len(self.deadlocks)} deadlocks)"

    @property
    def size(self) -> int:
        """How many transitions there are."""
        return sum(map(len, self.moves))

    @property
    def labels(self) -> tuple[Label, ...]:
        """Every label, in the order of its first use."""
        return tuple(dict.fromkeys(label for moves in self.moves for label, _ in moves))

    @property
    def ends(self) -> tuple[int, ...]:
        """The states that nothing leaves: all has ended, or nothing can go on."""
        return tuple(n for n, moves in enumerate(self.moves) if not moves)

    @property
    def deadlocks(self) -> tuple[int, ...]:
        """The states that nothing leaves though a root has not ended."""
        return tuple(n for n in self.ends if None in self.outcomes(n))

    def outcomes(self, state: int) -> tuple[Outcome, ...]:
        """How each root has ended in this state."""
        return tuple(_outcome(term) for _, term in self.states[state].roots)

    def path(self, state: int) -> tuple[Label, ...]:
        """The labels of a shortest way from the first state."""
        labels: list[Label] = []
        while (step := self.came_from[state]) is not None:
            state, label = step
            labels.append(label)
        return tuple(reversed(labels))

    def reaching(self, goal: Iterable[int]) -> set[int]:
        """The states from which one of these can be reached."""
        before: dict[int, list[int]] = {}
        for n, moves in enumerate(self.moves):
            for _, after in moves:
                before.setdefault(after, []).append(n)
        found = set(goal)
        waiting = list(found)
        while waiting:
            for n in before.get(waiting.pop(), ()):
                if n not in found:
                    found.add(n)
                    waiting.append(n)
        return found

    def trapped(self, goal: Callable[[Config], bool]) -> int | None:
        """The first state from which no state with the goal can be reached any more, or None."""
        reaching = self.reaching(n for n, state in enumerate(self.states) if goal(state))
        return next((n for n in range(len(self)) if n not in reaching), None)


def _outcome(term: object) -> Outcome:
    return (term.ok, term.bindings) if isinstance(term, Ended) else None


def build(config: Config, world: World, *, limit: int = LIMIT) -> Transitions:
    """The transition system of a configuration. Raises `BudgetError` above `limit` states."""
    states = [canonical(config)]
    numbers = {states[0]: 0}
    came_from: list[tuple[int, Label] | None] = [None]
    moves: list[tuple[Move, ...]] = []
    for here, state in enumerate(states):  # grows while it is read
        found = []
        for step in successors(state, world):
            after = canonical(step.after)
            if (number := numbers.setdefault(after, len(states))) == len(states):
                if number >= limit:
                    raise BudgetError("states", f"more than {limit} states")
                states.append(after)
                came_from.append((here, step.label))
            found.append((step.label, number))
        moves.append(tuple(found))
    return Transitions(states, moves, came_from)
