"""One situation made concrete: what may be counted on, what follows for sub-situations, what looks wrong."""

from __future__ import annotations

import pytest

from planner_reactor.logic.formulas import Atom
from planner_reactor.logic.reader import read_domain
from planner_reactor.planner import Planner
from planner_reactor.planner.beliefs import Beliefs, in_doubt
from planner_reactor.planner.plan import Parameter
from planner_reactor.planner.reactions import Names
from planner_reactor.planner.refinement import refine
from planner_reactor.planner.situations import Context, Refinement, Situation
from planner_reactor.planner.structure import actions_of
from planner_reactor.planner.theory import Theory
from tests.planner.driving import KITTING, Book, kitting, settle, texts

DOMAIN = kitting()
THEORY = Theory(DOMAIN)
LACKS = Situation("Lacks", ("motor", None))
TRUSTED = Context((True, True, True), frozenset(), frozenset({"Kitting", "FillTray", "Lacks"}))


def lacks(*relaxed: str, context: Context = TRUSTED) -> Refinement:
    beliefs = Beliefs(DOMAIN, frozenset(relaxed))
    return refine(THEORY, beliefs, DOMAIN.schemas["Lacks"], LACKS, context, fold=True)


def names(refinement: Refinement) -> list[str]:
    assert refinement.tree is not None
    return [action.name for action in actions_of(refinement.tree)]


def test_a_refinement_says_what_it_rests_on_and_what_it_missed() -> None:
    trusting = lacks()
    assert names(trusting) == ["FindGetInsert"]
    assert trusting.required == {"AQ", "AS", "AF", "ACP", "ADT", "AM", "AO"}
    assert trusting.missing == frozenset()
    testing = lacks("AQ")
    assert names(testing) == ["FindGoodPart", "Insert"]
    assert testing.required == {"AF", "ACP", "ADT"}
    assert testing.missing == {"AQ"}


def test_what_no_caller_grants_is_not_counted_on() -> None:
    lost = Context((True, False, True), frozenset(), TRUSTED.forbidden)
    assert names(lacks(context=lost)) == ["LocateTray", "FindGetInsert"]
    assert names(lacks("ADT", context=lost)) == ["FindPart", "LocateTray", "Insert"]


def test_what_is_done_again_for_the_same_thing_may_not_assume_its_start() -> None:
    again = Context(TRUSTED.granted, frozenset({1}), TRUSTED.forbidden)
    assert names(lacks(context=again)) == ["SlotVacant", "FindGetInsert"]


def test_what_is_done_again_for_another_thing_may() -> None:
    assert names(lacks(context=Context(TRUSTED.granted, frozenset({0}), TRUSTED.forbidden))) == ["FindGetInsert"]


def test_an_action_higher_in_the_hierarchy_is_never_used() -> None:
    nothing_left = Context(TRUSTED.granted, frozenset(), TRUSTED.forbidden | {"FindGoodPart"})
    found = lacks("AQ", context=nothing_left)
    assert "FindGoodPart" not in names(found)
    assert found.blocked >= {"FindGoodPart"}


def test_a_sub_situation_learns_what_it_may_count_on() -> None:
    (child,) = lacks("AQ").children
    assert child.situation == Situation("FindGoodPart", ("motor",))
    assert child.arguments == ("motor",)
    assert child.granted == (True,)
    assert child.replayed == frozenset()


def test_results_are_never_taken_for_what_is_known_already() -> None:
    """AcquireTray could bring about the position of *a* tray, not of the one that a situation is about."""
    lost = Context((True, False, True), frozenset(), frozenset({"Kitting", "FillTray", "Lacks"}))
    assert "AcquireTray" not in names(lacks("AQ", context=lost))


def test_it_depends_on_nothing_but_its_arguments() -> None:
    assert lacks("AQ", "AF") == lacks("AQ", "AF")
    assert lacks("AQ").serves(frozenset({"AQ", "AM"}))
    assert not lacks("AQ").serves(frozenset())
    assert not lacks("AQ").serves(frozenset({"AQ", "AF"}))


def test_a_test_that_nothing_can_change_is_warned_of() -> None:
    """If it fails, its situation fails, and the retry tests the same thing again (livelock)."""
    asked_of_contents = "Contents(t) @ i1 and ITL(i1, [m o si e di fi], Verify)"
    asked_of_the_tray = "Instance(tray, t) @ i1 and ITL(i1, encompasses, Verify)"
    domain = read_domain(KITTING.read_text().replace(asked_of_contents, asked_of_the_tray))
    planner = Planner(domain, relax=("ACT",))
    settle(planner, Book(domain))
    assert any("Verify in" in warning and "fail for ever" in warning for warning in planner.warnings)


def test_two_actions_that_do_the_same_are_alternatives_not_parts_of_each_other() -> None:
    assert THEORY.alternatives["FindPart"] == {"FindGoodPart"}
    assert THEORY.alternatives["FindGoodPart"] == frozenset()


def test_constants_that_only_the_contents_rule_names_are_alike() -> None:
    assert THEORY.alike["motor"] == THEORY.alike["cap"] == THEORY.alike["body"]
    assert "tray" not in THEORY.alike


@pytest.mark.parametrize(
    ("name", "relaxed", "expected"),
    [
        ("A", {"A"}, True),
        ("A", {"B"}, False),
        ("A(x)", {"A"}, True),
        ("A(x)", {"A(x)"}, True),
        ("A(x)", {"A(y)"}, False),
        ("A", {"A(y)"}, True),
    ],
)
def test_an_assumption_is_relaxed_as_a_whole_or_in_part(name: str, relaxed: set[str], expected: bool) -> None:
    assert in_doubt(name, frozenset(relaxed)) == expected


def test_names_of_situations_are_unique_and_stay() -> None:
    known = Names()
    assert known[Situation("Lacks", ("motor", None))] == "LacksMotor"
    assert known[Situation("LacksMotor", (None,))] == "LacksMotor_2"
    assert known[Situation("Lacks", ("motor", None))] == "LacksMotor"
    assert known[Situation("camera-55", ())] == "camera_55"


def test_beliefs_are_values() -> None:
    beliefs = Beliefs(DOMAIN)
    assert beliefs.without("AQ").reinstated("AQ") == beliefs
    told = beliefs.learning(Atom("P", ("a",)), holds=True)
    assert told.known(Atom("P", ("a",))) is True
    assert told.learning(Atom("P", ("a",)), holds=False).known(Atom("P", ("a",))) is False
    assert beliefs.known(Atom("P", ("a",))) is None


def test_a_condition_lasts_as_long_as_its_assumptions() -> None:
    position = Atom("Position", (Parameter(0), "trayarea"))
    assert Beliefs(DOMAIN).lasting(position).used == {"ADT"}
    assert not Beliefs(DOMAIN, frozenset({"ADT"})).lasting(position).holds
    assert Beliefs(DOMAIN, frozenset({"ADT"})).lasting(Atom("Held", ("x",))).holds


def test_a_constant_that_looks_like_a_variable_is_quoted() -> None:
    text = KITTING.read_text().replace("motor", "x1")
    domain = read_domain(text)
    planner = Planner(domain, relax="none")
    settle(planner, Book(domain))
    assert 'FindGetInsert["x1", x1]' in texts(planner)["LacksX1"]
