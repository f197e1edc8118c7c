"""Partial-order reduction: of the orders in which independent cells move, only as many as are needed.

In each state a *stubborn set* of cells is expanded: nothing that the other cells do, now or later, can take part in a
move of these, because none of them will ever offer what these wait for. All deadlocks are kept (A. Valmari, Stubborn
sets for reduced state space generation, 1991; P. Godefroid, Partial-order methods, 1996, ch. 4). So that nobody is
put off for ever, each terminal component of the reduced graph expands whoever could move in it and did not (the cycle
proviso, in the form of A. Valmari, Stop it, and be stubborn!, 2015): then every state of every single cell is kept
too, and with it every verdict about one cell.
"""

from __future__ import annotations

from collections.abc import Iterator

import msgspec

from planner_reactor.analysis.automata import Automata, Automaton
from planner_reactor.analysis.networks import Vector
from planner_reactor.errors import BudgetError
from planner_reactor.rs.terms import Value


class Reduced(msgspec.Struct, frozen=True):
    """What was visited: every deadlock, and (with `fair`) every reachable state of every cell, `local[n]`."""

    states: int
    transitions: int
    deadlocks: tuple[Vector, ...]
    local: tuple[frozenset[int], ...]


def reduced(automata: Automata, *, fair: bool = True, limit: int = 1_000_000) -> Reduced:
    """A part of the composition that is enough. `fair=False` keeps deadlocks only. `BudgetError` above `limit`."""
    search = _Search(automata, fair, limit)
    search.run()
    local = tuple(frozenset(v[n] for v in search.seen) for n in range(len(automata.cells)))
    return Reduced(len(search.seen), search.transitions, tuple(search.deadlocks), local)


class _Node:
    """A state on the search's path: its moves still to be made, and the cells expanded so far."""

    __slots__ = ("exits", "expanded", "index", "low", "rest", "vector")

    def __init__(self, vector: Vector, index: int, cells: frozenset[int], rest: Iterator[Vector]) -> None:
        self.vector = vector
        self.index = self.low = index
        self.expanded = [cells]
        self.rest = rest
        self.exits = False


class _Search:
    """Depth first, with strongly connected components (R. Tarjan 1972) found on the way."""

    def __init__(self, automata: Automata, fair: bool, limit: int) -> None:
        self.automata = automata
        self.seen: dict[Vector, int] = {}
        self.transitions = 0
        self.deadlocks: list[Vector] = []
        self._fair = fair
        self._limit = limit
        self._open: list[_Node] = []  # nodes whose component is not complete
        self._waiting: dict[Vector, _Node] = {}
        self._writes_later = [_later(cell, [{(p, v) for p, v, _ in row} for row in cell.writes])
                              for cell in automata.cells]  # fmt: skip
        self._reads_later = [_later(cell, [{(p, v) for p, v, _ in row} for row in cell.reads])
                             for cell in automata.cells]  # fmt: skip

    def run(self) -> None:
        path = [self._entered(self.automata.start, 0)]
        while path:
            node = path[-1]
            after = next(node.rest, None)
            if after is None:
                if node.low == node.index and self._fair and (cells := self._ignored(node)):
                    self._expand(node, cells)
                    continue
                path.pop()
                self._left(node, path[-1] if path else None)
                continue
            self.transitions += 1
            if after not in self.seen:
                path.append(self._entered(after, _moved(node.vector, after)))
            elif (other := self._waiting.get(after)) is not None:
                node.low = min(node.low, other.index)
            else:
                node.exits = True

    def _entered(self, vector: Vector, last: int) -> _Node:
        if len(self.seen) >= self._limit:
            raise BudgetError("states", f"more than {self._limit} states")
        cells = self._chosen(vector, last)
        if not cells and not self.automata.over(vector):
            self.deadlocks.append(vector)
        node = _Node(vector, len(self.seen), cells, iter(self._successors(vector, cells)))
        self.seen[vector] = node.index
        self._open.append(node)
        self._waiting[vector] = node
        return node

    def _left(self, node: _Node, parent: _Node | None) -> None:
        if parent is not None:
            parent.low = min(parent.low, node.low)
        if node.low == node.index:
            done = None
            while done is not node:
                done = self._open.pop()
                del self._waiting[done.vector]
            if parent is not None:
                parent.exits = True

    # -- which cells

    def _chosen(self, vector: Vector, last: int) -> frozenset[int]:
        """The stubborn set with the fewest moves; among equals, that of the cell that moved last."""
        best: tuple[int, int, frozenset[int]] | None = None
        for n in (last, *range(len(vector))):
            cells = self._closed(vector, n)
            moves = len(self._successors(vector, cells))
            if moves and (best is None or (moves, len(cells)) < best[:2]):
                best = moves, len(cells), cells
            if best is not None and best[0] == 1:
                break
        return best[2] if best else frozenset()

    def _closed(self, vector: Vector, first: int) -> frozenset[int]:
        cells, waiting = {first}, [first]
        while waiting:
            n = waiting.pop()
            cell, state = self.automata.cells[n], vector[n]
            written = {(p, v) for p, v, _ in cell.writes[state]}
            read = {(p, v) for p, v, _ in cell.reads[state]}
            if not written and not read:
                continue
            for other, there in enumerate(vector):
                if other in cells:
                    continue
                if written & self._reads_later[other][there] or read & self._writes_later[other][there]:
                    cells.add(other)
                    waiting.append(other)
        return frozenset(cells)

    def _successors(self, vector: Vector, cells: frozenset[int]) -> list[Vector]:
        found = [
            (*vector[:n], after, *vector[n + 1 :])
            for n in sorted(cells)
            for _, after in self.automata.cells[n].own[vector[n]]
        ]
        return found + [after for _, _, _, after in self.automata.meetings(vector, sorted(cells))]

    # -- nobody is put off for ever

    def _ignored(self, root: _Node) -> frozenset[int]:
        """In a terminal component: a stubborn set of somebody who can move and was never expanded in it."""
        members = self._open[self._open.index(root) :]
        if any(node.exits for node in members):
            return frozenset()
        expanded = {cells for node in members for cells in node.expanded}
        vector = root.vector
        covered = frozenset().union(*expanded)
        for n, cell in enumerate(self.automata.cells):
            if n not in covered and cell.own[vector[n]]:
                return self._closed(vector, n)
        for w, r, _, _ in self.automata.meetings(vector, range(len(vector))):
            if not any({w, r} <= cells for cells in expanded):
                return self._closed(vector, w)
        return frozenset()

    def _expand(self, node: _Node, cells: frozenset[int]) -> None:
        node.expanded.append(cells)
        node.rest = iter(self._successors(node.vector, cells))


def _moved(before: Vector, after: Vector) -> int:
    return next((n for n, (a, b) in enumerate(zip(before, after, strict=True)) if a != b), 0)


def _later(cell: Automaton, now: list[set[tuple[Value, Value]]]) -> list[set[tuple[Value, Value]]]:
    """What a cell may offer from each state on."""
    found = [set(offers) for offers in now]
    grown = True
    while grown:
        grown = False
        for state in reversed(range(len(cell))):
            for after in cell.after(state):
                if not found[after] <= found[state]:
                    found[state] |= found[after]
                    grown = True
    return found
