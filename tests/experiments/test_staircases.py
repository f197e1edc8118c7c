"""Quantities that change at instants."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from planner_reactor.experiments.staircases import Staircase

TIMES = st.lists(st.integers(0, 50).map(float), max_size=30).map(sorted)


def test_it_keeps_its_value_until_the_next_change() -> None:
    stairs = Staircase.through([(1.0, 4.0), (3.0, 2.0)])
    assert [stairs.at(t) for t in (0.0, 0.999, 1.0, 2.9, 3.0, 99.0)] == [0, 0, 4, 4, 2, 2]


def test_of_several_changes_at_one_instant_the_last_counts() -> None:
    assert Staircase.through([(1.0, 4.0), (1.0, 7.0), (2.0, 7.0)]).at(1.0) == 7


@given(TIMES, st.integers(0, 50))
def test_counting_counts_what_has_happened(times: list[float], now: int) -> None:
    assert Staircase.counting(times).at(now) == sum(t <= now for t in times)


@given(TIMES, st.integers(0, 25), st.integers(26, 50))
def test_its_corners_say_the_same_as_it_does(times: list[float], begin: int, end: int) -> None:
    stairs = Staircase.counting(times)
    corners = list(stairs.steps(begin, end))
    assert corners[0] == (begin, stairs.at(begin))
    assert corners[-1] == (end, stairs.at(end))
    assert all(value == stairs.at(time) for time, value in corners)


def test_when_it_first_reaches_a_value() -> None:
    stairs = Staircase.through([(1.0, 4.0), (3.0, 2.0), (5.0, 6.0)])
    assert stairs.reaches(3.0) == 1.0
    assert stairs.reaches(3.0, after=3.0) == 5.0
    assert stairs.reaches(9.0) is None


def test_its_plateaus_in_order() -> None:
    assert Staircase.through([(0.0, 9.0), (1.0, 8.0), (1.0, 7.0), (4.0, 9.0)]).plateaus() == (9, 7, 9)
    assert Staircase.through([(2.0, 1.0)]).plateaus() == (0, 1)
