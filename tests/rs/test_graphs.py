"""Graphs: reachability, cycles and fixed points against their definitions."""

from __future__ import annotations

from itertools import pairwise

from hypothesis import given, settings
from hypothesis import strategies as st

from planner_reactor.rs.graphs import cycles, reachable, solve, way_round

GRAPHS = st.dictionaries(st.integers(0, 7), st.lists(st.integers(0, 7), max_size=4).map(tuple), max_size=8)
EXAMPLES = settings(max_examples=150, deadline=None)


def follows(graph: dict[int, tuple[int, ...]], one: int, other: int) -> bool:
    """Is there a way of at least one edge?"""
    return other in reachable(graph, graph.get(one, ()))


@given(GRAPHS)
@EXAMPLES
def test_a_cycle_is_a_largest_set_of_nodes_that_reach_each_other(graph: dict[int, tuple[int, ...]]) -> None:
    found = cycles(graph)
    on_cycles = [n for n in graph if follows(graph, n, n)]
    assert sorted(n for cycle in found for n in cycle) == sorted(on_cycles)
    for cycle in found:
        together = [n for n in on_cycles if follows(graph, n, cycle[0]) and follows(graph, cycle[0], n)]
        assert cycle == together


@given(GRAPHS)
@EXAMPLES
def test_the_way_round_follows_edges_back_to_its_start(graph: dict[int, tuple[int, ...]]) -> None:
    for cycle in cycles(graph):
        way = way_round(graph, cycle[0])
        assert way[0] == way[-1] == cycle[0]
        assert len(way) >= 2
        assert all(after in graph[before] for before, after in pairwise(way))


@given(GRAPHS)
@EXAMPLES
def test_the_solution_of_reachability_is_reachability(graph: dict[int, tuple[int, ...]]) -> None:
    nothing: frozenset[int] = frozenset()
    found = solve(
        graph,
        nothing,
        lambda n, known: frozenset(graph[n]).union(*(known.get(f, nothing) for f in graph[n])),
    )
    assert found == {n: frozenset(reachable(graph, graph[n])) for n in graph}
