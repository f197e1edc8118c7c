"""Is a network of intervals consistent, and what would a world look like in which it holds?

Path consistency alone accepts networks that no world satisfies. `timeline` is the complete search on top of
it: it splits relation sets into *pointisable* ones (those that are conjunctions of comparisons of end
points, for which path consistency decides), then orders the end points. The pointisable sets are found by
reasoning over end points, not listed. `scenario` reads one base relation for every pair off the timeline;
`holds_in` checks numbers against a network.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import cache
from itertools import product

from planner_reactor.errors import BudgetError
from planner_reactor.logic.allen import BASES, base_relation, inverse
from planner_reactor.logic.network import Interval, Network

Point = tuple[Interval, int]
"""The start (0) or the end (1) of an interval."""

_ENDS = ((0, 0), (0, 1), (1, 0), (1, 1))


def is_consistent(network: Network, *, limit: int = 100_000) -> bool:
    """Does any world satisfy the network? Complete; BudgetError after `limit` guesses (it is NP-complete)."""
    return timeline(network, limit=limit) is not None


def timeline(network: Network, *, limit: int = 100_000) -> dict[Interval, tuple[int, int]] | None:
    """Start and end of each interval, as small whole numbers, in one world where the network holds;
    None if none.
    """
    trial = network.copy()
    if not trial.consistent or not _split(trial, limit):
        return None
    rank = _order(trial)
    return {interval: (rank[interval, 0], rank[interval, 1]) for interval in trial.intervals}


def scenario(network: Network, *, limit: int = 100_000) -> dict[tuple[Interval, Interval], str] | None:
    """One base relation for every pair (the one named first comes first), all holding together; None
    if none do.
    """
    times = timeline(network, limit=limit)
    if times is None:
        return None
    named = list(times)
    return {
        (first, second): BASES[base_relation(times[first], times[second]).bit_length() - 1]
        for n, first in enumerate(named)
        for second in named[n + 1 :]
    }


def holds_in(network: Network, times: Mapping[Interval, tuple[float, float]]) -> bool:
    """Do these starts and ends satisfy every relation of the network?"""
    return all(base_relation(times[first], times[second]) & relation for first, second, relation in network.edges())


@cache
def parts(relation: int) -> tuple[int, ...]:
    """Pointisable sets that together are `relation`, as few as a greedy choice finds."""
    found: list[int] = []
    left = relation
    while left:
        best = max((p for p in pointisable() if p & ~relation == 0), key=lambda p: ((p & left).bit_count(), -p))
        found.append(best)
        left &= ~best
    return tuple(found)


@cache
def pointisable() -> frozenset[int]:
    """All sets that are exactly what some comparisons of end points allow (187 of the 8192, without
    the empty one).
    """
    columns = [[_allowing(ends, signs) for signs in range(1, 8)] for ends in _ENDS]
    return frozenset(a & b & c & d for a, b, c, d in product(*columns)) - {0}


def _allowing(ends: tuple[int, int], signs: int) -> int:
    """The base relations under which these two end points compare as one of `signs` (bits: <, =, >)."""
    return sum(1 << n for n, sign in enumerate(_comparisons()[ends]) if signs >> (sign + 1) & 1)


@cache
def _comparisons() -> dict[tuple[int, int], tuple[int, ...]]:
    """For each pair of end points and each base relation: -1, 0 or 1 as the first is before, at, after
    the second.
    """
    example: dict[int, tuple[tuple[int, int], tuple[int, int]]] = {}
    spans = [(start, end) for end in range(4) for start in range(end)]
    for first, second in product(spans, spans):
        example.setdefault(base_relation(first, second), (first, second))
    return {
        (x, y): tuple(_sign(example[1 << n][0][x] - example[1 << n][1][y]) for n in range(len(BASES))) for x, y in _ENDS
    }


def _sign(difference: int) -> int:
    return (difference > 0) - (difference < 0)


def _split(network: Network, limit: int) -> bool:
    """Narrow every relation to a pointisable one; False if no choice is path-consistent."""
    tried: list[tuple[int, Interval, Interval, Iterator[int]]] = []
    agenda = _undecided(network)
    guesses = 0
    while (edge := _next(agenda, network)) is not None:
        first, second = edge
        tried.append((network.mark(), first, second, iter(parts(network.relation(first, second)))))
        while tried:
            mark, first, second, choices = tried[-1]
            network.undo(mark)
            choice = next(choices, None)
            if choice is None:
                tried.pop()
                continue
            guesses += 1
            if guesses > limit:
                raise BudgetError("guesses", f"no scenario found or excluded within {limit} guesses")
            if network.constrain(first, second, choice):
                break
        else:
            return False
        agenda.extend(edge for edge in (_undecided(network) if _next(agenda, network) is None else ()))
    return True


def _undecided(network: Network) -> list[tuple[Interval, Interval]]:
    """The edges that are not pointisable, those that split into the fewest parts first."""
    found = [(a, b, r) for a, b, r in network.edges() if r not in pointisable()]
    return [(a, b) for a, b, r in sorted(found, key=lambda edge: len(parts(edge[2])))]


def _next(agenda: list[tuple[Interval, Interval]], network: Network) -> tuple[Interval, Interval] | None:
    return next((edge for edge in agenda if network.relation(*edge) not in pointisable()), None)


def _order(network: Network) -> dict[Point, int]:
    """A place on the line for every end point of a pointisable, path-consistent network."""
    later: dict[Point, dict[Point, bool]] = {(i, side): {} for i in network.intervals for side in (0, 1)}
    for interval in network.intervals:
        later[interval, 0][interval, 1] = True
    for first, second, relation in network.edges():
        for a, b, allowed in ((first, second, relation), (second, first, inverse(relation))):
            for x, y in _ENDS:
                if not allowed & _allowing((x, y), 4):
                    strict = not allowed & _allowing((x, y), 2)
                    later[a, x][b, y] = later[a, x].get((b, y), False) or strict
    return _places(later)


def _places(later: Mapping[Point, Mapping[Point, bool]]) -> dict[Point, int]:
    """Numbers that rise along `later` (equal only inside a cycle, where nothing is strict)."""
    finished: list[Point] = []
    seen: set[Point] = set()
    for root in later:
        _visit(root, later, seen, finished)
    earlier: dict[Point, dict[Point, bool]] = {point: {} for point in later}
    for point, following in later.items():
        for other in following:
            earlier[other][point] = True
    places: dict[Point, int] = {}
    count = 0
    for root in reversed(finished):  # Kosaraju: cycles come out whole, in order
        if root not in places:
            cycle: list[Point] = []
            _visit(root, earlier, places, cycle)
            places.update(dict.fromkeys(cycle, count))
            count += 1
    return places


def _visit(
    root: Point,
    graph: Mapping[Point, Mapping[Point, bool]],
    seen: set[Point] | Mapping[Point, int],
    out: list[Point],
) -> None:
    """Append to `out`, children first, all points reachable from `root` that are not in `seen`."""
    here: set[Point] = seen if isinstance(seen, set) else set()
    if root in here or root in seen:
        return
    here.add(root)
    stack = [(root, iter(graph[root]))]
    while stack:
        point, children = stack[-1]
        for child in children:
            if child not in here and child not in seen:
                here.add(child)
                stack.append((child, iter(graph[child])))
                break
        else:
            out.append(point)
            stack.pop()
