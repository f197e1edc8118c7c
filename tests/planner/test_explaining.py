"""Why every adaptation was issued: what set it off, which action is there for what, what rests on which assumption."""

from __future__ import annotations

import msgspec
import pytest

from planner_reactor.errors import InputError
from planner_reactor.link.messages import Adaptation
from planner_reactor.planner import Planner
from planner_reactor.planner.because import Because
from planner_reactor.planner.explaining import Explanation, Reasons
from tests.planner.driving import GREENHOUSE, Book, applied, kitting, perception, settle


def at_rest(**options: object) -> tuple[Planner, Book, list[Adaptation]]:
    domain = kitting()
    planner, book = Planner(domain, **{"relax": (), "verify": False, **options}), Book(domain, loads=False)  # type: ignore[arg-type]
    return planner, book, settle(planner, book)


def reasons(explanation: Explanation, situation: str) -> Reasons:
    return next(reasons for reasons in explanation.situations if reasons.situation == situation)


def test_the_first_adaptation_is_there_for_the_goal() -> None:
    planner, _, issued = at_rest()
    found = planner.explain(issued[0].id)
    assert found.because == (Because("goal", "Kitting"),)
    assert [reasons.situation for reasons in found.situations] == ["Kitting", "AcquireTray", "FindPartTray"]


def test_every_action_serves_something_and_in_the_words_of_the_text() -> None:
    planner, _, issued = at_rest()
    kitting_reasons = reasons(planner.explain(issued[0].id), "Kitting")
    serves = {step.action: step.serves for step in kitting_reasons.steps}
    assert "REASSERT[FillTray, x1]" in issued[0].definitions
    assert serves["FillTray[x1]"] == ("FullTray(x1)", "FullTray(x1) of FinishTray[x1]")
    for adaptation in issued:
        for found in planner.explain(adaptation.id).situations:
            assert all(step.serves for step in found.steps)


def test_a_refinement_is_there_because_its_caller_asserts_it() -> None:
    planner, _, issued = at_rest()
    assert planner.explain(issued[1].id).because == (Because("caller", "Kitting"),)


def test_the_assumptions_of_an_explanation_are_those_of_the_adaptation() -> None:
    """And for each it is said what rests on it."""
    planner, _, issued = at_rest()
    for adaptation in issued:
        found = {r.situation: r for r in planner.explain(adaptation.id).situations}
        for change in adaptation.changes:
            if change.situation in found:
                rests = dict(found[change.situation].rests_on)
                assert set(rests) == set(change.assumptions)
                assert all(rests.values()), (change.situation, rests)
    lacks = dict(reasons(planner.explain(issued[1].id), "LacksMotor").rests_on)
    assert lacks["AF"] == ("Vacant(x1, motor)",)
    assert lacks["AQ"] == ("FindGetInsert", "Good(something)")


def test_a_forced_relaxation_names_the_perception_that_told_of_it() -> None:
    planner, book, _ = at_rest()
    planner.perceive(msgspec.structs.replace(perception("assumption_failure", "AQ"), number=17))
    issued = settle(planner, book)
    assert issued
    for adaptation in issued:
        found = planner.explain(adaptation.id)
        assert found.because == (Because("forced", "AQ", 17),)
        assert "AQ has failed (perception 17)" in str(found)
        assert "AQ" in {name for r in found.situations for name in r.missed}


def test_a_stub_that_is_active_and_a_situation_that_fails_are_told() -> None:
    planner = Planner(kitting(), relax=(), verify=False)
    first = None
    while first is None:
        step = planner.step()
        first = step.adaptations[0] if step and step.adaptations else None
    planner.perceive(applied(first))
    planner.perceive(perception("stub_trigger", "FinishTray"))
    step = planner.step()
    assert step is not None
    assert step.situation == "FinishTray"
    (issued,) = step.adaptations
    assert set(planner.explain(issued.id).because) == {
        Because("caller", "Kitting"), Because("stub_trigger", "FinishTray", 1),
    }  # fmt: skip


def test_a_refusal_is_a_reason_to_plan_again() -> None:
    planner = Planner(kitting(), relax=(), verify=False)
    issued: list[Adaptation] = []
    while len(issued) < 2:
        step = planner.step()
        assert step is not None
        issued += step.adaptations
        if len(issued) == 1 and step.adaptations:
            planner.perceive(perception("adaptation_refused", str(issued[0].id), cause="text"))
    assert Because("adaptation_refused", str(issued[0].id)) in planner.explain(issued[1].id).because


def test_an_explanation_never_depends_on_what_happened_since() -> None:
    planner, book, issued = at_rest()
    before = [planner.explain(adaptation.id) for adaptation in issued]
    for name in ("AQ", "ACT", "AM"):
        planner.perceive(perception("assumption_failure", name))
        settle(planner, book)
    assert [planner.explain(adaptation.id) for adaptation in issued] == before


def test_it_is_plain_data() -> None:
    domain = kitting(GREENHOUSE)
    planner = Planner(domain, relax="none", verify=False)
    for adaptation in settle(planner):
        found = planner.explain(adaptation.id)
        assert msgspec.convert(msgspec.to_builtins(found), Explanation) == found


def test_what_was_never_issued_cannot_be_explained() -> None:
    planner, _, issued = at_rest()
    with pytest.raises(InputError, match=f"no adaptation 99, the last is {issued[-1].id}"):
        planner.explain(99)
