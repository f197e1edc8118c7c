"""Races of cancelling that other systems are known for, by the issues that report them, in every interleaving.

    BehaviorTree.CPP #1031   the new action is started before the old one is halted: both run for a moment
    BehaviorTree.CPP #1117   an action that takes long to stop holds up the whole tree
    smach #53                a cancel that comes as the children have just ended is lost
    smach #98                ... or the outcome is not that of a cancel, for a child had its own already
    smach #88, yasmin #102   only the first cancel works: what runs after it cannot be cancelled
    yasmin #62               a cancel right at the start finds nothing to cancel, and nothing ever ends
    ros2_control #1756       what is deleted leaves its last command at the hardware

What is cancelled runs in the loser of a `#`, or under a root that is killed. What is asked holds of every order in
which the semantics lets things happen that are due at one instant (`interleavings`), a random pick of which is run by
any other test. The second half is about cancels of the reactor: adaptation, failed assumption, stop button.
"""

from __future__ import annotations

import itertools

import pytest

from planner_reactor.rs.parser import parse_process
from planner_reactor.runtime.guiding import GuidedScheduler
from tests.reactor.driving import FIRST, SECOND, Bench
from tests.reactor.interleavings import Stage, every_interleaving
from tests.reactor.races import IN_A_BODY, INSTANTS, TOGETHER, cancelled

DEPARTURES = 1
"""Where a body begins or ends there are up to half a million orders."""

ABORTED_AT = (0.0, 0.5, 1.0, 1.5, 2.0, 2.5, 3.9, 4.0)


def played(scheduler: GuidedScheduler, text: str) -> tuple[Stage, str | None]:
    """What a process comes to, and what its actions did."""
    stage = Stage(scheduler)
    root = stage.executer.start_process(parse_process(text))
    stage.executer.run(50.0)
    assert not stage.running
    assert stage.executer.statistics().basic_running == 0
    return stage, root.outcome


@pytest.mark.parametrize("changed", [0, 1, 2, 3])
def test_1031_the_old_action_is_over_before_the_new_one_begins(changed: float) -> None:
    def play(scheduler: GuidedScheduler) -> None:
        stage, _ = played(scheduler, f"((Act[old, 2] # Delay[{changed}]) ; Act[new, 1]) | (Delay[{changed}] ; STOP)")
        order = [how for _, how, name in stage.log if name in ("old", "new")]
        assert stage.together == 1
        assert order[-2:] == ["begun", "ended"]
        assert order[:-2] in ([], ["begun", "abandoned"], ["begun", "ended"])

    assert every_interleaving(play) > 1


def test_1117_what_takes_long_to_stop_holds_up_nobody_but_who_comes_after_it() -> None:
    def play(scheduler: GuidedScheduler) -> None:
        beside = "(Act[beside, 1] ; Act[beside2, 1] ; Act[beside3, 1])"
        text = f"((Act[old, 5] # Delay[1]) ; Act[stopping, 3] ; Act[new, 1]) | {beside}"
        stage, _ = played(scheduler, text)
        assert stage.times("abandoned", "old") == [1.0]
        assert stage.times("begun", "new") == stage.times("ended", "stopping") == [4.0]
        assert [stage.times("ended", n) for n in ("beside", "beside2", "beside3")] == [[1.0], [2.0], [3.0]]

    assert every_interleaving(play) > 1


@pytest.mark.parametrize("cancelled", [0.1, 0.3, 0.5])
def test_53_a_cancel_that_comes_as_the_children_end_is_not_lost(cancelled: float) -> None:
    def play(scheduler: GuidedScheduler) -> None:
        text = f"((Act[one, 0.3] | Act[other, 0.3]) ; Act[after, 5]) # Delay[{cancelled}]"
        stage, outcome = played(scheduler, text)
        assert outcome == "stop"
        assert stage.scheduler.now == max(time for time, _, _ in stage.log) == cancelled
        assert stage.times("ended", "after") == []
        for name in ("one", "other", "after"):
            assert len(stage.times("begun", name)) == len(stage.times("ended", name) + stage.times("abandoned", name))

    assert every_interleaving(play) > 1


@pytest.mark.parametrize("cancelled", [0.25, 0.3])
def test_98_the_outcome_is_that_of_the_cancel_unless_all_children_had_ended(cancelled: float) -> None:
    outcomes = set()

    def play(scheduler: GuidedScheduler) -> None:
        text = f"(Act[early, 0.2] & Act[late, 0.3]) # (Delay[{cancelled}] : ABORT)"
        stage, outcome = played(scheduler, text)
        outcomes.add(outcome)
        assert stage.times("ended", "early") == [0.2]
        assert outcome == ("stop" if stage.times("ended", "late") else "abort")
        assert stage.times("ended", "late") + stage.times("abandoned", "late") == [cancelled]

    assert every_interleaving(play) > 1
    assert outcomes == ({"abort"} if cancelled < 0.3 else {"stop", "abort"})


@pytest.mark.parametrize(("first", "second"), [(1, 1), (0, 1), (0, 0), (1, 0)])
def test_88_102_every_cancel_works_however_soon_it_follows_another(first: float, second: float) -> None:
    """`first` and `second`: seconds before each press of the button. Who presses waits until it is taken."""

    def play(scheduler: GuidedScheduler) -> None:
        states = "(Act[a, 9] # IN[cancel]<x>) ; (Act[b, 9] # IN[cancel]<y>) ; Act[c, 1]"
        presses = f"Delay[{first}] ; OUT[cancel, 1] ; Delay[{second}] ; OUT[cancel, 2]"
        stage, _ = played(scheduler, f"({states}) | ({presses})")
        assert stage.times("ended", "a") == stage.times("ended", "b") == []
        assert stage.times("ended", "c") == [first + second + 1]

    assert every_interleaving(play) > 1


@pytest.mark.parametrize("started", [0.0, 1.0])
def test_62_a_cancel_right_at_the_start_ends_what_is_started(started: float) -> None:
    """Both are due at one instant; killed before its first step, between any two, or behind them."""

    def play(scheduler: GuidedScheduler) -> None:
        stage = Stage(scheduler)
        roots = []

        def start() -> None:
            roots.append(stage.executer.start_process(parse_process("(Act[a, 2] | Act[b, 2]) ; Act[c, 2]")))
            scheduler.call_at(started, lambda: stage.executer.kill(roots[0]))

        scheduler.call_at(started, start)
        scheduler.run(20.0)
        assert [root.outcome for root in roots] == ["abort"]
        assert not stage.running
        assert {time for time, _, _ in stage.log} <= {started}
        assert stage.executer.processes_live == 0

    assert every_interleaving(play) > 1


@pytest.mark.parametrize("order", list(itertools.permutations(("adapt", "fail", "halt"))))
@pytest.mark.parametrize("at", ABORTED_AT)
def test_whatever_comes_first_at_one_instant_nothing_is_left_running(at: float, order: tuple[str, ...]) -> None:
    """An adaptation, the failure of an assumption, and the stop button at the same instant, in every order."""
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


@pytest.mark.parametrize("at", INSTANTS)
@pytest.mark.parametrize("what", TOGETHER)
def test_cancels_at_one_instant_of_a_reactor(at: float, what: tuple[str, ...]) -> None:
    """In a body every order; where one begins or ends those with so many departures (`make races`: every order)."""
    departures = None if at == IN_A_BODY else DEPARTURES
    assert every_interleaving(lambda scheduler: cancelled(scheduler, at, what), at=at, departures=departures) > 1


@pytest.mark.parametrize("at", ABORTED_AT)
def test_1031_a_new_reaction_does_not_serve_before_the_old_is_over(at: float) -> None:
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


def test_1756_what_is_aborted_is_abandoned_once() -> None:
    bench = Bench()
    bench.at(0.0, FIRST)
    bench.run(1.0)
    bench.reactor.halt()
    bench.reactor.halt()
    bench.run(5.0)
    assert bench.abandoned == ["old"]
