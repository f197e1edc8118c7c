"""M of R §9.2.3: the levels that follow from its formula, and its transients."""

from __future__ import annotations

from planner_reactor.experiments.improvement import Members, improvement

NINE = frozenset(["AQ", "AS", "AF", "ACT", "ACP", "ADT", "AM", "ADD", "AO"])
SIX = NINE - {"ACT", "ADD", "AO"}


def used(*points: tuple[float, frozenset[str]]) -> Members:
    return Members.through(points)


def test_the_levels_of_the_papers_run_follow_from_the_formula() -> None:
    """12 with six used by both, 18 when ideal, 20 and 22 when AQ and AS are given up by planner and reactor."""
    seven = NINE - {"AQ", "AS"}
    planner = used((26.0, SIX), (40.0, NINE), (80.0, seven), (165.0, seven - {"AM"}))
    reactor = used((26.0, SIX), (40.0, NINE), (104.0, seven), (166.0, seven - {"AM"}))
    failing = used((0.0, frozenset()), (152.0, frozenset({"AM"})))
    m = improvement(planner, reactor, failing)
    assert [m.at(t) for t in (0.0, 30.0, 50.0, 90.0, 110.0)] == [0, 12, 18, 20, 22]
    assert [m.at(t) for t in (154.0, 165.5, 170.0)] == [20, 22, 24]


def test_what_is_reinstated_is_not_retracted_any_more() -> None:
    both = used((0.0, SIX), (10.0, SIX - {"AM"}), (20.0, SIX))
    m = improvement(both, both, used((0.0, frozenset())))
    assert [m.at(t) for t in (5.0, 15.0, 25.0)] == [12, 14, 12]


def test_the_change_of_what_holds_lasts_for_a_tick_and_has_the_papers_sign() -> None:
    both = used((0.0, SIX))
    m = improvement(both, both, used((0.0, frozenset()), (10.0, frozenset({"AM"})), (20.0, frozenset())))
    assert [m.at(t) for t in (9.0, 10.0, 10.9, 11.0)] == [12, 11, 11, 10]  # two supports less, +1 for a tick
    assert [m.at(t) for t in (20.0, 21.0)] == [11, 12]  # supports are back, −1 for a tick


def test_members_are_those_of_the_last_change() -> None:
    members = used((1.0, SIX), (1.0, NINE), (3.0, SIX))
    assert members.at(0.5) == frozenset()
    assert (members.at(1.0), members.at(4.0)) == (NINE, SIX)
    assert members.ever(4.0) == NINE
    assert members.count.at(3.0) == 6
