"""Reachability and cycles in a directed graph, without recursion: definitions call each other in chains of
any length.

A graph maps a node to what follows it; a node without an entry has no successors. Results are in the order of
the graph's entries, so that the same program gives the same findings.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Collection, Hashable, Iterable, Mapping
from typing import TypeVar

N = TypeVar("N", bound=Hashable)
V = TypeVar("V")


def reachable(edges: Mapping[N, Iterable[N]], starts: Iterable[N], *, but: Collection[N] = ()) -> dict[N, None]:
    """All that can be reached from `starts`, which are included, through nodes not in `but`; in order of
    discovery."""
    found = dict.fromkeys(starts)
    waiting = list(found)
    while waiting:
        for following in edges.get(waiting.pop(), ()):
            if following not in found and following not in but:
                found[following] = None
                waiting.append(following)
    return found


def cycles(edges: Mapping[N, Collection[N]]) -> list[list[N]]:
    """The largest sets of nodes that can all reach each other: Kosaraju's strongly connected components."""
    backwards = _backwards(edges)
    position = {node: number for number, node in enumerate(edges)}
    assigned: set[N] = set()
    found = []
    for node in reversed(_finished(edges)):
        if node not in assigned:
            component = reachable(backwards, [node], but=assigned)
            assigned.update(component)
            if len(component) > 1 or node in edges[node]:
                found.append(sorted(component, key=position.__getitem__))
    return sorted(found, key=lambda component: position[component[0]])


def way_round(edges: Mapping[N, Iterable[N]], start: N) -> list[N]:
    """A shortest way from `start`, which must lie on a cycle, back to itself; both ends are included."""
    came_from: dict[N, N] = {}
    waiting = [start]
    for node in waiting:
        for following in edges.get(node, ()):
            if following not in came_from:
                came_from[following] = node
                waiting.append(following)
        if start in came_from:
            break
    way = [start, came_from[start]]
    while way[-1] != start:
        way.append(came_from[way[-1]])
    return way[::-1]


def solve(edges: Mapping[N, Iterable[N]], start: V, transfer: Callable[[N, Mapping[N, V]], V]) -> Mapping[N, V]:
    """The first solution, from `start` on, of value(n) = transfer(n, values), where transfer reads the values
    of what follows n. It must be monotone."""
    leading_here = _backwards(edges)
    values = dict.fromkeys(edges, start)
    waiting = deque(_finished(edges))
    queued = set(waiting)
    while waiting:
        node = waiting.popleft()
        queued.remove(node)
        value = transfer(node, values)
        if value != values[node]:
            values[node] = value
            again = [c for c in leading_here.get(node, ()) if c not in queued]
            waiting.extend(again)
            queued.update(again)
    return values


def _backwards(edges: Mapping[N, Iterable[N]]) -> Mapping[N, Mapping[N, None]]:
    """What leads to each node."""
    found: dict[N, dict[N, None]] = {}
    for node, followings in edges.items():
        for following in followings:
            found.setdefault(following, {})[node] = None
    return found


def _finished(edges: Mapping[N, Iterable[N]]) -> list[N]:
    """The nodes with entries, each after those that were first reached through it."""
    seen: set[N] = set()
    finished = []
    for root in edges:
        if root in seen:
            continue
        seen.add(root)
        walk = [(root, iter(edges[root]))]
        while walk:
            node, rest = walk[-1]
            following = next((f for f in rest if f in edges and f not in seen), None)
            if following is None:
                finished.append(node)
                walk.pop()
            else:
                seen.add(following)
                walk.append((following, iter(edges[following])))
    return finished
