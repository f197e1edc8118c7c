"""Graphs of states: from where something can be reached, and the parts in which a run that never ends stays at last."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Protocol


class Onward(Protocol):
    """A move: where it leads."""

    @property
    def after(self) -> int: ...


def reaching(successors: Iterable[Iterable[int]], goal: Iterable[int]) -> set[int]:
    """The states from which one of `goal` can be reached; `successors` are those of state 0, 1, 2, …"""
    before: dict[int, list[int]] = {}
    for n, after in enumerate(successors):
        for state in after:
            before.setdefault(state, []).append(n)
    found = set(goal)
    waiting = list(found)
    while waiting:
        for n in before.get(waiting.pop(), ()):
            if n not in found:
                found.add(n)
                waiting.append(n)
    return found


def components(moves: Sequence[Sequence[Onward]], within: set[int]) -> list[frozenset[int]]:
    """The strongly connected components of a part of a graph (Tarjan), without recursion."""
    found: list[frozenset[int]] = []
    index: dict[int, int] = {}
    low: dict[int, int] = {}
    stack: list[int] = []
    open_: set[int] = set()
    for root in sorted(within):
        work = [(root, iter(moves[root]))] if root not in index else []
        while work:
            node, rest = work[-1]
            if node not in index:
                index[node] = low[node] = len(index)
                stack.append(node)
                open_.add(node)
            onward = (m.after for m in rest if m.after in within)
            below = next((after for after in onward if after not in index or after in open_), None)
            if below is None:
                work.pop()
                if work:
                    low[work[-1][0]] = min(low[work[-1][0]], low[node])
                if low[node] == index[node]:
                    at = stack.index(node)
                    found.append(frozenset(stack[at:]))
                    open_.difference_update(stack[at:])
                    del stack[at:]
            elif below not in index:
                work.append((below, iter(moves[below])))
            else:
                low[node] = min(low[node], index[below])
    return found
