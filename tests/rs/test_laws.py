"""The algebraic laws of docs/language.md on random terms in random contexts, and what is no law.

`LAW_TERMS` sets on how many distinct instances each law is checked under each equivalence: 1,000 in `make test`,
10,000 in `make laws`, which also decides every equivalence by its own procedure on every instance.
"""

from __future__ import annotations

import os

import pytest

from planner_reactor.analysis.equivalence import behaviour, bisimilar, same
from planner_reactor.rs.parser import parse_process
from tests.laws.checking import checked, differing, size, smallest
from tests.laws.table import EQUIVALENCES, LAWS, NON_LAWS, STRONG, TIMED, Law, filled
from tests.laws.terms import WORLD
from tests.laws.universe import Universe

TERMS = int(os.environ.get("LAW_TERMS", "1000"))
INDEPENDENT = TERMS if TERMS > 1000 else 100
LONG = pytest.mark.timeout(20 if TERMS <= 1000 else 3600)

named = {"ids": lambda law: law.name}


def assert_holds(law: Law, *, timed: bool) -> None:
    found = checked(law, TERMS, timed=timed, independent=INDEPENDENT)
    assert not found.failures, found.failures[:3]
    assert set(found.counts.values()) == {TERMS}


@LONG
@pytest.mark.parametrize("law", LAWS, **named)
def test_a_law_holds_for_random_terms(law: Law) -> None:
    assert_holds(law, timed=False)


@LONG
@pytest.mark.parametrize("law", [law for law in LAWS if TIMED in law.equivalences], **named)
def test_a_law_holds_for_random_terms_with_delays(law: Law) -> None:
    assert_holds(law, timed=True)


def test_there_are_laws_enough_and_each_is_checked_under_some_equivalence() -> None:
    assert sum(len(law.equivalences) == len(EQUIVALENCES) for law in LAWS) >= 20
    assert all(law.equivalences for law in LAWS)


@pytest.mark.parametrize("law", NON_LAWS, **named)
def test_what_is_no_law_has_a_counterexample_and_none_is_smaller(law: Law) -> None:
    found = smallest(law)
    assert found is not None
    assert not any(True for n in range(len(law.names), found.size) for _ in differing(law, n))
    left, right = (filled(parse_process(side), found.terms) for side in (law.left, law.right))
    assert sum(map(size, found.terms.values())) == found.size
    assert not bisimilar(left, right, WORLD)
    assert found.left != found.right


@pytest.mark.parametrize("law", NON_LAWS, **named)
def test_what_is_no_law_is_found_among_random_terms_too(law: Law) -> None:
    found = checked(law, 200, timed=False, independent=200)
    assert {equivalence for equivalence, *_ in found.failures} >= {STRONG}


@pytest.mark.parametrize("law", [law for law in LAWS if law.condition], **named)
def test_a_law_with_a_condition_fails_without_it(law: Law) -> None:
    bare = Law(law.left, law.right, context=law.context, guarded=law.guarded)
    assert checked(bare, 500, timed=False, independent=500).failures


@pytest.mark.parametrize("law", [law for law in LAWS if law.not_in], **named)
def test_a_law_fails_under_an_equivalence_that_it_does_not_claim(law: Law) -> None:
    bare = Law(law.left, law.right, context=law.context, guarded=law.guarded)
    failing = {equivalence for equivalence, *_ in checked(bare, 200, timed=False, independent=200).failures}
    assert failing <= set(law.not_in) - {TIMED}
    assert failing


@pytest.mark.parametrize(
    ("left", "right"),
    [("a;(b|c)", "a;(c|b)"), ("a;STOP", "a"), ("a|a", "a"), ("IN[p]<x> | OUT[p, 1] ; Delay[1]", "Delay[1]")],
)
def test_many_terms_at_once_are_compared_as_two_are_alone(left: str, right: str) -> None:
    p, q = parse_process(left), parse_process(right)
    universe = Universe(WORLD)
    states = universe.first(p), universe.first(q)
    for bindings in (False, True):
        classes = universe.classes(states, bindings=bindings)
        assert (classes[states[0]] == classes[states[1]]) == bisimilar(p, q, WORLD, bindings=bindings)


def test_traces_do_not_see_when_a_choice_is_made_and_bisimilarity_does() -> None:
    early, late = "(a:(b#NIL)) # (a:(c#NIL))", "a:(b#c#NIL)"
    universe = Universe(WORLD)
    p, q = universe.first(parse_process(early)), universe.first(parse_process(late))
    ends = universe.ends(bindings=False)
    assert universe.included(q, p, ends) != universe.included(p, q, ends)


@pytest.mark.parametrize("body", ["a", "a;b", "a#b", "ABORT", "STOP", "~a", "Delay[1]"])
def test_spawning_unfolds_into_a_concurrent_body(body: str) -> None:
    left = parse_process(f"(IN[p]<x> :: ({body})) | (OUT[p, 1] ; OUT[p, 2])")
    right = parse_process(f"(IN[p]<x> : (({body}) | (IN[p]<y> :: ({body})))) | (OUT[p, 1] ; OUT[p, 2])")
    assert same(behaviour(left, WORLD), behaviour(right, WORLD))


@pytest.mark.parametrize(("body", "outcome"), [("STOP", True), ("ABORT", False), ("Delay[1]", True)])
def test_spawning_stops_if_a_body_stopped_though_its_condition_aborted(body: str, outcome: bool) -> None:
    once = parse_process(f"((IN[p]<x> : GTR[x, 0]) :: ({body})) | ((OUT[p, 1] ; OUT[p, 0]) : ABORT)")
    ends = {end for end in behaviour(once, WORLD).ends if end is not None}
    assert ends == {outcome}
