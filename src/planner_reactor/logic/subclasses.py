"""The tractable sets of Allen relations, found by reasoning over end points: convex, pointisable, ORD-Horn.

Two intervals have four pairs of end points. A *clause* is a disjunction of comparisons of such pairs with at most one
that is not a `≠`; a set of relations is ORD-Horn if it is what some clauses leave (Nebel and Bürckert, *Reasoning about
temporal relations: a maximal tractable subclass of Allen's interval algebra*, JACM 42, 1995). Clauses of one comparison
alone give the pointisable sets, those without `≠` the convex ones. On a network of ORD-Horn sets path consistency
decides, so a complete search need only split the others into `parts`. Nothing is listed here: 208 clauses are
generated, and their meets are the classes.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from functools import cache
from itertools import combinations, product
from typing import Literal

from planner_reactor.logic.allen import ALL, BASES, BIT, NONE, base_relation

ENDS = ((0, 0), (0, 1), (1, 0), (1, 1))
"""The pairs of end points: 0 is a start, 1 an end; of the first interval, then of the second."""
LESS, SAME, MORE = 1, 2, 4
"""The signs of a comparison, as bits."""
Class = Literal["convex", "pointisable", "ord_horn"]


@cache
def signs(relation: int) -> tuple[int, int, int, int]:
    """For each pair in `ENDS`: how the first point can lie to the second."""
    found = [0, 0, 0, 0]
    for n, base in enumerate(_bases()):
        if relation >> n & 1:
            for pair in range(4):
                found[pair] |= base[pair]
    return found[0], found[1], found[2], found[3]


def allowing(pair: int, allowed: int) -> int:
    """The base relations in which the pair of end points has one of these signs."""
    return sum(1 << n for n, base in enumerate(_bases()) if base[pair] & allowed)


@cache
def tractable(kind: Class) -> frozenset[int]:
    """All sets of the class but the empty one: 82 convex, 187 pointisable, 867 ORD-Horn."""
    found = {ALL}
    for clause in sorted(_clauses(kind)):
        found |= {one & clause for one in found}
    return frozenset(found - {NONE})


@cache
def parts(relation: int, kind: Class = "ord_horn") -> tuple[int, ...]:
    """Sets of the class that together are `relation`, as few as a greedy choice finds, the largest first."""
    if relation in tractable(kind):
        return (relation,)
    inside = [one for one in _ordered(kind) if one & ~relation == 0]
    found: list[int] = []
    left = relation
    while left:
        found.append(max(inside, key=lambda one: ((one & left).bit_count(), -one)))
        left &= ~found[-1]
    return tuple(found)


@cache
def _ordered(kind: Class) -> tuple[int, ...]:
    return tuple(sorted(tractable(kind)))


@cache
def hull(relation: int) -> int:
    """The least convex set around it: what its end points, each for itself, allow."""
    found = ALL
    for pair, allowed in enumerate(signs(relation)):
        found &= allowing(pair, allowed | SAME if allowed == LESS | MORE else allowed)
    return found


def within(relation: int, pair: int, allowed: int) -> int:
    """What is left of a set if the pair of end points has one of these signs."""
    return relation & allowing(pair, allowed)


@cache
def _bases() -> tuple[tuple[int, ...], ...]:
    """The signs of every base relation, read off an example of it."""
    spans = list(combinations(range(4), 2))
    example = {base_relation(a, b): (a, b) for a, b in product(spans, repeat=2)}
    return tuple(tuple(_sign(example[BIT[name]], pair) for pair in ENDS) for name in BASES)


def _sign(spans: tuple[tuple[int, int], tuple[int, int]], pair: tuple[int, int]) -> int:
    difference = spans[0][pair[0]] - spans[1][pair[1]]
    return MORE if difference > 0 else LESS if difference < 0 else SAME


def _clauses(kind: Class) -> Iterator[int]:
    """What each clause allows."""
    literals = [allowing(pair, allowed) for pair in range(4) for allowed in (LESS | SAME, SAME | MORE, SAME)]
    unequal = [allowing(pair, LESS | MORE) for pair in range(4)]
    if kind == "convex":
        # x < y is x ≤ y and x ≠ y: of the ≠ only those that come with a ≤
        yield from (allowing(pair, allowed) for pair in range(4) for allowed in (1, 2, 3, 4, 6))
    elif kind == "pointisable":
        yield from (*literals, *unequal)
    else:
        for positive in (NONE, *literals):
            for negative in _selections(unequal):
                if positive | negative:
                    yield positive | negative


def _selections(sets: Iterable[int]) -> list[int]:
    found = [NONE]
    for one in sets:
        found += [other | one for other in found]
    return found
