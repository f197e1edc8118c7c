"""A network without time as automata: each cell's table of moves, complete for whatever the other cells may offer.

`Automata` is what reduction, enumeration by bits and the export to Promela work on: no term is looked at any more. A
table may hold states that the cell reaches only with partners that never offer what it waits for; who composes the
tables again (we, or SPIN) finds out.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from math import inf
from typing import TypeAlias

import msgspec

from planner_reactor.analysis.cells import Cell
from planner_reactor.analysis.networks import Network, Vector, met_label
from planner_reactor.errors import PlannerReactorError
from planner_reactor.rs.configurations import Label
from planner_reactor.rs.terms import Value

Half: TypeAlias = tuple[Value, Value, int]
"""(port, value, next state): one side of a rendezvous."""


class Timed(PlannerReactorError):
    """Time passes in this network: its cells do not move one by one."""


class Automaton(msgspec.Struct, frozen=True):
    """One cell: from each state its own moves, what it would write, what it would read; and where it is over."""

    own: tuple[tuple[tuple[Label, int], ...], ...]
    writes: tuple[tuple[Half, ...], ...]
    reads: tuple[tuple[Half, ...], ...]
    over: tuple[bool, ...]

    def __len__(self) -> int:
        return len(self.own)

    def after(self, state: int) -> Iterator[int]:
        """Every state that may be next, whatever the others do."""
        for _, s in self.own[state]:
            yield s
        for half in (*self.writes[state], *self.reads[state]):
            yield half[2]


class Automata(msgspec.Struct, frozen=True):
    """The cells of a network; a state is a vector of their states, and the first is all zeros."""

    cells: tuple[Automaton, ...]

    @property
    def start(self) -> Vector:
        return (0,) * len(self.cells)

    def moves(self, vector: Vector) -> Iterator[tuple[Label, Vector]]:
        """Every move of the composition."""
        for n, (cell, state) in enumerate(zip(self.cells, vector, strict=True)):
            for label, s in cell.own[state]:
                yield label, (*vector[:n], s, *vector[n + 1 :])
        for _, _, label, met in self.meetings(vector, range(len(vector))):
            yield label, met

    def meetings(self, vector: Vector, among: Iterable[int]) -> Iterator[tuple[int, int, Label, Vector]]:
        """Every rendezvous of two of these cells: writer, reader, label, vector afterwards."""
        members = list(among)
        for w in members:
            for port, value, written in self.cells[w].writes[vector[w]]:
                for r in members:
                    if r == w:
                        continue
                    for at, what, read in self.cells[r].reads[vector[r]]:
                        if at == port and what == value:
                            after = list(vector)
                            after[w], after[r] = written, read
                            yield w, r, met_label(port, value), tuple(after)

    def over(self, vector: Vector) -> bool:
        return all(cell.over[state] for cell, state in zip(self.cells, vector, strict=True))

    def linked(self, one: int, other: int) -> bool:
        """Can these two cells ever meet?"""
        left, right = self.cells[one], self.cells[other]
        return bool(halves(left.writes) & halves(right.reads)) or bool(halves(left.reads) & halves(right.writes))


def halves(table: tuple[tuple[Half, ...], ...]) -> set[tuple[Value, Value]]:
    return {(port, value) for row in table for port, value, _ in row}


def compiled(network: Network) -> Automata:
    """The tables of a network. Raises `Timed` where time can pass, `BudgetError` if a cell is too large."""
    domains: dict[Value, dict[Value, set[int]]] = {}
    before = -1
    while before != (before := _extent(network, domains)):
        for number, cell in enumerate(network.cells):
            _widened(number, cell, domains)
    return Automata(tuple(_table(number, cell, domains) for number, cell in enumerate(network.cells)))


def _extent(network: Network, domains: dict[Value, dict[Value, set[int]]]) -> int:
    return sum(map(len, network.cells)) + sum(len(cells) for d in domains.values() for cells in d.values())


def _widened(number: int, cell: Cell, domains: dict[Value, dict[Value, set[int]]]) -> None:
    """Everything that the cell can do with what is offered so far, and what it offers."""
    for state, _ in enumerate(cell.configs):  # grows while it is read
        if 0 < cell.pause(state) < inf:
            raise Timed("time passes in this network")
        cell.steps(state)
        for port, value, _ in cell.offered(state):
            domains.setdefault(port, {}).setdefault(value, set()).add(number)
        for _ in _readings(number, cell, state, domains):
            pass


def _readings(number: int, cell: Cell, state: int, domains: dict[Value, dict[Value, set[int]]]) -> Iterator[Half]:
    for port in cell.ports_read(state):
        for value, writers in domains.get(port, {}).items():
            if writers - {number}:
                for after in cell.taken(state, port, value):
                    yield port, value, after


def _table(number: int, cell: Cell, domains: dict[Value, dict[Value, set[int]]]) -> Automaton:
    states = range(len(cell))
    return Automaton(
        tuple(tuple((label, after) for label, after, _ in cell.steps(s)) for s in states),
        tuple(cell.offered(s) for s in states),
        tuple(tuple(_readings(number, cell, s, domains)) for s in states),
        tuple(cell.over(s) for s in states),
    )
