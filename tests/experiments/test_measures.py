"""What is read off a trace, in memory or from a file."""

from __future__ import annotations

from pathlib import Path

import pytest
from msgspec.structs import replace

from planner_reactor.experiments.measures import Measures, measure
from planner_reactor.experiments.papers_run import Replay
from planner_reactor.trace import Event, JsonLines, read
from planner_reactor.workcell import telling


def test_a_trace_from_a_file_measures_the_same(replayed: Replay, tmp_path: Path) -> None:
    lines = JsonLines(tmp_path / "run.jsonl")
    for event in replayed.theirs.loop.trace.events:
        lines(event)
    lines.close()
    again = measure(read(tmp_path / "run.jsonl"), verdict=telling.verdict)
    assert again == replayed.on_their_clock


def test_an_empty_trace_has_measures_too() -> None:
    nothing = measure([])
    assert (nothing.first_issued, nothing.ideal, nothing.lags, nothing.relaxed) == (None, None, (), ())
    assert nothing.m.plateaus() == (0,)


def test_measures_agree_with_what_the_run_says_of_itself(replayed: Replay) -> None:
    for ran, m in ((replayed.theirs, replayed.on_their_clock), (replayed.ours, replayed.on_ours)):
        said = ran.came_to
        assert m.issued.at(m.end) == said["adaptations"]["issued"]
        assert m.changes.at(m.end) == said["changes_applied"]
        assert (m.first_issued, m.first_applied, m.ideal) == (
            said["first_adaptation_issued_s"], said["first_reactor_s"], said["first_ideal_s"],
        )  # fmt: skip
        assert len(m.stub_triggers) == said["stub_triggers"]
        assert m.planner.at(m.end) == set(said["assumptions"]["planner"])
        assert m.reactor.at(m.end) == set(said["assumptions"]["reactor"])
        assert telling.counted(said) == (m.completed.at(m.end), m.rejected.at(m.end))
        told = [(r["assumption"], r["cause"], r["decided_s"], r["issued_s"]) for r in said["relaxations"]]
        assert told == [(r.assumption, r.cause, r.decided, r.issued[-1]) for r in m.relaxed]


def test_a_relaxation_knows_its_signals_and_what_it_took(replayed: Replay) -> None:
    m = replayed.on_their_clock
    normal, forced, back = m.relaxation("normal", "AQ"), m.relaxation("forced", "AM"), m.relaxation("reinstated")
    assert normal is not None
    assert forced is not None
    assert back is not None
    assert normal.signalled is None
    assert forced.signalled is not None
    assert forced.signalled <= forced.decided < forced.issued[0]
    assert forced.silent is not None
    assert forced.silent <= max(forced.applied)
    assert back.signalled == pytest.approx(358.0, abs=1.0)
    assert m.relaxation("forced", "AO") is None


def test_without_an_answer_to_its_last_adaptation_a_relaxation_has_no_response(replayed: Replay) -> None:
    events = replayed.theirs.loop.trace.events
    m = replayed.on_their_clock
    forced = m.relaxation("forced", "AM")
    assert forced is not None
    cut = measure([e for e in events if e.time < max(forced.applied)])
    again = cut.relaxation("forced", "AM")
    assert again is not None
    assert again.response is None
    assert again.issued == forced.issued


def test_the_reactor_uses_what_was_brought_in_before_anything_rests_on_it(replayed: Replay) -> None:
    """R §9.2.1: the first reactor requires six assumptions, though its reactions rest on three."""
    m = replayed.on_their_clock
    assert m.first_applied is not None
    assert m.reactor.at(m.first_applied) == m.planner.at(m.first_applied)
    (first,) = [e for e in replayed.theirs.loop.trace.of("adaptation_issued") if e.data["id"] == 1]
    rested_on = {assumption for named in first.data["rests_on"].values() for assumption in named}
    assert rested_on < m.reactor.at(m.first_applied)


def test_a_cut_reaction_would_be_counted(replayed: Replay) -> None:
    """Seeded defect: a body that is cut off is seen."""
    events = replayed.theirs.loop.trace.events
    place = next(n for n, e in enumerate(events) if e.kind == "left")
    left = events[place]
    broken: list[Event] = [*events[:place], Event(left.number, left.time, left.kind, {**left.data, "cut": True})]
    assert measure(broken).interruptions == 1


def test_measures_are_values(replayed: Replay) -> None:
    m: Measures = replayed.on_their_clock
    assert replace(m, interruptions=0) == m
