"""Runs that go round: is there a fair run of a system that an automaton accepts, and which is the shortest?

A run of system and automaton side by side is accepted if it comes back to where it was and on the way round fulfils
every acceptance bit and is fair. Components of the product in which that is possible are found by Tarjan's algorithm;
for strong fairness states at which something is possible that is never done there are taken out, and what is left is
searched again (Emerson and Lei). The lasso is then the one with the fewest steps, prefix and cycle together.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterable

import msgspec

from planner_reactor.analysis.products import ANYHOW, Arc, Justice, Product, components, product, union
from planner_reactor.analysis.systems import System
from planner_reactor.analysis.tableau import Automaton
from planner_reactor.rs.configurations import Label

EFFORT = 300_000
"""Steps spent on making a lasso shorter; beyond, the shortest found so far is taken."""


class Lasso(msgspec.Struct, frozen=True):
    """`prefix` leads to a state from which `cycle` leads back. An empty cycle: the run ends there, or, if `decided`, it
    does not matter how it goes on.

    `states` are the numbers of the states before each step, prefix and cycle (of the last state, if there is none).
    """

    prefix: tuple[Label, ...]
    cycle: tuple[Label, ...]
    states: tuple[int, ...] = ()
    decided: bool = False


def accepted(system: System, automaton: Automaton, justice: Justice) -> Lasso | None:
    """The shortest fair run of the system that the automaton accepts, or None if there is none."""
    both = product(system, automaton, justice)
    fair = list(_fair(both, automaton.all_kept, justice))
    if not fair:
        return None
    search = _Shortest(both, automaton.all_kept, justice)
    for component in fair:
        search.within(component)
    assert search.best is not None
    return search.lasso()


# --------------------------------------------------------------------------------------- components that are fair


def _fair(both: Product, all_kept: int, justice: Justice) -> Iterable[frozenset[int]]:
    waiting = [frozenset(range(len(both.nodes)))]
    while waiting:
        for component in components(both.arcs, waiting.pop()):
            inner = [arc for node in component for arc in both.arcs[node] if arc.after in component]
            taken = union(arc.taken for arc in inner)
            if not inner or union(arc.kept for arc in inner) != all_kept:
                continue
            always = justice.weak
            for node in component:
                always &= both.possible[node]
            if always & ~taken:
                continue
            missed = union(both.possible[node] for node in component) & justice.strong & ~taken
            if not missed:
                yield component
            else:
                waiting.append(frozenset(n for n in component if not both.possible[n] & missed))


# ------------------------------------------------------------------------------------------------- shortest lasso


class _Way(msgspec.Struct, frozen=True):
    """Where a way round is, and what it has done: the acceptance bits kept, the kinds of steps that were possible at
    every state so far and not taken, those possible somewhere and not taken yet, those taken.
    """

    node: int
    kept: int
    owed: int
    missed: int
    taken: int


class _Shortest:
    """The shortest accepted fair lasso through some components."""

    def __init__(self, both: Product, all_kept: int, justice: Justice) -> None:
        self._both = both
        self._all_kept = all_kept
        self._justice = justice
        self._effort = EFFORT
        self.best: tuple[int, int, list[Arc]] | None = None  # length, the node where the cycle begins, the cycle

    def within(self, component: frozenset[int]) -> None:
        nodes = sorted(component, key=lambda n: (self._both.depth[n], n))
        for node in nodes:
            if self.best is not None and (self._effort <= 0 or self._both.depth[node] + 1 >= self.best[0]):
                return
            cycle = self._round(node, component)
            if cycle is None and self.best is None:
                cycle = self._any_round(node, component)
            if cycle is not None and (length := self._both.depth[node] + len(cycle)) < (self.best or (1 << 60,))[0]:
                self.best = (length, node, cycle)

    def lasso(self) -> Lasso:
        assert self.best is not None
        _, node, cycle = self.best
        states, prefix = [], []
        at = node
        while (step := self._both.before[at]) is not None:
            at, move = step
            prefix.append(move.label)
            states.append(self._both.nodes[at][0])
        states.reverse()
        at = node
        for arc in cycle:
            states.append(self._both.nodes[at][0])
            at = arc.after
        run = list(zip([*reversed(prefix), *(arc.move.label for arc in cycle)], states, strict=True))
        begin = len(prefix)
        run = [*run[:begin], *_once(run[begin:])]
        while begin and run[begin - 1] == run[-1]:  # the same run, said with one step less
            begin -= 1
            run.pop()
        labels = tuple(label for label, _ in run)
        at_rest = labels[-1][2] in ("idle", "anyhow")
        states = [state for _, state in run]
        return Lasso(labels[:begin], () if at_rest else labels[begin:], tuple(states), labels[-1] == ANYHOW)

    def _round(self, start: int, component: frozenset[int]) -> list[Arc] | None:
        """The shortest fair way from a node back to it, breadth first; None if the effort is spent before."""
        first = self._began(start)
        before: dict[_Way, tuple[_Way, Arc] | None] = {first: None}
        waiting = deque([first])
        while waiting and self._effort > 0:
            way = waiting.popleft()
            for arc in self._both.arcs[way.node]:
                if arc.after not in component:
                    continue
                self._effort -= 1
                after = self._gone(way, arc)
                if arc.after == start and self._done(after):
                    return [*_back(before, way), arc]
                if after not in before:
                    before[after] = (way, arc)
                    waiting.append(after)
        return None

    def _began(self, node: int) -> _Way:
        possible = self._both.possible[node]
        return _Way(node, 0, possible & self._justice.weak, possible & self._justice.strong, 0)

    def _gone(self, way: _Way, arc: Arc) -> _Way:
        possible = self._both.possible[arc.after]
        taken = (way.taken | arc.taken) & self._justice.strong
        missed = (way.missed | possible & self._justice.strong) & ~taken
        return _Way(arc.after, way.kept | arc.kept, way.owed & possible & ~arc.taken, missed, taken)

    def _done(self, way: _Way) -> bool:
        return way.kept == self._all_kept and not way.owed and not way.missed

    def _any_round(self, start: int, component: frozenset[int]) -> list[Arc]:
        """A fair way from a node back to it, through every arc of the component that is needed, one after the other."""
        way, cycle = self._began(start), list[Arc]()
        while True:
            goal = self._lacking(way)
            if goal is None and cycle and way.node == start:
                return cycle
            for arc in self._path(way.node, component, start if goal is None else goal):
                way = self._gone(way, arc)
                cycle.append(arc)

    def _lacking(self, way: _Way) -> Callable[[Arc], bool] | None:
        if lacking := self._all_kept & ~way.kept:
            return lambda arc: bool(arc.kept & lacking)
        if way.missed:
            return lambda arc: bool(arc.taken & way.missed)
        if way.owed:
            return lambda arc: bool(arc.taken & way.owed or way.owed & ~self._both.possible[arc.after])
        return None

    def _path(self, start: int, component: frozenset[int], goal: Callable[[Arc], bool] | int) -> list[Arc]:
        """The shortest way to a node, or to the end of an arc with the property; at least one step."""
        before: dict[int, tuple[int, Arc]] = {}
        waiting = deque([start])
        while waiting:
            node = waiting.popleft()
            for arc in self._both.arcs[node]:
                if arc.after not in component:
                    continue
                if (arc.after == goal) if isinstance(goal, int) else goal(arc):
                    return [*_walked(before, start, node), arc]
                if arc.after not in before and arc.after != start:
                    before[arc.after] = (node, arc)
                    waiting.append(arc.after)
        raise AssertionError("a component is connected")


def _once(cycle: list[tuple[Label, int]]) -> list[tuple[Label, int]]:
    """A cycle that goes round several times (the automaton tells the rounds apart) once."""
    lengths = (n for n in range(1, len(cycle) + 1) if len(cycle) % n == 0)
    return next(cycle[:n] for n in lengths if cycle[:n] * (len(cycle) // n) == cycle)


def _back(before: dict[_Way, tuple[_Way, Arc] | None], way: _Way) -> list[Arc]:
    arcs = []
    while (step := before[way]) is not None:
        way, arc = step
        arcs.append(arc)
    return arcs[::-1]


def _walked(before: dict[int, tuple[int, Arc]], start: int, node: int) -> list[Arc]:
    arcs = []
    while node != start:
        node, arc = before[node]
        arcs.append(arc)
    return arcs[::-1]
