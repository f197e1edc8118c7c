"""Transition systems say what `evolves` says, and where it ends."""

from __future__ import annotations

import pytest

from planner_reactor.analysis.explore import explore
from planner_reactor.analysis.transitions import Transitions, build
from planner_reactor.errors import BudgetError
from planner_reactor.rs.configurations import World
from planner_reactor.rs.evolves import started
from planner_reactor.rs.parser import parse_process
from planner_reactor.rs.vocabulary import BUILT_IN, Signature

OPEN = (0.0, float("inf"))
WORLD = World(signatures={**BUILT_IN, **{n: Signature(n, window=OPEN) for n in "abc"}})


def built(text: str, limit: int = 1_000) -> Transitions:
    return build(started(parse_process(text), WORLD), WORLD, limit=limit)


def test_a_process_that_waits_for_ever_is_a_deadlock_and_its_path_is_a_shortest_one() -> None:
    found = built("(a ; b ; IN[p]<x>) | (a : OUT[q, 1])")
    assert found.deadlocks
    assert all(len(found.path(n)) == 3 for n in found.deadlocks[:1])


def test_an_end_of_all_roots_is_no_deadlock() -> None:
    found = built("a | b")
    assert found.ends
    assert not found.deadlocks


def test_it_has_the_states_and_moves_that_exploration_has() -> None:
    config = started(parse_process("(a ; OUT[p, 1]) | (IN[p]<x> :; b) | (c # Delay[2])"), WORLD)
    slow, fast = explore(config, WORLD), build(config, WORLD)
    assert len(slow.states) == len(fast)
    assert sum(map(len, slow.moves)) == fast.size


def test_a_limit_is_an_error_that_names_it() -> None:
    with pytest.raises(BudgetError, match="more than 10 states"):
        built("a | b | c | a | b", limit=10)
