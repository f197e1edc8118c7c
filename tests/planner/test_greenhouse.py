"""A second domain, on the same planner: goals for known things, perception requests, cleanup after
failures.
"""

from __future__ import annotations

import pytest

from planner_reactor.link.messages import Adaptation
from planner_reactor.logic.domain import Domain
from planner_reactor.logic.reader import check_domain, read_domain
from planner_reactor.planner import Planner
from tests.planner.driving import (
    GREENHOUSE,
    Book,
    applied,
    image,
    kitting,
    perception,
    planner_without,
    settle,
    texts,
)


@pytest.fixture(scope="module")
def domain() -> Domain:
    return kitting(GREENHOUSE)


def test_the_domain_is_without_fault() -> None:
    assert check_domain(GREENHOUSE.read_text()) == ()


def test_a_goal_for_everything_that_is_known_is_asserted_for_each(domain: Domain) -> None:
    planner = Planner(domain, relax="none")
    settle(planner, Book(domain))
    assert texts(planner)["Greenhouse"] == (
        "SIT[Greenhouse]<k> :; (~((REASSERT[TendFern] & REASSERT[TendBasil] & REASSERT[TendFig]) : "
        "SUCCEED[Greenhouse, k]) : FAIL[Greenhouse, k])"
    )


def test_what_a_failure_would_leave_behind_is_cleaned_up(domain: Domain) -> None:
    """Only from the action on that upsets it: the can may be in use elsewhere before."""
    planner = Planner(domain, relax="none")
    settle(planner, Book(domain))
    assert texts(planner)["TendFern"] == (
        "SIT[TendFern]<k> :; (~(TakeCan : (if Fill : Pour[fern] : HangUp then SUCCEED[TendFern, k] "
        "else PutAway ; ABORT)) : FAIL[TendFern, k])"
    )


def test_what_held_at_the_start_is_brought_about_again_at_the_end(domain: Domain) -> None:
    """HangUp is in no goal: it follows from the condition under which Tend may be asserted."""
    planner = Planner(domain, relax="none")
    settle(planner)
    assert "HangUp" in texts(planner)["TendFig"]


def test_a_test_whose_failure_says_enough_has_an_else_branch(domain: Domain) -> None:
    planner = planner_without(domain, ["DRY"])
    settle(planner, Book(domain))
    assert "if Feel[fern] then TakeCan : (if" in texts(planner)["TendFern"]
    assert "else SUCCEED[TendFern, k])" in texts(planner)["TendFern"]


def test_a_fact_that_lasts_on_an_assumption_is_sensed_anew_without_it(domain: Domain) -> None:
    planner = planner_without(domain, ["STILL"])
    settle(planner, Book(domain))
    assert "LookFor[fern] : Pour[fern]" in texts(planner)["TendFern"]
    assert "STILL" in Planner(domain).domain.assumptions


def asked(planner: Planner, book: Book) -> Adaptation:
    """The adaptation that asks for what the planner does not know."""
    for _ in range(50):
        step = planner.step()
        assert step is not None
        for adaptation in step.adaptations:
            book.apply(adaptation)
            planner.perceive(applied(adaptation))
            if step.kind == "watch":
                return adaptation
    raise AssertionError("nothing asked")


def test_an_unknown_condition_is_asked_for_once(domain: Domain) -> None:
    planner = Planner(domain, relax="none")
    request = asked(planner, Book(domain))
    assert request.definitions == (
        "P[11] = if CheckHose then REPORT[Connected, hose, holds] else REPORT[Connected, hose, fails]\n"
    )
    assert request.changes == ()
    assert planner.step() is None


def test_a_favourable_answer_leads_to_the_shorter_way(domain: Domain) -> None:
    planner, book = Planner(domain, relax="none"), Book(domain)
    asked(planner, book)
    planner.perceive(perception("information", "Connected", "hose", "holds"))
    settle(planner, book)
    assert "~(Spray[fern] : SUCCEED" in texts(planner)["TendFern"]
    assert planner.ideal


def test_an_unfavourable_answer_changes_nothing(domain: Domain) -> None:
    planner = Planner(domain, relax="none")
    asked(planner, Book(domain))
    before = image(planner)
    planner.perceive(perception("information", "Connected", "hose", "fails"))
    assert settle(planner) == []
    assert image(planner) == before


def test_a_situation_that_cannot_be_planned_without_knowing_waits_for_the_answer() -> None:
    text = GREENHOUSE.read_text()
    text = text[: text.index("atp_actionschema TakeCan")] + text[text.index("// What a reaction does when") :]
    text = text.replace("executability: Carried(can) @ i1 and ITL(i1, [m o si e di fi], PutAway);\n", "")
    text = text.replace("atp_rule forall i, j: Carried(can) @ i and OnHook(can) @ j => ITL(i, disjunct, j);\n", "")
    domain = read_domain(text)
    planner, book = Planner(domain, relax="none"), Book(domain)
    settle(planner, book)
    assert planner.impossible["TendFern"] == "no plan achieves TendFern (not known: Connected(hose))"
    assert any(text.startswith("if CheckHose") for text in book.reactions.values())
    planner.perceive(perception("information", "Connected", "hose", "holds"))
    settle(planner, book)
    assert planner.ideal
    assert "Spray[fern]" in texts(planner)["TendFern"]


def test_every_set_of_its_assumptions_can_be_planned_for(domain: Domain) -> None:
    for chosen in range(8):
        names = [name for n, name in enumerate(domain.assumptions) if chosen >> n & 1]
        planner = planner_without(domain, names)
        settle(planner, Book(domain))
        assert planner.ideal, names
