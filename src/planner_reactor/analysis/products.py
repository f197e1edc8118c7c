"""A system and an automaton side by side: what can be reached of their product, and where it goes round.

The search for lassos (`lassos`) and the comparison with every part of small systems stand on it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence

import msgspec

from planner_reactor.analysis.systems import Move, System
from planner_reactor.analysis.tableau import Automaton, Edge
from planner_reactor.errors import BudgetError
from planner_reactor.rs.configurations import Label

NODES = 2_000_000
"""Pairs of a state of the system and one of the automaton that are visited at most."""

ANYHOW: Label = ("", (), "anyhow", ())
"""Stands for whatever follows when nothing is asked of it any more; fair runs go on from everywhere."""


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
    bits = _bits_of(system, justice)
    nodes, depth, possible = [(0, 0)], [0], list[int]()
    numbers = {nodes[0]: 0}
    before: list[tuple[int, Move] | None] = [None]
    arcs: list[tuple[Arc, ...]] = []
    for here, (state, duties) in enumerate(nodes):  # grows while it is read
        if duties == automaton.free:
            arcs.append((Arc(here, Move(ANYHOW, state, False, 0), automaton.all_kept, 0),))
            possible.append(0)
            continue
        found = []
        for move, bit, edge in _together(system, automaton, bits, state, duties):
            node = (move.after, edge.after)
            if (number := numbers.setdefault(node, len(nodes))) == len(nodes):
                if number >= NODES:
                    raise BudgetError("states", f"more than {NODES} states of program and property together")
                nodes.append(node)
                depth.append(depth[here] + 1)
                before.append((here, move))
            found.append(Arc(number, move, edge.kept, bit))
        arcs.append(tuple(found))
        possible.append(union(bits[state]) if state < len(bits) else 0)
    return Product(nodes, arcs, depth, before, possible)


def _together(
    system: System, automaton: Automaton, bits: Sequence[Sequence[int]], state: int, duties: int
) -> Iterator[tuple[Move, int, Edge]]:
    """The moves of a state with the edges that read what is seen of them, and the bit of what is taken."""
    for number, move in enumerate(system.leaving(state)):
        taken = bits[state][number] if bits[state] else 0
        for edge in automaton.edges[duties]:
            if edge.reads(move.seen):
                yield move, taken, edge


def _bits_of(system: System, justice: Justice) -> list[list[int]]:
    """For each move of each state the bit of its kind of step."""
    kinds: dict[Label, int] = {}
    return [[_bit(kinds.setdefault(m.label, justice.kind(m.label))) for m in moves] for moves in system.moves]


def _bit(kind: int) -> int:
    return 1 << kind if kind >= 0 else 0


def union(bits: Iterable[int]) -> int:
    total = 0
    for bit in bits:
        total |= bit
    return total


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
