"""The shapes of R Figs 12 to 19, on the papers' clock: what must be seen in any run that replays theirs."""

from __future__ import annotations

import pytest

from planner_reactor.experiments.comparison import levels, setbacks
from planner_reactor.experiments.measures import Change, Measures
from planner_reactor.experiments.papers_run import Replay


@pytest.fixture
def m(replayed: Replay) -> Measures:
    return replayed.on_their_clock


def change(m: Measures, cause: str, assumption: str) -> Change:
    found = m.relaxation(cause, assumption)
    assert found is not None
    return found


def test_no_law_is_broken_and_nothing_is_interrupted(replayed: Replay) -> None:
    assert replayed.theirs.came_to["violations"] == []
    assert replayed.on_their_clock.interruptions == 0
    assert replayed.theirs.unstruck == ()


def test_the_planner_works_first_and_the_reactor_is_null(m: Measures) -> None:
    assert m.first_issued == pytest.approx(26.0)
    assert m.changes.at(25.9) == 0
    assert m.first_applied is not None
    assert m.first_applied >= m.first_issued


def test_the_robot_acts_before_its_program_is_complete(m: Measures) -> None:
    assert m.first_action is not None
    assert m.ideal is not None
    assert m.first_action == m.first_applied
    assert m.first_action < m.ideal - 10.0


def test_the_first_reactor_uses_six_assumptions_and_the_first_ideal_one_nine(m: Measures) -> None:
    assert m.first_applied is not None
    assert m.ideal == pytest.approx(40.0, abs=2.0)
    assert m.reactor.count.at(m.first_applied) == 6
    assert m.reactor.count.at(m.ideal or 0.0) == m.planner.count.at(m.ideal or 0.0) == 9


def test_no_stub_is_reached_before_the_first_ideal_reactor(m: Measures) -> None:
    assert m.stubs_before_ideal == 0


def test_the_count_of_the_planner_rises_gradually_while_it_builds(m: Measures) -> None:
    rising = [v for t, v in zip(m.planner.count.times, m.planner.count.values, strict=True) if t <= (m.ideal or 0.0)]
    assert rising == sorted(rising)
    assert len(rising) >= 3


def test_issuing_is_steep_while_the_reactor_changes_and_flat_otherwise(m: Measures) -> None:
    """Nothing is issued between the last normal relaxation, the failures and the reinstatement."""
    quiet = [(change(m, "normal", "AS").issued[-1], change(m, "forced", "AM").began)]
    quiet.append((change(m, "forced", "AM").issued[-1], change(m, "forced", "ADD").began))
    quiet.append((change(m, "forced", "ADD").issued[-1], change(m, "reinstated", "ADD").began))
    for begin, end in quiet:
        assert end - begin > 20.0
        assert m.issued.at(begin) == m.issued.at(end)
    building = (m.issued.at(46.1) - m.issued.at(25.9)) / 20.2
    assert building > 10 * m.issued.at(m.end) / m.end / 5  # far steeper than on the average


def test_changes_trail_the_adaptations_and_soon_exceed_them_in_number(m: Measures) -> None:
    """There is at least one change for each adaptation, never before it."""
    assert all(lag.applied >= lag.issued for lag in m.lags)
    assert all(m.changes.at(lag.applied) > m.issued.at(lag.issued) for lag in m.lags)


def test_an_adaptation_waits_only_for_a_situation_that_runs_to_its_end(replayed: Replay, m: Measures) -> None:
    """What lags is applied in the instant in which the last running instance of its situations ends."""
    events = replayed.theirs.loop.trace.events
    slow = [lag for lag in m.lags if lag.seconds > 0.1]
    assert slow
    for lag in slow:
        ended = {e.data["situation"] for e in events if e.kind == "completed" and e.time == lag.applied}
        assert ended & set(lag.situations)


def test_situations_that_an_adaptation_does_not_name_are_not_held_up(replayed: Replay, m: Measures) -> None:
    events = replayed.theirs.loop.trace.events
    named = {s for lag in m.lags for s in lag.situations}
    drained = {e.data["situation"] for e in events if e.kind == "draining"}
    assert drained <= named
    assert "Kitting" not in drained


def test_the_reactor_never_drops_an_assumption_before_the_planner_does(m: Measures) -> None:
    for name in ("AQ", "AS", "AM", "ADD"):
        planner = next(t for t in m.planner.times if name in m.planner.ever(t) - m.planner.at(t))
        reactor = next(t for t in m.reactor.times if name in m.reactor.ever(t) - m.reactor.at(t))
        assert planner <= reactor


def test_the_planner_relaxes_soon_and_the_reactor_follows_late_with_both_together(m: Measures) -> None:
    """R Fig. 14: 6 s of planning for AQ, the count of the reactor is flat from 40 s to 103 s, and drops twice."""
    quality, substitution = change(m, "normal", "AQ"), change(m, "normal", "AS")
    assert quality.thinking == pytest.approx(6.0, abs=0.1)
    assert substitution.thinking is not None
    assert substitution.thinking >= 30.0
    assert m.reactor.count.at(100.0) == 9
    assert m.reactor.count.at(115.0) == 7
    assert max(quality.applied) == pytest.approx(104.0, abs=6.0)
    assert m.changes.at(103.0) > m.changes.at(75.0) > m.changes.at(46.0)  # smeared over all this time


def test_things_are_made_while_the_program_is_rewritten(m: Measures) -> None:
    assert m.completed.at(160.0) >= 1
    assert m.rejected.at(m.end) == 0


def test_failure_signals_come_in_two_slopes_with_stable_regimes_between(m: Measures) -> None:
    motion, downstream = change(m, "forced", "AM"), change(m, "forced", "ADD")
    assert m.failures.at(motion.began - 0.1) == 0
    assert m.failures.at(motion.silent or 0.0) >= 5
    assert m.failures.at(motion.silent or 0.0) == m.failures.at(downstream.began - 0.1)
    assert m.failures.at(downstream.silent or 0.0) == m.failures.at(m.end)  # reinstating is no failure


def test_signals_end_while_the_adaptation_is_under_way(m: Measures) -> None:
    for name in ("AM", "ADD"):
        forced = change(m, "forced", name)
        assert forced.silent is not None
        assert forced.began < forced.silent <= max(forced.applied)


def test_the_planner_answers_a_failure_in_three_seconds_and_issues_for_ten(m: Measures) -> None:
    motion = change(m, "forced", "AM")
    assert motion.issued[0] - motion.began == pytest.approx(3.0, abs=0.1)
    assert motion.issued[-1] - motion.issued[0] == pytest.approx(10.0, abs=0.1)
    assert motion.response == pytest.approx(14.0, abs=3.0)  # 11 or 14 s in the papers


def test_the_failures_are_those_of_the_papers_when_they_can_strike(m: Measures) -> None:
    assert change(m, "forced", "AM").began >= 152.0
    assert change(m, "forced", "ADD").began == pytest.approx(215.0, abs=2.1)
    assert change(m, "reinstated", "ADD").began == pytest.approx(357.0, abs=2.1)


def test_a_reinstated_assumption_is_used_by_both_again(m: Measures) -> None:
    assert "ADD" not in m.planner.at(300.0) | m.reactor.at(300.0)
    assert "ADD" in m.planner.at(m.end) & m.reactor.at(m.end)


def test_m_has_the_levels_of_the_formula(m: Measures) -> None:
    found = levels(m)
    expected = (12, 18, 22, 20, 22, 24, 26, 24)
    places = [found.index(expected[0])]
    for level in expected[1:]:
        places.append(found.index(level, places[-1] + 1))
    assert places == sorted(places)
    assert found[-1] == 24


def test_improvement_is_set_back_three_times(m: Measures) -> None:
    began = [change(m, "forced", "AM").began, change(m, "forced", "ADD").began, change(m, "reinstated", "ADD").began]
    assert list(setbacks(m)) == pytest.approx(began, abs=1.0)


def test_on_our_own_clock_the_shapes_are_the_same_and_the_times_are_milliseconds(replayed: Replay) -> None:
    ours = replayed.on_ours
    assert ours.first_issued is not None
    assert ours.ideal is not None
    assert ours.first_issued < 0.1
    assert ours.ideal < 0.5
    assert ours.stubs_before_ideal == 0
    assert len(setbacks(ours)) == 3
    assert ours.completed.at(ours.end) > replayed.on_their_clock.completed.at(ours.end)
