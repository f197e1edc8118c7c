"""A world from a network: places on a line for all end points, from what is known of single pairs.

Points that may differ do differ, and points that nothing orders keep the order that was `liked`. In a path-consistent
network of ORD-Horn sets every such world satisfies all of them (Ligozat, *A new proof of tractability for ORD-Horn
relations*, AAAI 1996); in others it satisfies what happens to suit it, and the search of `solving` splits the rest.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from heapq import heapify, heappop, heappush

from planner_reactor.logic.subclasses import ENDS, LESS, MORE, SAME, signs


def places(size: int, edges: Iterable[tuple[int, int, int]], liked: Sequence[int]) -> list[int]:
    """A place for each point 2i (start) and 2i + 1 (end) of the intervals below `size`.

    `edges` are the pairs about which something is known; `liked` a number for each point. ValueError if the order
    that the pairs demand goes round in a circle.
    """
    same = list(range(2 * size))
    later: list[tuple[int, int]] = [(2 * i, 2 * i + 1) for i in range(size)]
    for first, second, relation in edges:
        for (x, y), allowed in zip(ENDS, signs(relation), strict=True):
            one, other = 2 * first + x, 2 * second + y
            if allowed == SAME:
                same[_root(same, one)] = _root(same, other)
            elif not allowed & MORE:
                later.append((one, other))
            elif not allowed & LESS:
                later.append((other, one))
    return _sorted(same, later, liked)


def _root(same: list[int], point: int) -> int:
    while same[point] != point:
        same[point] = same[same[point]]
        point = same[point]
    return point


def _sorted(same: list[int], later: list[tuple[int, int]], liked: Sequence[int]) -> list[int]:
    """Places that rise along `later`, the liked ones first (Kahn's algorithm on the classes of `same`)."""
    roots = [_root(same, point) for point in range(len(same))]
    following: list[list[int]] = [[] for _ in same]
    waiting_for = [0] * len(same)
    for first, second in later:
        following[roots[first]].append(roots[second])
        waiting_for[roots[second]] += 1
    ready = [(liked[point], point) for point, root in enumerate(roots) if point == root and not waiting_for[point]]
    heapify(ready)
    place = [0] * len(same)
    count = 0
    while ready:
        _, point = heappop(ready)
        place[point] = count
        count += 1
        for other in following[point]:
            waiting_for[other] -= 1
            if not waiting_for[other]:
                heappush(ready, (liked[other], other))
    if any(waiting_for):
        raise ValueError("an order of points that goes round in a circle")
    return [place[root] for root in roots]
