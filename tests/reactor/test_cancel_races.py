"""Races of cancelling that other systems are known for (issues of BehaviorTree.CPP, smach, yasmin, ros2_control).

Several things happen at one instant, in every order, at instants before, in and after a body; nothing may be left.
"""

from __future__ import annotations

import itertools

import pytest

from tests.reactor.driving import FIRST, SECOND, Bench

ABORTED_AT = (0.0, 0.5, 1.0, 1.5, 2.0, 2.5, 3.9, 4.0)


@pytest.mark.parametrize("order", list(itertools.permutations(("adapt", "fail", "halt"))))
@pytest.mark.parametrize("at", ABORTED_AT)
def test_whatever_comes_first_at_one_instant_nothing_is_left_running(at: float, order: tuple[str, ...]) -> None:
    """smach #53, #88, #98; yasmin #62, #102: a cancel beside the end, or beside another cancel, left a child running.

    An adaptation, the failure of an assumption, and the stop button at the same instant, in every order.
    """
    bench = Bench()
    bench.at(0.0, FIRST)
    bench.run(at)
    does = {
        "adapt": lambda: bench.reactor.receive(SECOND),
        "fail": lambda: bench.reactor.assumption_sensed("A", False),
        "halt": bench.reactor.halt,
    }
    for what in order:
        does[what]()
    bench.run(at + 20.0)
    assert bench.reactor.laws.violations == []
    assert bench.reactor.executer.statistics().basic_running == 0
    assert len(bench.times("entered")) == len(bench.times("left"))
    assert not bench.reactor.situations.instances


@pytest.mark.parametrize("at", ABORTED_AT)
def test_the_new_child_does_not_start_before_the_old_is_over(at: float) -> None:
    """BehaviorTree.CPP #1117, #1031: a reactive node started the new child before the old one was halted."""
    bench = Bench()
    bench.at(0.0, FIRST)
    bench.at(at, SECOND)
    bench.run(at + 20.0)
    serving = 0
    for event in bench.trace.of("entered", "left", "added"):
        if event.kind == "added":
            assert event.data["label"] != 4 or serving == 0
        elif event.data["situation"] == "part":
            serving += 1 if event.kind == "entered" else -1
            assert serving <= 1
    assert bench.times("adaptation_applied", id=2) or at == 0.0
    assert bench.reactor.laws.violations == []


def test_what_is_aborted_is_abandoned_once() -> None:
    """ros2_control #1756: what was deleted left its last command at the hardware."""
    bench = Bench()
    bench.at(0.0, FIRST)
    bench.run(1.0)
    bench.reactor.halt()
    bench.reactor.halt()
    bench.run(5.0)
    assert bench.abandoned == ["old"]
