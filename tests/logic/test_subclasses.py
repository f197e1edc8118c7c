"""The tractable classes: as many as the literature counts, closed, and what they say of end points is so."""

from __future__ import annotations

from itertools import combinations, product

import pytest

from planner_reactor.logic.allen import ALL, BASES, BIT, base_relation, compose, inverse, relations
from planner_reactor.logic.subclasses import ENDS, LESS, MORE, SAME, Class, hull, parts, signs, tractable


@pytest.mark.parametrize(("kind", "count"), [("convex", 82), ("pointisable", 187), ("ord_horn", 867)])
def test_the_classes_have_the_sizes_that_the_literature_counts(kind: Class, count: int) -> None:
    """With the empty set 83, 188 and 868 (Nebel and Bürckert, 1995)."""
    assert len(tractable(kind)) == count


@pytest.mark.parametrize("kind", ["convex", "pointisable", "ord_horn"])
def test_a_class_is_closed_under_inverse_meet_and_composition(kind: Class) -> None:
    sets = tractable(kind)
    some = sorted(sets)[:: 1 if kind == "convex" else 5]
    assert all(inverse(one) in sets for one in sets)
    assert all(not one & other or one & other in sets for one in some for other in sets)
    assert all(compose(one, other) in sets for one in some for other in sets)


def test_ord_horn_sets_are_the_preconvex_ones() -> None:
    """Ligozat 1994: what a set lacks of its hull has fewer free end points than the set itself (found another way)."""
    freedom = {name: sum(sign == SAME for sign in signs(BIT[name])) for name in BASES}

    def most_free(relation: int) -> int:
        return min(freedom[name] for n, name in enumerate(BASES) if relation >> n & 1)

    def limits(m: int) -> int:
        """The base relations whose end points are limits of those of this one."""
        near = {n: zip(signs(1 << n), signs(1 << m), strict=True) for n in range(len(BASES))}
        return sum(1 << n for n, pairs in near.items() if all(a in (b, SAME) for a, b in pairs))

    limit = [limits(m) for m in range(len(BASES))]

    def closure(relation: int) -> int:
        found = 0
        for m, around in enumerate(limit):
            found |= around if relation >> m & 1 else 0
        return found

    preconvex = {r for r in range(1, ALL + 1) if hull(closure(r)) == closure(r) and most_free(r) == most_free(hull(r))}
    assert tractable("ord_horn") == preconvex


def test_signs_are_those_of_examples() -> None:
    spans = list(combinations(range(4), 2))
    for a, b in product(spans, repeat=2):
        for pair, allowed in zip(ENDS, signs(base_relation(a, b)), strict=True):
            difference = a[pair[0]] - b[pair[1]]
            assert allowed == (MORE if difference > 0 else LESS if difference else SAME)


def test_the_hull_is_the_least_convex_set_around() -> None:
    convex = tractable("convex")
    for relation in range(1, ALL + 1, 13):
        around = [one for one in convex if relation & ~one == 0]
        assert hull(relation) == min(around, key=int.bit_count)


@pytest.mark.parametrize("kind", ["convex", "pointisable", "ord_horn"])
def test_every_set_is_the_union_of_its_parts(kind: Class) -> None:
    for relation in (*range(1, ALL + 1, 37), ALL):
        together = 0
        for part in parts(relation, kind):
            assert part in tractable(kind)
            together |= part
        assert together == relation


def test_disjoint_intervals_split_into_two_orders() -> None:
    assert set(parts(relations(["b", "bi", "m", "mi"]))) == {relations(["b", "m"]), relations(["bi", "mi"])}
