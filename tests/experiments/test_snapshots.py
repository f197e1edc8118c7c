"""The reactor at an instant, rebuilt from the trace of its run."""

from __future__ import annotations

from planner_reactor.experiments.papers_run import Replay
from planner_reactor.experiments.snapshots import deed, of, reactor_at
from planner_reactor.rs.parser import parse_process
from planner_reactor.rs.terms import Call


def test_what_the_trace_says_is_what_is_there(replayed: Replay) -> None:
    for ran in (replayed.theirs, replayed.ours, replayed.relaxed):
        events, live = ran.loop.trace.events, of(ran.loop.reactor)
        rebuilt = reactor_at(events, events[-1].time)
        assert rebuilt.reactions == dict(sorted(live.reactions.items()))
        assert rebuilt.watched == live.watched
        assert {s: set(a) for s, a in rebuilt.rests_on.items() if a} == {s: set(a) for s, a in live.rests_on.items()}


def test_before_the_first_adaptation_the_reactor_is_null(replayed: Replay) -> None:
    assert not reactor_at(replayed.theirs.loop.trace.events, 25.0).reactions


def test_the_first_reactor_has_stubs_and_five_monitors(replayed: Replay) -> None:
    snapshot = reactor_at(replayed.theirs.loop.trace.events, 26.01)
    assert sorted(snapshot.reactions) == list(range(11))
    assert sum(r.stubs for r in snapshot.reactions.values()) == 2
    assert set(snapshot.watched) == {"AQ", "AS", "AF", "ACP", "ADT"}


def test_what_came_in_is_blamed_on_the_assumption_relaxed(replayed: Replay) -> None:
    events = replayed.relaxed.loop.trace.events
    because = reactor_at(events, events[-1].time).because
    assert because["FindGoodPartMotor"][""] == "AQ"
    assert because["FindGoodPartMotor"]["Choose motor"] == "AS"
    assert because["FinishTray"]["AwaitReady"] == "ADD"
    assert because["FillTray"]["Verify"] == "ACT"
    assert because["Kitting"]["REASSERT FillTray"] == ""


def test_a_deed_is_a_name_and_its_constants() -> None:
    call = parse_process("Put[cap, x, 3]<y>", bound=("x",))
    assert isinstance(call, Call)
    assert deed(call) == "Put cap 3"
