"""The behaviours of many terms at once: one transition system in which equal states are one.

Laws are checked on thousands of small terms whose later states are mostly the same; each is explored once, and one
refinement of the whole decides all of them. What is checked is what `analysis.equivalence` checks of two processes.
"""

from __future__ import annotations

from collections.abc import Hashable, Sequence

from planner_reactor.analysis.equivalence import at_ports
from planner_reactor.analysis.explore import canonical, successors
from planner_reactor.analysis.partitions import branching, strong
from planner_reactor.rs.configurations import Config, Label, World
from planner_reactor.rs.evolves import started
from planner_reactor.rs.states import Ended
from planner_reactor.rs.terms import Process

MOST = 400
"""States that one term may have; larger ones are passed over."""


class TooLarge(Exception):
    """A term with more states than we look at."""


class Universe:
    """Every state of every term that was asked for."""

    def __init__(self, world: World) -> None:
        self._world = world
        self._numbers: dict[Config, int] = {}
        self._configs: list[Config] = []
        self.moves: list[tuple[tuple[Label, int], ...] | None] = []

    def first(self, process: Process) -> int:
        """The number of the first state of a process, all that it reaches being explored."""
        start = self._number(canonical(started(process, self._world)))
        seen, waiting = {start}, [start]
        for state in waiting:  # grows while it is read
            for _, after in self._explored(state):
                if after not in seen:
                    seen.add(after)
                    waiting.append(after)
            if len(seen) > MOST:
                raise TooLarge
        return start

    def _explored(self, state: int) -> tuple[tuple[Label, int], ...]:
        moves = self.moves[state]
        if moves is None:
            found = successors(self._configs[state], self._world)
            moves = self.moves[state] = tuple((s.label, self._number(canonical(s.after))) for s in found)
        return moves

    def _number(self, config: Config) -> int:
        if (number := self._numbers.setdefault(config, len(self._configs))) == len(self._configs):
            self._configs.append(config)
            self.moves.append(None)
        return number

    def ends(self, *, bindings: bool) -> list[Hashable]:
        """How each state has ended, if it has."""
        terms = [config.roots[-1][1] for config in self._configs]
        return [(t.ok, t.bindings if bindings else ()) if isinstance(t, Ended) else None for t in terms]

    def classes(self, wanted: Sequence[int], *, bindings: bool = False, hidden: str = "") -> dict[int, int]:
        """The class of these states under strong bisimilarity, or branching with rendezvous at ports hidden."""
        states = self._reached(wanted)
        places = {state: n for n, state in enumerate(states)}
        moves = [[(label, places[s]) for label, s in self.moves[state] or ()] for state in states]
        known = self.ends(bindings=bindings)
        ends = [known[state] for state in states]
        found = branching(moves, ends, at_ports(*hidden)) if hidden else strong(moves, ends)
        return {state: found[places[state]] for state in wanted}

    def _reached(self, wanted: Sequence[int]) -> list[int]:
        states = list(dict.fromkeys(wanted))
        seen = set(states)
        for state in states:  # grows while it is read
            for _, after in self.moves[state] or ():
                if after not in seen:
                    seen.add(after)
                    states.append(after)
        return states

    def included(self, left: int, right: int, ends: list[Hashable]) -> bool:
        """Is each trace of `left`, with the end it leads to, one of `right`?"""
        first = (left, frozenset({right}))
        seen, waiting = {first}, [first]
        while waiting:
            here, others = waiting.pop()
            if ends[here] is not None and all(ends[o] != ends[here] for o in others):
                return False
            for label, after in self.moves[here] or ():
                fitting = self._after(others, label)
                if not fitting:
                    return False
                if after not in fitting and (after, fitting) not in seen:
                    seen.add((after, fitting))
                    waiting.append((after, fitting))
        return True

    def _after(self, states: frozenset[int], label: Label) -> frozenset[int]:
        return frozenset(s for o in states for lb, s in self.moves[o] or () if lb == label)

    def apart(self, left: int, right: int) -> tuple[tuple[Label, ...], str, str]:
        """A shortest run after which the two sides differ, and what can be said of each side there.

        Sides with the same runs and outcomes differ in a choice: then the run is empty.
        """
        ends = self.ends(bindings=False)
        waiting: list[tuple[frozenset[int], frozenset[int], tuple[Label, ...]]]
        waiting = [(frozenset({left}), frozenset({right}), ())]
        seen = {waiting[0][:2]}
        for ours, theirs, run in waiting:  # grows while it is read
            told = tuple(self._told(side, ends) for side in (ours, theirs))
            if told[0] != told[1]:
                return run, *told
            for label in sorted({lb for s in ours | theirs for lb, _ in self.moves[s] or ()}, key=str):
                after = (self._after(ours, label), self._after(theirs, label))
                if after not in seen:
                    seen.add(after)
                    waiting.append((*after, (*run, label)))
        return (), "the choice is made earlier", "later"

    def _told(self, states: frozenset[int], ends: Sequence[Hashable]) -> str:
        """What a side may be after a run: how it has ended, or that it runs, or that it has no such run."""
        names = {(True, ()): "stop", (False, ()): "abort"}
        told = {names.get(ends[s], "waits" if not self.moves[s] else "runs") for s in states}
        return " or ".join(sorted(told)) or "impossible"
