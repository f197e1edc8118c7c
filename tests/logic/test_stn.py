"""Simple temporal networks: distances are shortest paths, contradictions are negative circles."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from planner_reactor.logic.stn import TICKS, TimeNetwork, milliseconds, ticks

SIZE = 5
Bound = tuple[int, int, int]
bounds = st.lists(
    st.tuples(st.integers(0, SIZE - 1), st.integers(0, SIZE - 1), st.integers(-4, 9)).filter(lambda b: b[0] != b[1]),
    max_size=12,
)


def network(said: list[Bound]) -> TimeNetwork:
    times = TimeNetwork()
    for _ in range(SIZE):
        times.point()
    all(times.bound(p, q, most, 1 << n) for n, (p, q, most) in enumerate(said))
    return times


def shortest(said: list[Bound]) -> list[list[float]] | None:
    """Floyd and Warshall; None if there is a negative circle."""
    far = [[0.0 if p == q else float("inf") for q in range(SIZE)] for p in range(SIZE)]
    for p, q, most in said:
        far[p][q] = min(far[p][q], most)
    for k in range(SIZE):
        for p in range(SIZE):
            for q in range(SIZE):
                far[p][q] = min(far[p][q], far[p][k] + far[k][q])
    return None if any(far[p][p] < 0 for p in range(SIZE)) else far


@given(bounds)
def test_distances_are_shortest_paths(said: list[Bound]) -> None:
    times, truth = network(said), shortest(said)
    assert times.consistent == (truth is not None)
    if truth is not None:
        for p in range(SIZE):
            for q in range(SIZE):
                far = times.far(p, q)
                assert (float("inf") if far is None else far) == truth[p][q]


@given(bounds)
def test_reasons_are_the_bounds_of_a_path_and_of_a_negative_circle(said: list[Bound]) -> None:
    times = network(said)
    if not times.consistent:
        circle = [bound for n, bound in enumerate(said) if times.conflict >> n & 1]
        assert sum(most for _, _, most in circle) < 0
        assert shortest(circle) is None
        return
    for p in range(SIZE):
        for q in range(SIZE):
            path = [bound for n, bound in enumerate(said) if times.why(p, q) >> n & 1]
            assert p == q or sum(most for _, _, most in path) == (times.far(p, q) or 0)


@given(bounds)
def test_a_solution_keeps_every_bound(said: list[Bound]) -> None:
    wide = [(p, q, most << 24) for p, q, most in said]
    times = network(wide)
    if times.consistent:
        at = times.solution()
        assert all(at[q] - at[p] <= most for p, q, most in wide)


@given(bounds, bounds)
def test_undo_returns_to_the_mark(said: list[Bound], more: list[Bound]) -> None:
    times = network(said)
    if not times.consistent:
        return
    before = [[times.far(p, q) for q in range(SIZE)] for p in range(SIZE)]
    mark = times.mark()
    all(times.bound(p, q, most, 1 << 30) for p, q, most in more)
    times.undo(mark)
    assert times.consistent
    assert before == [[times.far(p, q) for q in range(SIZE)] for p in range(SIZE)]


def test_a_millisecond_is_exact_and_strictly_less_is_less_by_one_tick() -> None:
    assert ticks(6500.5) == 6500.5 * TICKS
    assert milliseconds(ticks(0.1) * 10) == 1.0
    times = TimeNetwork()
    start, end = times.point(), times.point()
    assert times.bound(start, end, ticks(5))
    assert times.bound(end, start, -ticks(5))
    assert not times.bound(end, start, -ticks(5) - 1)
