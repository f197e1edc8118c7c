"""All ways in which four intervals can lie on a line, and random networks: an oracle apart from the search.

Four intervals have 23,917 scenarios. For each pair and base relation the set of scenarios that have it there is a whole
number, one bit a scenario; the worlds of a network are the meet of what its relations allow.
"""

from __future__ import annotations

import random
from functools import cache
from itertools import combinations

from planner_reactor.logic.allen import ALL, BASES, BIT
from planner_reactor.logic.subclasses import tractable

PAIRS = tuple(combinations(range(4), 2))
Relations = dict[tuple[int, int], int]
Spans = tuple[tuple[int, int], ...]


def relation_of(first: tuple[int, int], second: tuple[int, int]) -> str:
    """The base relation, from its definition: written anew, not that of the package."""
    (a, z), (b, y) = first, second
    table = {
        "b": z < b, "bi": y < a, "m": z == b, "mi": y == a, "e": a == b and z == y,
        "s": a == b and z < y, "si": a == b and z > y, "f": a > b and z == y, "fi": a < b and z == y,
        "d": a > b and z < y, "di": a < b and z > y, "o": a < b < z < y, "oi": b < a < y < z,
    }  # fmt: skip
    (name,) = [name for name, holds in table.items() if holds]
    return name


@cache
def scenarios() -> tuple[tuple[Spans, ...], dict[tuple[int, int, str], int]]:
    """A world for each scenario of four intervals, and for each pair and base relation its scenarios as bits."""
    spans = list(combinations(range(8), 2))
    named = {(a, b): relation_of(a, b) for a in spans for b in spans}
    found: dict[tuple[str, ...], Spans] = {}
    for a in spans:
        for b in spans:
            ab = named[a, b]
            for c in spans:
                ac, bc = named[a, c], named[b, c]
                for d in spans:
                    found.setdefault((ab, ac, named[a, d], bc, named[b, d], named[c, d]), (a, b, c, d))
    having: dict[tuple[int, int, str], int] = {(i, j, name): 0 for i, j in PAIRS for name in BASES}
    for place, (i, j) in enumerate(PAIRS):
        for name in BASES:
            bits = bytes(ord("1") if key[place] == name else ord("0") for key in reversed(found))
            having[i, j, name] = int(bits, 2)
    return tuple(found.values()), having


@cache
def of_three() -> tuple[Spans, ...]:
    """A world for each of the 409 scenarios of three intervals."""
    found: dict[tuple[str, ...], Spans] = {}
    for a, b, c, _ in scenarios()[0]:
        found.setdefault((relation_of(a, b), relation_of(a, c), relation_of(b, c)), (a, b, c))
    return tuple(found.values())


def fitting(relations: Relations) -> int:
    """The scenarios in which the relations hold, as bits."""
    worlds, having = scenarios()
    left = (1 << len(worlds)) - 1
    for (i, j), relation in relations.items():
        allowed = 0
        for name in BASES:
            if relation & BIT[name]:
                allowed |= having[i, j, name]
        left &= allowed
    return left


def uniform(rng: random.Random, size: float, density: float = 1.0) -> Relations:
    """The model A(n, d, s) of Nebel: each pair with this chance, each base relation with chance size / 13."""
    return {pair: one(rng, size) for pair in PAIRS if rng.random() < density}


def one(rng: random.Random, size: float) -> int:
    """A set of base relations, each of them with chance size / 13; never empty."""
    relation = 0
    while not relation:
        relation = sum(bit for bit in BIT.values() if rng.random() < size / 13)
    return relation


@cache
def hard_relations(largest: int) -> tuple[int, ...]:
    """All sets that are not ORD-Horn, of at most so many base relations."""
    sets = (relation for relation in range(1, ALL + 1) if relation not in tractable("ord_horn"))
    return tuple(relation for relation in sets if relation.bit_count() <= largest)


def hard(rng: random.Random, largest: int = 13) -> Relations:
    """The model H(n, d) of Nebel: only sets that the tractable class lacks; small ones are at the phase transition."""
    return {pair: rng.choice(hard_relations(largest)) for pair in PAIRS}


def planted(rng: random.Random, size: float) -> Relations:
    """Relations that hold in a world: consistent by construction."""
    spans = [tuple(sorted(rng.sample(range(8), 2))) for _ in range(4)]
    found = uniform(rng, size)
    for i, j in found:
        found[i, j] |= BIT[relation_of((spans[i][0], spans[i][1]), (spans[j][0], spans[j][1]))]
    return found
