"""Every reactor of the 2⁹ sets runs in the cell, with its assumptions true and false: the experiment in small."""

from __future__ import annotations

from planner_reactor.experiments.assumptions import one
from planner_reactor.experiments.every_reactor import distinct, planned, subsets, summary, trials_of
from planner_reactor.experiments.runs import the_domain

SOME = [("ACT", "AO"), ("AS", "AF", "ADD"), ("AQ", "ACP", "ADT", "AM")]


def test_there_are_512_sets_and_some_lead_to_one_reactor() -> None:
    assert len(list(subsets())) == 512
    found = distinct(iter([(), ("AF",), ("ACP",), ("AF", "ACP")]))
    assert list(found) == [(), ("AF",), ("ACP",)]  # without both it is as it is without ACP


def test_a_reactor_rests_on_nothing_that_was_given_up() -> None:
    for names in SOME:
        assert not planned(the_domain(), names)[1] & set(names)


def test_reactors_work_where_their_own_assumptions_hold_and_where_all_do() -> None:
    found = distinct(iter(SOME))
    assert len(found) == len(SOME)
    said = summary([one(trial) for trial in trials_of(found, [2])], len(found))
    assert said["failed"] == []
    true, all_true, false = said["worlds"]
    assert true["work"] == all_true["work"] == len(SOME)
    assert true["lost"] == all_true["lost"] == 0
    assert all(world["violations"] == world["interruptions"] == 0 for world in said["worlds"])
    assert false["fewest"] >= 1  # whatever it began with, it is adapted, and comes to complete something
