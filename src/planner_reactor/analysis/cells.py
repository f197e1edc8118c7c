"""Cells: parts of a configuration that share neither situations nor labels, compiled to integer states.

A cell holds some of the parts that stand side by side at the top of the roots, and the store of its own situations. Its
states are numbered as they are met; what it can do from each is worked out once through `rs.evolves`, and is integers
from then on: steps of its own, values that it offers at a port, values that it would take there, the passing of time.
Cells meet at ports and in time only (`networks`).

A root that is split over several cells ends when all its parts have; until then a part that never ends keeps it alive
in each. What its end would change in a store (inhibitions that it holds) would connect the cells: `Entangled`.
"""

from __future__ import annotations

from math import inf
from typing import TypeAlias

from planner_reactor.analysis.explore import boundaries, canonical
from planner_reactor.errors import BudgetError, PlannerReactorError
from planner_reactor.rs.configurations import Config, Label, World
from planner_reactor.rs.evolves import settle
from planner_reactor.rs.leaves import elapsed, offers, slack
from planner_reactor.rs.states import Ended, Group, InstanceNumber, Leaf, Run, Spot, bind
from planner_reactor.rs.terms import Value

Step: TypeAlias = tuple[Label, int, bool]
"""(label, next state of the cell, does it not let time pass)."""

ALIVE = Leaf("NIL")
"""The part that keeps a split root from ending in one cell."""


class Entangled(PlannerReactorError):
    """These cells are not as independent as their texts look; they have to be taken as one."""


class Cell:
    """One cell and the states met so far; 0 is its first.

    `start` holds the roots that have parts here, `split` those that have parts elsewhere too. Raises `BudgetError`
    above `limit` states, `Entangled` where another cell would have to know.
    """

    def __init__(self, start: Config, world: World, *, split: frozenset[int] = frozenset(), limit: int) -> None:
        self.configs: list[Config] = []
        self._numbers: dict[Config, int] = {}
        self._world = world
        self._split = split
        self._limit = limit
        self._steps: dict[int, tuple[Step, ...]] = {}
        self._offers: dict[int, tuple[tuple[Value, Value, int], ...]] = {}
        self._readers: dict[int, tuple[tuple[Value, Spot], ...]] = {}
        self._takes: dict[tuple[int, Value, Value], tuple[int, ...]] = {}
        self._pauses: dict[int, float] = {}
        self._later: dict[tuple[int, float], int] = {}
        self.number(start)

    def __len__(self) -> int:
        return len(self.configs)

    def number(self, config: Config) -> int:
        """The state that this configuration is."""
        config = canonical(config)
        found = self._numbers.setdefault(config, len(self.configs))
        if found == len(self.configs):
            if found >= self._limit:
                raise BudgetError("states", f"more than {self._limit} states of one cell")
            self._separate(config)
            self.configs.append(config)
        return found

    def _separate(self, config: Config) -> None:
        for root in self._split:
            if self._is_over(config.root(root)) and config.store.root_ended(root) != config.store:
                raise Entangled(f"root {root} holds an inhibition when its part here ends")

    # -- what it can do by itself

    def steps(self, state: int) -> tuple[Step, ...]:
        """The steps that need no other cell."""
        if (found := self._steps.get(state)) is None:
            config, world = self.configs[state], self._world
            found = self._steps[state] = tuple(
                (offer.label, self.number(offer.taken(config, world)), offer.urgent) for offer in offers(config, world)
            )
        return found

    def pause(self, state: int) -> float:
        """Seconds to the next end of an age window; inf if there is none."""
        if (found := self._pauses.get(state)) is None:
            config = self.configs[state]
            ahead = min((d for d in boundaries(config, self._world) if d > 0), default=inf)
            found = self._pauses[state] = min(ahead, slack(config, self._world))
        return found

    def later(self, state: int, seconds: float) -> int:
        """The state after so many seconds in which nothing happened."""
        if (found := self._later.get((state, seconds))) is None:
            after = self.number(elapsed(self.configs[state], seconds, self._world))
            found = self._later[state, seconds] = after
        return found

    # -- what it can do with another

    def offered(self, state: int) -> tuple[tuple[Value, Value, int], ...]:
        """(port, value, next state) of everything that it would write to another cell."""
        if (found := self._offers.get(state)) is None:
            config = self.configs[state]
            given = []
            for spot in config.spots():
                leaf = spot.leaf
                if isinstance(leaf, Leaf) and leaf.name == "OUT" and not leaf.problem:
                    port, value = leaf.arguments
                    given.append((port, value, self._continued(config, spot, Ended(True))))
            found = self._offers[state] = tuple(given)
        return found

    def ports_read(self, state: int) -> tuple[Value, ...]:
        """The ports at which it would take a value, each once."""
        return tuple(dict.fromkeys(port for port, _ in self._reading(state)))

    def taken(self, state: int, port: Value, value: Value) -> tuple[int, ...]:
        """The next states if another cell writes this value, one for each reader."""
        if (found := self._takes.get((state, port, value))) is None:
            if isinstance(value, InstanceNumber):
                raise Entangled(f"port {port} carries the number of an instance")
            config = self.configs[state]
            after = []
            for at, spot in self._reading(state):
                if at == port:
                    assert isinstance(spot.leaf, Leaf)
                    results = bind(tuple(zip(spot.leaf.results, (value,), strict=False)))
                    after.append(self._continued(config, spot, Ended(True, results)))
            found = self._takes[state, port, value] = tuple(after)
        return found

    def _reading(self, state: int) -> tuple[tuple[Value, Spot], ...]:
        if (found := self._readers.get(state)) is None:
            found = self._readers[state] = tuple(
                (spot.leaf.arguments[0], spot)
                for spot in self.configs[state].spots()
                if isinstance(spot.leaf, Leaf) and spot.leaf.name == "IN" and not spot.leaf.problem
            )
        return found

    def _continued(self, config: Config, spot: Spot, ended: Ended) -> int:
        return self.number(settle(config.put(spot, ended), self._world))

    # -- how it ends

    def over(self, state: int) -> bool:
        """Has everything here ended?"""
        return all(
            self._is_over(term) if root in self._split else isinstance(term, Ended)
            for root, term in self.configs[state].roots
        )

    def is_over(self, state: int, root: int) -> bool:
        """Have all parts of a split root ended that are here?"""
        return self._is_over(self.configs[state].root(root))

    @staticmethod
    def _is_over(term: Run) -> bool:
        return all(isinstance(part, Ended) for part in _parts(term))


def kept_alive(parts: tuple[Run, ...]) -> Run:
    """Parts of a split root as a term that does not end before the others do."""
    return Group("|", (*parts, ALIVE))


def _parts(term: Run) -> tuple[Run, ...]:
    assert isinstance(term, Group)
    return term.parts[:-1]

