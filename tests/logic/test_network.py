"""The network: propagation is incremental, order-free and can be undone."""

from __future__ import annotations

import random

import pytest
from hypothesis import given
from hypothesis import strategies as st

from planner_reactor.logic.allen import ALL, BIT, base_relation, compose, inverse, relations
from planner_reactor.logic.network import Network

b, m = BIT["b"], BIT["m"]


def test_what_follows_is_known_at_once() -> None:
    network = Network()
    network.constrain("i", "j", relations(["m"]))
    network.constrain("j", "k", relations(["m", "o"]))
    assert network.relation("i", "k") == b
    assert network.relation("k", "i") == BIT["bi"]


def test_nothing_known_is_no_edge() -> None:
    network = Network()
    network.constrain("i", "j", relations(["d"]))
    network.constrain("j", "k", relations(["di"]))
    assert network.relation("i", "k") == ALL
    assert len(list(network.edges())) == 2


def test_a_circle_of_before_is_a_contradiction() -> None:
    network = Network()
    assert network.extend([("i", "j", b | m), ("j", "k", b | m)])
    assert not network.constrain("k", "i", b | m)
    assert not network.consistent


def test_undo_returns_to_the_mark() -> None:
    network = Network()
    network.constrain("i", "j", b | m)
    before = list(network.edges())
    mark = network.mark()
    network.constrain("j", "k", b)
    assert not network.constrain("k", "i", b)
    network.undo(mark)
    assert network.consistent
    assert list(network.edges()) == before


def test_an_interval_is_equal_to_itself() -> None:
    network = Network()
    assert network.constrain("i", "i", BIT["e"] | b)
    assert not network.constrain("i", "i", b)


@st.composite
def constraints(draw: st.DrawFn) -> list[tuple[int, int, int]]:
    size = draw(st.integers(3, 6))
    pair = st.tuples(st.integers(0, size - 1), st.integers(0, size - 1)).filter(lambda p: p[0] != p[1])
    return [(i, j, draw(st.integers(1, ALL))) for i, j in draw(st.lists(pair, max_size=12))]


@given(constraints())
def test_the_result_is_path_consistent(given_constraints: list[tuple[int, int, int]]) -> None:
    network = Network()
    if network.extend(given_constraints):
        for i in network.intervals:
            for j in network.intervals:
                for k in network.intervals:
                    via = compose(network.relation(i, j), network.relation(j, k))
                    assert i == k or network.relation(i, k) & ~via == 0
                assert network.relation(i, j) == inverse(network.relation(j, i))


@given(constraints(), st.randoms(use_true_random=False))
def test_the_order_of_constraints_does_not_matter(
    given_constraints: list[tuple[int, int, int]], rng: random.Random
) -> None:
    one, other = Network(), Network()
    shuffled = given_constraints[:]
    rng.shuffle(shuffled)
    assert one.extend(given_constraints) == other.extend(shuffled)
    if one.consistent:
        assert {(i, j): one.relation(i, j) for i in range(6) for j in range(6)} == {
            (i, j): other.relation(i, j) for i in range(6) for j in range(6)
        }


@pytest.mark.parametrize("size", [30])
def test_a_network_drawn_from_a_world_is_consistent(size: int) -> None:
    rng = random.Random(1)
    times = {n: tuple(sorted(rng.sample(range(1000), 2))) for n in range(size)}
    network = Network()
    for i in range(size):
        for j in range(i + 1, size):
            if rng.random() < 6.5 / size:
                truth = base_relation((times[i][0], times[i][1]), (times[j][0], times[j][1]))
                assert network.constrain(i, j, rng.randrange(ALL + 1) | truth)
