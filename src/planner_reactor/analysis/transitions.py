"""Labelled transition systems: everything that a program can do, as states and labelled moves between them.

`build` reaches every state of a configuration, breadth first, so that a path is a shortest one. States are vectors of
integers, compiled from `rs.evolves` (`networks`); configurations are made again when one is looked at. States that
differ only in the numbers of situation instances are one state. Time passes from one end of an age window to the next.
A `Transitions` is what reduction, comparison, export and properties stand on.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import TypeAlias, overload

from planner_reactor.analysis.cells import Entangled
from planner_reactor.analysis.components import reaching
from planner_reactor.analysis.discovery import Discovery, Origins, path
from planner_reactor.analysis.networks import Network, Vector, networked, whole
from planner_reactor.errors import BudgetError
from planner_reactor.rs.configurations import Config, Label, World
from planner_reactor.rs.states import Bindings

LIMIT = 200_000
"""States that are built unless a caller says otherwise."""

Move: TypeAlias = tuple[Label, int]
Outcome: TypeAlias = tuple[bool, Bindings] | None
"""How a root has ended: did it stop, with which results; None while it runs."""


class Configurations(Sequence[Config]):
    """The configurations behind vectors of a network, each made when it is asked for."""

    def __init__(self, network: Network, vectors: Sequence[Vector]) -> None:
        self._network = network
        self._vectors = vectors

    def __len__(self) -> int:
        return len(self._vectors)

    @overload
    def __getitem__(self, index: int) -> Config: ...
    @overload
    def __getitem__(self, index: slice) -> Configurations: ...
    def __getitem__(self, index: int | slice) -> Config | Configurations:
        if isinstance(index, slice):
            return Configurations(self._network, self._vectors[index])
        return self._network.decoded(self._vectors[index])


class Transitions:
    """States 0, 1, … in the order of a shortest way to them; 0 is the first.

    `moves[i]` are the (label, next state) pairs of state i, `states[i]` is its configuration, `origins[i]` the state
    and the label by which it was met. `urgent[i]` has a bit for each move that does not let time pass before it.
    """

    complete = True

    def __init__(
        self,
        network: Network,
        vectors: Sequence[Vector],
        moves: Sequence[tuple[Move, ...]],
        urgent: Sequence[int],
        origins: Origins,
    ) -> None:
        self.network = network
        self.vectors = vectors
        self.states: Sequence[Config] = Configurations(network, vectors)
        self.moves = moves
        self.urgent = urgent
        self.origins = origins

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
        return tuple(n for n in self.ends if not self.network.over(self.vectors[n]))

    def outcomes(self, state: int) -> tuple[Outcome, ...]:
        """How each root has ended in this state."""
        return tuple(self.network.outcome(self.vectors[state], root) for root, _ in self.network.config.roots)

    def path(self, state: int) -> tuple[Label, ...]:
        """The labels of a shortest way from the first state."""
        return path(self.origins, state)

    def reaching(self, goal: Iterable[int]) -> set[int]:
        """The states from which one of these can be reached."""
        return reaching(([after for _, after in moves] for moves in self.moves), goal)

    def trapped(self, goal: Callable[[Config], bool]) -> int | None:
        """The first state from which no state with the goal can be reached any more, or None."""
        found = self.reaching(n for n, state in enumerate(self.states) if goal(state))
        return next((n for n in range(len(self)) if n not in found), None)


def build(config: Config, world: World, *, limit: int = LIMIT) -> Transitions:
    """The transition system of a configuration. Raises `BudgetError` above `limit` states."""
    try:
        return built(networked(config, world, limit=limit), limit=limit)
    except Entangled:
        return built(whole(config, world, limit=limit), limit=limit)


def built(network: Network, *, limit: int = LIMIT) -> Transitions:
    """The transition system of a network. Raises `BudgetError` above `limit` states, or `Entangled`."""
    met = Discovery(network.start)
    moves: list[tuple[Move, ...]] = []
    urgent: list[int] = []
    for here, vector in enumerate(met.states):  # grows while it is read
        found: list[Move] = []
        hurries = 0
        for label, after, in_a_hurry in network.steps(vector):
            if (number := met.number(after, here, label)) >= limit:
                raise BudgetError("states", f"more than {limit} states")
            hurries |= in_a_hurry << len(found)
            found.append((label, number))
        moves.append(tuple(found))
        urgent.append(hurries)
    return Transitions(network, met.states, moves, urgent, met.origins)
