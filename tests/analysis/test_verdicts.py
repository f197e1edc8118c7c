"""Deadlocks, Zeno cycles, livelocks and situations without end, each by a shortest way."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from planner_reactor.analysis.lassos import Lasso
from planner_reactor.analysis.transitions import Transitions, build
from planner_reactor.analysis.verdicts import deadlock, endless, livelock, zeno
from planner_reactor.calls.replaying import replay
from planner_reactor.errors import BudgetError
from planner_reactor.rs.parser import parse_process
from tests.analysis.nets import Nets, begun


def built(text: str) -> Transitions:
    return build(*begun(text))


def test_a_deadlock_is_found_by_a_shortest_way() -> None:
    found = deadlock(built("(a ; a ; IN[p]<x>) # (a ; NIL) # (a ; a ; a)"))
    assert found is None  # someone always ends
    stuck = deadlock(built("(a ; b ; IN[p]<x>) | (a ; OUT[q, 1])"))
    assert stuck is not None
    assert len(stuck.prefix) == 3
    assert deadlock(built("OUT[p, 1] | IN[p]<x>")) is None


def test_stream_without_a_quantum_is_zeno_and_with_one_it_is_not() -> None:
    printed = zeno(built("(OUT[p, 1] :; STOP) | (IN[p]<x> :; STOP)"))
    assert printed is not None
    assert [name for name, *_ in printed.cycle] == ["COM"]
    assert zeno(built("((OUT[p, 1] ; Delay[1]) :; STOP) | (IN[p]<x> :; STOP)")) is None


def test_a_basic_process_that_may_take_its_time_is_no_zeno_cycle() -> None:
    assert zeno(built("a :; STOP")) is None


def test_a_livelock_is_where_nothing_but_inner_steps_is_left() -> None:
    found = livelock(built("a ; ((OUT[p, 1] :; STOP) | (IN[p]<x> :; STOP))"))
    assert found is not None
    assert [name for name, *_ in found.prefix] == ["a"]
    assert found.cycle
    assert livelock(built("(a ; OUT[p, 1] :; STOP) | (IN[p]<x> :; STOP)")) is None


def test_a_situation_that_nobody_ends_is_endless_from_the_step_that_asserts_it() -> None:
    printed = built("(a :; ASSERT[s]) | (SIT[s]<k> :; a)")
    found = endless(printed, "s")
    assert found is not None
    assert [name for name, *_ in found.prefix] == ["a", "ASSERT"]
    assert endless(built("(a :; ASSERT[s]) | (SIT[s]<k> :; SUCCEED[s, k])"), "s") is None


def test_counterexamples_run_in_the_executer() -> None:
    """Of random nets: every deadlock, and every Zeno cycle three times round."""
    found: dict[str, int] = {"deadlock": 0, "zeno": 0}
    for seed in range(45):
        text = Nets(seed, delays=seed % 2 == 1).text()
        config, world = begun(text)
        try:
            whole = build(config, world, limit=600)
        except BudgetError:
            continue
        for name, way in (("deadlock", deadlock(whole)), ("zeno", zeno(whole))):
            if way is not None:
                found[name] += 1
                labels = (*way.prefix, *way.cycle * 3)
                assert replay([parse_process(text)], world, labels).done, (seed, text, labels)
    assert found["deadlock"] > 20
    assert found["zeno"] > 0


@pytest.mark.parametrize(
    ("text", "verdict"),
    [
        ("a ; ((OUT[p, 1] :; STOP) | (IN[p]<x> :; STOP))", livelock),
        ("(a :; ASSERT[s]) | (SIT[s]<k> :; a)", lambda found: endless(found, "s")),
    ],
)
def test_livelocks_and_endless_situations_run_in_the_executer(
    text: str, verdict: Callable[[Transitions], Lasso | None]
) -> None:
    config, world = begun(text)
    way = verdict(build(config, world))
    assert way is not None
    assert replay([parse_process(text)], world, (*way.prefix, *way.cycle * 3)).done


def test_what_the_semantics_does_not_allow_does_not_run() -> None:
    text = "(OUT[p, 1] ; a) | (IN[p]<x> ; b)"
    config, world = begun(text)
    labels = [label for label, _ in build(config, world).moves[0]]
    assert replay([parse_process(text)], world, labels).done
    assert not replay([parse_process(text)], world, [("a", (), "ok", ()), *labels]).done
