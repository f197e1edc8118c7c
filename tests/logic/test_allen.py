"""Allen's algebra: the shipped table is what reasoning over end points yields, and it obeys its laws."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from planner_reactor.logic.allen import (
    ALL,
    BASES,
    BIT,
    COMPOSITION,
    NAMED,
    base_relation,
    compose,
    derive_composition,
    inverse,
    names,
    relations,
    show,
)

sets = st.integers(1, ALL)


def test_the_composition_table_is_derived_from_end_points() -> None:
    assert derive_composition() == COMPOSITION


def test_the_table_has_409_base_entries() -> None:
    assert sum(entry.bit_count() for row in COMPOSITION for entry in row) == 409


def test_the_papers_named_relations() -> None:
    assert names(NAMED["disjunct"]) == ("b", "bi", "m", "mi")
    assert names(NAMED["encompasses"]) == ("si", "di", "fi", "e")
    assert names(NAMED["finishes"]) == ("f",)
    assert show(relations(["m", "o", "si"])) == "[m o si]"


def test_an_inverse_name_ends_in_i() -> None:
    for name in ("b", "m", "o", "s", "d", "f"):
        assert inverse(BIT[name]) == BIT[name + "i"]
    assert inverse(BIT["e"]) == BIT["e"]


def test_an_unknown_relation_names_the_nearest() -> None:
    with pytest.raises(ValueError, match="did you mean oi"):
        relations(["ooi"])


@given(sets, sets)
def test_the_inverse_of_a_composition_is_the_composition_of_inverses(first: int, second: int) -> None:
    assert inverse(compose(first, second)) == compose(inverse(second), inverse(first))


@given(sets, sets, sets)
def test_composition_is_associative(a: int, b: int, c: int) -> None:
    assert compose(compose(a, b), c) == compose(a, compose(b, c))


@given(sets)
def test_equal_is_neutral_and_inversion_is_its_own_inverse(relation: int) -> None:
    assert compose(relation, NAMED["equal"]) == relation == compose(NAMED["equal"], relation)
    assert inverse(inverse(relation)) == relation


def test_exactly_one_base_relation_holds_between_two_intervals() -> None:
    spans = [(a, b) for a in range(4) for b in range(a + 1, 5)]
    found = {base_relation(first, second) for first in spans for second in spans}
    assert found == {BIT[name] for name in BASES}
