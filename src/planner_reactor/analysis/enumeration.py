"""Every state of a composition of automata, one bit for each: enumeration without a record per state.

A vector is a number in mixed radix, a set of vectors a row of bits in Python's integers, one for each state of the
first cell. A move a → b of a cell is then a mask (the vectors in which it is in a) and a shift (by b - a places of
its digit), a rendezvous two masks and one shift. All reachable vectors are found, counted and asked for deadlocks, at
a few nanoseconds each; memory is one bit for each vector there could be.

What it does not give is paths: `Automata.moves` and breadth-first search do.
"""

from __future__ import annotations

from collections.abc import Iterator
from math import prod
from typing import TypeAlias

import msgspec

from planner_reactor.analysis.automata import Automata
from planner_reactor.analysis.networks import Vector
from planner_reactor.errors import BudgetError

MOST_BITS = 2**28
"""Vectors that there could be, reachable or not: 32 MiB."""

Shift: TypeAlias = tuple[tuple[tuple[int, int], ...], int]
"""((cell, state), …) that a move asks for, and by how many places it shifts; of cells after the first."""

Move: TypeAlias = tuple[int | None, int | None, Shift]
"""(state of the first cell, its next state, the rest); None: it takes no part."""


class Enumerated(msgspec.Struct, frozen=True):
    """How many states, transitions and deadlocks there are; `stuck` is one of the deadlocks, if there is any."""

    states: int
    transitions: int
    deadlocks: int
    stuck: Vector | None


def enumerated(automata: Automata, *, most: int = MOST_BITS) -> Enumerated:
    """All of it. Raises `BudgetError` if more than `most` bits would be needed."""
    space = _Space(automata, most)
    space.reach()
    return space.counted()


class _Space:
    """The rows of bits: `rows[x]` are the vectors reached in which the first cell is in x."""

    def __init__(self, automata: Automata, most: int) -> None:
        sizes = [len(cell) for cell in automata.cells]
        if prod(sizes) > most:
            raise BudgetError("bits", f"there could be {prod(sizes)} states, at most {most} have room")
        self.automata = automata
        self.sizes = sizes
        self.strides = [0] + [prod(sizes[n + 1 :]) for n in range(1, len(sizes))]
        self.width = prod(sizes[1:])
        self.rows = [0] * sizes[0]
        self.masks = [0] + [self._periodic(n) for n in range(1, len(sizes))]
        self.moves = list(_moves(automata, self.strides))

    def _periodic(self, cell: int) -> int:
        """The vectors in which this cell is in its first state."""
        stride = self.strides[cell]
        mask, filled = (1 << stride) - 1, stride * self.sizes[cell]
        while filled < self.width:
            mask |= mask << filled
            filled *= 2
        return mask & ((1 << self.width) - 1)

    def asked(self, row: int, wanted: tuple[tuple[int, int], ...]) -> int:
        """The vectors of a row in which these cells are in these states."""
        for cell, state in wanted:
            row &= self.masks[cell] << (state * self.strides[cell])
        return row

    def reach(self) -> None:
        """Moves are made until no row grows."""
        within = [m for m in self.moves if m[0] is None]
        across: dict[int, list[Move]] = {}
        for move in self.moves:
            if move[0] is not None:
                across.setdefault(move[0], []).append(move)
        self.rows[0] = 1
        waiting = {0}
        while waiting:
            x = min(waiting)
            waiting.remove(x)
            self.rows[x] = row = self._saturated(self.rows[x], within)
            for _, y, (wanted, places) in across.get(x, ()):
                assert y is not None
                grown = self.rows[y] | _shifted(self.asked(row, wanted), places)
                if grown != self.rows[y]:
                    self.rows[y] = grown
                    waiting.add(y)

    def _saturated(self, row: int, moves: list[Move]) -> int:
        before = -1
        while row != before:
            before = row
            for _, _, (wanted, places) in moves:
                if found := self.asked(row, wanted):
                    row |= _shifted(found, places)
        return row

    def counted(self) -> Enumerated:
        transitions = deadlocks = 0
        stuck: Vector | None = None
        for x, row in enumerate(self.rows):
            blocked = row
            for first, _, (wanted, _) in self.moves:
                if first is None or first == x:
                    able = self.asked(row, wanted)
                    transitions += able.bit_count()
                    blocked &= ~able
            dead = blocked & ~self._over(x)
            deadlocks += dead.bit_count()
            if dead and stuck is None:
                stuck = self._vector(x, (dead & -dead).bit_length() - 1)
        return Enumerated(sum(row.bit_count() for row in self.rows), transitions, deadlocks, stuck)

    def _over(self, x: int) -> int:
        """The vectors of this row in which every cell is over."""
        cells = self.automata.cells
        over = (1 << self.width) - 1 if cells[0].over[x] else 0
        for n in range(1, len(cells)):
            some = 0
            for state, is_over in enumerate(cells[n].over):
                if is_over:
                    some |= self.masks[n] << (state * self.strides[n])
            over &= some
        return over

    def _vector(self, x: int, index: int) -> Vector:
        return (x, *(index // self.strides[n] % self.sizes[n] for n in range(1, len(self.sizes))))


def _shifted(bits: int, places: int) -> int:
    return bits << places if places >= 0 else bits >> -places


def _moves(automata: Automata, strides: list[int]) -> Iterator[Move]:
    for n, cell in enumerate(automata.cells):
        for state, own in enumerate(cell.own):
            for _, after in own:
                yield _move([(n, state, after)], strides)
    for w, writer in enumerate(automata.cells):
        for r, reader in enumerate(automata.cells):
            if w != r and automata.linked(w, r):
                for wrote, halves in enumerate(writer.writes):
                    for port, value, written in halves:
                        for read, others in enumerate(reader.reads):
                            for at, what, after in others:
                                if at == port and what == value:
                                    yield _move([(w, wrote, written), (r, read, after)], strides)


def _move(changes: list[tuple[int, int, int]], strides: list[int]) -> Move:
    first = second = None
    places = 0
    wanted = []
    for cell, before, after in changes:
        if cell == 0:
            first, second = before, after
        else:
            wanted.append((cell, before))
            places += (after - before) * strides[cell]
    return first, second, (tuple(wanted), places)
