"""Runs that go round: is there a fair run of a system that an automaton accepts, and which is the shortest?

A run of system and automaton side by side is accepted if it comes back to where it was and on the way round fulfils
every acceptance bit and is fair. Components of the product in which that is possible are found by Tarjan's algorithm;
for strong fairness states at which something is possible that is never done there are taken out, and what is left is
searched again (Emerson and Lei). The lasso is then the one with the fewest steps, prefix and cycle together.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterable, Sequence

import msgspec

from planner_reactor.analysis.systems import Move, System
from planner_reactor.analysis.tableau import Automaton
from planner_reactor.errors import BudgetError
from planner_reactor.rs.configurations import Label

NODES = 2_000_000
"""Pairs of a state of the system and one of the automaton that are visited at most."""

ANYHOW: Label = ("", (), "anyhow", ())
"""Stands for whatever follows when nothing is asked of it any more; fair runs go on from everywhere."""

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


class Justice(msgspec.Struct, frozen=True):
    """Fairness as bits: each kind of step has one. `kind` numbers a label (-1: nothing is asked of it)."""

    kind: Callable[[Label], int]
    weak: int = 0
    strong: int = 0


class Arc(msgspec.Struct, frozen=True):
    """A step of system and automaton together."""

    after: int
    move: Move
    kept: int
    taken: int


class Product(msgspec.Struct, frozen=True):
    """The part of system × automaton that can be reached; node 0 is first, `depth[n]` the steps to node n."""

    nodes: Sequence[tuple[int, int]]
    arcs: Sequence[tuple[Arc, ...]]
    depth: Sequence[int]
    before: Sequence[tuple[int, Move] | None]
    possible: Sequence[int]  # the kinds of steps that are possible at each node


def product(system: System, automaton: Automaton, justice: Justice) -> Product:
    """System and automaton side by side, breadth first. `BudgetError` above `NODES` pairs."""
    kinds: dict[Label, int] = {}
    possible, taken = [], []
    for moves in system.moves:
        bits = [_bit(kinds.setdefault(m.label, justice.kind(m.label))) for m in moves]
        taken.append(bits or [0])
        possible.append(_union(bits))
    nodes = [(0, 0)]
    numbers = {nodes[0]: 0}
    arcs: list[tuple[Arc, ...]] = []
    depth, before = [0], [None]  # type: tuple[list[int], list[tuple[int, Move] | None]]
    by_node: list[int] = []
    for here, (state, duties) in enumerate(nodes):  # grows while it is read
        found = []
        if duties == automaton.free:
            arcs.append((Arc(here, Move(ANYHOW, state, False, 0), automaton.all_kept, 0),))
            by_node.append(0)
            continue
        by_node.append(possible[state] if state < len(possible) else 0)
        for move, bit in zip(system.leaving(state), taken[state] if state < len(taken) else (), strict=False):
            for edge in automaton.edges[duties]:
                if not edge.reads(move.seen):
                    continue
                node = (move.after, edge.after)
                if (number := numbers.setdefault(node, len(nodes))) == len(nodes):
                    if number >= NODES:
                        raise BudgetError("states", f"more than {NODES} states of program and property together")
                    nodes.append(node)
                    depth.append(depth[here] + 1)
                    before.append((here, move))
                found.append(Arc(number, move, edge.kept, bit))
        arcs.append(tuple(found))
    return Product(nodes, arcs, depth, before, by_node)


def _bit(kind: int) -> int:
    return 1 << kind if kind >= 0 else 0


def _union(bits: Iterable[int]) -> int:
    total = 0
    for bit in bits:
        total |= bit
    return total


def accepted(system: System, automaton: Automaton, justice: Justice) -> Lasso | None:
    """The shortest fair run of the system that the automaton accepts, or None if there is none."""
    both = product(system, automaton, justice)
    components = list(_fair(both, automaton.all_kept, justice))
    if not components:
        return None
    search = _Shortest(both, automaton.all_kept, justice)
    for component in components:
        search.within(component)
    assert search.best is not None
    return search.lasso()


# --------------------------------------------------------------------------------------- components that are fair


def _fair(both: Product, all_kept: int, justice: Justice) -> Iterable[frozenset[int]]:
    waiting = [frozenset(range(len(both.nodes)))]
    while waiting:
        for component in components(both.arcs, waiting.pop()):
            inner = [arc for node in component for arc in both.arcs[node] if arc.after in component]
            taken = _union(arc.taken for arc in inner)
            if not inner or _union(arc.kept for arc in inner) != all_kept:
                continue
            always = justice.weak
            for node in component:
                always &= both.possible[node]
            if always & ~taken:
                continue
            missed = _union(both.possible[node] for node in component) & justice.strong & ~taken
            if not missed:
                yield component
            else:
                waiting.append(frozenset(n for n in component if not both.possible[n] & missed))


def components(arcs: Sequence[Sequence[Arc]], within: frozenset[int]) -> list[frozenset[int]]:
    """The strongly connected components of a part of a graph (Tarjan), without recursion."""
    found: list[frozenset[int]] = []
    index: dict[int, int] = {}
    low: dict[int, int] = {}
    stack: list[int] = []
    on_stack: set[int] = set()
    for root in sorted(within):
        if root in index:
            continue
        work = [(root, iter(arcs[root]))]
        while work:
            node, rest = work[-1]
            if node not in index:
                index[node] = low[node] = len(index)
                stack.append(node)
                on_stack.add(node)
            for arc in rest:
                if arc.after not in within:
                    continue
                if arc.after not in index:
                    work.append((arc.after, iter(arcs[arc.after])))
                    break
                if arc.after in on_stack:
                    low[node] = min(low[node], index[arc.after])
            else:
                work.pop()
                if work:
                    low[work[-1][0]] = min(low[work[-1][0]], low[node])
                if low[node] == index[node]:
                    found.append(_popped(stack, on_stack, node))
    return found


def _popped(stack: list[int], on_stack: set[int], node: int) -> frozenset[int]:
    component = set()
    while node not in component:
        last = stack.pop()
        on_stack.discard(last)
        component.add(last)
    return frozenset(component)


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
