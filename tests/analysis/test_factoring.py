"""Factors are found, and the product of their verdicts is the verdict of the whole."""

from __future__ import annotations

import pytest

from planner_reactor.analysis.automata import compiled
from planner_reactor.analysis.enumeration import enumerated
from planner_reactor.analysis.factoring import factored
from planner_reactor.analysis.footprints import ANY, footprint
from planner_reactor.analysis.networks import networked
from planner_reactor.analysis.transitions import build
from planner_reactor.errors import BudgetError
from planner_reactor.experiments import copies
from tests.analysis.nets import Nets, begun


@pytest.mark.parametrize(("k", "coupled"), [(2, False), (2, True), (3, False), (3, True)])
def test_factors_of_safe_adaptations_have_the_counts_of_the_whole(k: int, coupled: bool) -> None:
    config, world = copies.begun(k, coupled=coupled)
    found = factored(config, world)
    whole = enumerated(compiled(networked(config, world, limit=1_000)))
    assert (found.states, found.transitions, found.deadlocks) == (whole.states, whole.transitions, whole.deadlocks)
    assert len(found.factors) == (k - 1 if coupled else k)
    assert found.stuck == ((0,) if coupled else ())


def test_a_hundred_copies_are_one_examined_and_a_coupled_pair_is_found_among_them() -> None:
    alone = factored(*copies.begun(100))
    assert (len(alone.factors), alone.examined, alone.deadlocks) == (100, 1, 0)
    assert alone.states == alone.factors[0].states ** 100
    coupled = factored(*copies.begun(100, coupled=True))
    assert (len(coupled.factors), coupled.examined, coupled.stuck) == (99, 2, (0,))
    assert coupled.factors[0].stuck is not None


@pytest.mark.parametrize("delays", [False, True])
def test_factors_of_random_nets_have_the_counts_of_the_whole(delays: bool) -> None:
    """Nets whose ports are told apart, side by side, some of them twice."""
    several = 0
    for seed in range(40):
        one, other = Nets(seed, delays=delays).text(), Nets(seed + 1_000, delays=delays).text()
        for port in "pqr":
            other = other.replace(f"[{port}", f"[{port}{port}")
        twin = one.replace("[s", "[s2").replace("x", "y")
        for port in "pqr":
            twin = twin.replace(f"[{port}", f"[{port}3")
        config, world = begun(f"({one}) & ({other.replace('x', 'z').replace('[s', '[ss')}) & ({twin})")
        try:
            whole = build(config, world, limit=2_000)
        except BudgetError:
            continue
        found = factored(config, world)
        several += len(found.factors) > 2
        ours = (found.states, found.transitions, found.deadlocks)
        assert ours == (len(whole), whole.size, len(whole.deadlocks)), seed
    assert several > 10


def test_copies_are_told_from_what_only_looks_like_one() -> None:
    """The second compares its name with a constant, so that it is no copy of the first."""
    text = "(a : IN[p]<x> : Equal[p, q]) | (a : IN[q]<y> : Equal[q, q])"
    found = factored(*begun(text))
    assert (len(found.factors), found.examined) == (2, 2)
    assert factored(*begun("(a : IN[p]<x>) | (a : IN[q]<y>)")).examined == 2  # they stand in different places


def test_a_port_that_is_not_known_may_be_any_port() -> None:
    config, world = begun("(IN[p]<x> : OUT[x, 1]) | IN[q]<y>")
    assert ("port", ANY) in footprint(config.root(1), world).things
    assert len(factored(config, world).factors) == 1
