"""The complete search agrees with brute force over end points, also where path consistency is too weak."""

from __future__ import annotations

from itertools import combinations, product

from hypothesis import given, settings
from hypothesis import strategies as st

from planner_reactor.logic.allen import BASES, BIT, base_relation, relations
from planner_reactor.logic.network import Network
from planner_reactor.logic.scenarios import holds_in, is_consistent, scenario, timeline

SIZE = 4
_SPANS = list(combinations(range(2 * SIZE), 2))


def brute_force(network: Network) -> bool:
    """Is there any way to lay the intervals on a line (2n points suffice)?"""
    named = network.intervals
    edges = [(named.index(i), named.index(j), relation) for i, j, relation in network.edges()]

    def lay(chosen: list[tuple[int, int]]) -> bool:
        if len(chosen) == len(named):
            return True
        here = len(chosen)
        for span in _SPANS:
            if all(
                base_relation(chosen[i] if i < here else span, chosen[j] if j < here else span) & relation
                for i, j, relation in edges
                if max(i, j) == here
            ) and lay([*chosen, span]):
                return True
        return False

    return lay([])


@st.composite
def networks(draw: st.DrawFn) -> Network:
    network = Network()
    for i in range(SIZE):
        network.add(i)
    for i, j in combinations(range(SIZE), 2):
        base = st.sampled_from(BASES)
        network.constrain(i, j, relations(draw(st.lists(base, min_size=1, max_size=4))))
    return network


@settings(max_examples=150)
@given(networks())
def test_the_verdict_is_that_of_brute_force(network: Network) -> None:
    assert is_consistent(network) == (network.consistent and brute_force(network))


@settings(max_examples=150)
@given(networks())
def test_a_timeline_satisfies_the_network(network: Network) -> None:
    times = timeline(network)
    if times is not None:
        assert holds_in(network, times)
        found = scenario(network)
        assert found is not None
        for (i, j), name in found.items():
            assert base_relation(times[i], times[j]) == BIT[name]


def test_path_consistency_alone_is_not_enough() -> None:
    network = Network()
    network.extend(
        [
            ("A", "B", relations(["m", "di"])),
            ("A", "C", relations(["o"])),
            ("A", "D", relations(["s", "fi"])),
            ("B", "C", relations(["o", "f"])),
            ("B", "D", relations(["oi", "s"])),
            ("C", "D", relations(["di", "f"])),
        ]
    )
    assert network.consistent
    assert not brute_force(network)
    assert not is_consistent(network)


def test_many_disjoint_intervals_fit_on_a_line() -> None:
    network = Network()
    for i, j in combinations(range(6), 2):
        network.constrain(i, j, relations(["b", "bi", "m", "mi"]))
    times = timeline(network)
    assert times is not None
    assert all(times[i] != times[j] for i, j in product(range(6), repeat=2) if i != j)
