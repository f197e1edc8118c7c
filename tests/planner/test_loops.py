"""The two loops: what comes first, what is held back, what perceptions change (R §7.3, §7.5)."""

from __future__ import annotations

import pytest

from planner_reactor.errors import InputError
from planner_reactor.link.messages import Adaptation
from planner_reactor.logic.reader import read_domain
from planner_reactor.planner import Planner, Step
from tests.planner.driving import KITTING, Book, applied, first_adaptations, kitting, perception, settle, texts

DOMAIN = kitting()


def started(**options: object) -> Planner:
    """A planner whose first ideal reactor is in place."""
    planner = Planner(DOMAIN, **options)  # type: ignore[arg-type]
    first_adaptations(planner, 5)
    assert planner.ideal
    return planner


def next_issue(planner: Planner) -> Step:
    """Step until an adaptation is issued."""
    for _ in range(20):
        step = planner.step()
        if step is not None and step.adaptations:
            return step
    raise AssertionError("nothing issued")


def test_the_first_adaptation_has_its_first_step_concrete_and_stubs_for_the_rest() -> None:
    planner = Planner(DOMAIN)
    (first,) = first_adaptations(planner, 1)
    assert [c.situation for c in first.changes] == ["Kitting", "AcquireTray", "FindPartTray", "FillTray", "FinishTray"]
    assert all(c.fresh and c.base == 0 for c in first.changes)
    assert first.adds[-1] == 0
    assert first.definitions.startswith("P[0] = STOP :; ASSERT[Kitting]\n")
    assert {s.name for s in planner.model if s.is_stub} == {"FillTray", "FinishTray"} == set(planner.expectation)


def test_a_step_issues_one_adaptation_at_most() -> None:
    planner = Planner(DOMAIN)
    steps = [planner.step() for _ in range(2)]
    assert [len(step.adaptations) for step in steps if step] == [0, 1]


def test_what_an_adaptation_touches_is_held_until_it_is_applied() -> None:
    planner = Planner(DOMAIN)
    issued = next_issue(planner).adaptations[0]
    assert planner.step() is None
    assert planner.expectation == ("FillTray", "FinishTray")
    planner.perceive(applied(issued))
    assert next_issue(planner).situation == "FillTray"


def test_a_new_reaction_names_the_version_that_it_was_planned_against() -> None:
    planner = Planner(DOMAIN)
    second = first_adaptations(planner, 2)[1]
    bases = {c.situation: (c.base, c.fresh) for c in second.changes}
    assert bases["FillTray"] == (1, False)
    assert bases["LacksMotor"] == (0, True)
    assert second.kills == (4,)


def test_a_stub_trigger_is_refined_first() -> None:
    planner = Planner(DOMAIN)
    first_adaptations(planner, 1)
    planner.perceive(perception("stub_trigger", "FinishTray"))
    assert next_issue(planner).situation == "FinishTray"


def test_a_failed_situation_comes_before_an_active_stub() -> None:
    planner = Planner(DOMAIN)
    first_adaptations(planner, 2)
    planner.perceive(perception("stub_trigger", "LacksBody"))
    planner.perceive(perception("situation_failure", "FinishTray"))
    assert next_issue(planner).situation == "FinishTray"
    assert next_issue(planner).situation == "LacksBody"


def test_a_failed_assumption_comes_before_an_active_stub_and_after_a_failed_situation() -> None:
    planner = Planner(DOMAIN)
    first_adaptations(planner, 3)
    planner.perceive(perception("stub_trigger", "FinishTray"))
    planner.perceive(perception("assumption_failure", "AQ"))
    planner.perceive(perception("situation_failure", "LacksCap"))
    order = []
    for _ in range(4):
        step = next_issue(planner)
        order.append(step.situation)
        planner.perceive(applied(step.adaptations[0]))
    assert order == ["LacksCap", "AcquireTray", "LacksMotor", "FinishTray"]


def test_a_failed_assumption_interrupts_what_was_being_planned() -> None:
    planner = Planner(DOMAIN)
    planner.step()
    planner.perceive(perception("assumption_failure", "AQ"))
    issued = next_issue(planner).adaptations[0]
    assert "FindGoodPartTray" in issued.definitions
    assert "AQ" not in issued.adopts


def test_a_forced_relaxation_issues_what_a_normal_one_would() -> None:
    """R §7.3: the same segments in the same sequence."""
    normal, forced = started(relax=("AQ",)), started(relax=())
    forced.perceive(perception("assumption_failure", "AQ"))
    assert [a.definitions for a in settle_from(normal)] == [a.definitions for a in settle_from(forced)]
    assert normal.relaxed == {"AQ": "normal"}
    assert forced.relaxed == {"AQ": "forced"}


def settle_from(planner: Planner) -> list[Adaptation]:
    issued: list[Adaptation] = []
    while (step := planner.step()) is not None:
        for adaptation in step.adaptations:
            issued.append(adaptation)
            planner.perceive(applied(adaptation))
    return issued


def test_the_monitor_goes_with_the_last_adaptation_that_drops_the_assumption() -> None:
    planner = started(relax=("AQ",))
    issued = settle_from(planner)
    assert [a.drops for a in issued] == [(), (), (), ("AQ",)]
    assert 6 in issued[-1].kills
    assert "AQ" not in planner.assumptions_in_use


def test_an_assumption_counts_as_used_until_the_last_adaptation_for_it_is_issued() -> None:
    planner = started(relax=("AQ",))
    while planner.relaxations == () or not planner.relaxations[-1].done:
        assert "AQ" in planner.assumptions_in_use
        step = planner.step()
        assert step is not None
        for adaptation in step.adaptations:
            planner.perceive(applied(adaptation))
    assert "AQ" not in planner.assumptions_in_use


def test_only_those_named_are_relaxed_by_choice() -> None:
    planner = Planner(DOMAIN, relax=("AS", "AQ"))
    settle(planner)
    assert [r.assumption for r in planner.relaxations] == ["AQ", "AS"]


def test_with_none_nothing_is_ever_relaxed() -> None:
    planner = started(relax="none")
    planner.perceive(perception("assumption_failure", "AQ"))
    assert planner.step() is None
    assert planner.relaxed == {}


def test_a_second_report_of_a_failure_changes_nothing() -> None:
    planner = started(relax=())
    planner.perceive(perception("assumption_failure", "AQ"))
    issued = settle_from(planner)
    planner.perceive(perception("assumption_failure", "AQ"))
    assert settle_from(planner) == []
    assert len(issued) == 4


def test_a_relaxation_never_puts_a_stub_in_the_place_of_a_reaction() -> None:
    planner, book = Planner(DOMAIN), Book(DOMAIN)
    settle(planner, book)
    assert not any("STUB" in text for text in book.reactions.values())
    later = started()
    assert not any("STUB" in a.definitions for a in settle_from(later))


@pytest.mark.parametrize("kind", ["adaptation_refused", "adaptation_timed_out"])
def test_an_adaptation_that_was_not_applied_is_planned_again(kind: str) -> None:
    planner, book = Planner(DOMAIN), Book(DOMAIN)
    first = next_issue(planner).adaptations[0]
    planner.perceive(perception(kind, str(first.id), cause="x"))  # type: ignore[arg-type]
    again = next_issue(planner).adaptations[0]
    assert [c.situation for c in again.changes] == [c.situation for c in first.changes]
    assert not set(again.adds) & set(first.adds)
    book.apply(again)
    planner.perceive(applied(again))
    settle(planner, book)
    assert planner.ideal


def test_what_is_refused_again_and_again_is_given_up_and_said() -> None:
    planner = Planner(DOMAIN)
    for _ in range(20):
        step = planner.step()
        if step is None:
            break
        for adaptation in step.adaptations:
            planner.perceive(perception("adaptation_refused", str(adaptation.id), cause="text"))
    assert planner.impossible == {"Kitting": "it was refused 5 times (text)"}
    assert not planner.ideal


def test_an_assumption_that_failed_and_may_return_is_watched_and_reinstated() -> None:
    planner, book = Planner(DOMAIN, relax=()), Book(DOMAIN)
    settle(planner, book)
    before = texts(planner)
    planner.perceive(perception("assumption_failure", "ADD"))
    settle(planner, book)
    assert "AwaitReady" in texts(planner)["FinishTray"]
    assert "HOLDMONITOR[ADD, 2000]" in book.reactions.values()
    assert "ADD" not in book.monitors("ASSUMONITOR")
    planner.perceive(perception("assumption_holds", "ADD"))
    (back,) = settle(planner, book)
    assert back.adopts == ("ADD",)
    assert texts(planner) == before
    assert book.monitors("HOLDMONITOR") == set()
    assert [r.cause for r in planner.relaxations] == ["forced", "reinstated"]


def test_an_assumption_that_flaps_is_believed_later_each_time() -> None:
    planner, book = Planner(DOMAIN, relax=()), Book(DOMAIN)
    settle(planner, book)
    periods: list[str] = []
    for _ in range(3):
        planner.perceive(perception("assumption_failure", "ADD"))
        settle(planner, book)
        periods.extend(text for text in book.reactions.values() if text.startswith("HOLD"))
        planner.perceive(perception("assumption_holds", "ADD"))
        settle(planner, book)
    assert periods == [f"HOLDMONITOR[ADD, {ms}]" for ms in (2000, 4000, 8000)]


def test_nothing_is_reinstated_while_an_adaptation_is_under_way() -> None:
    planner = started(relax=())
    planner.perceive(perception("assumption_failure", "ADD"))
    step = next_issue(planner)
    planner.perceive(perception("assumption_holds", "ADD"))
    assert planner.step() is None
    planner.perceive(applied(step.adaptations[0]))
    reinstated = planner.step()
    assert reinstated is not None
    assert (reinstated.kind, reinstated.assumption) == ("reinstate", "ADD")


def test_what_was_relaxed_by_choice_does_not_come_back() -> None:
    planner = Planner(DOMAIN)
    settle(planner)
    planner.perceive(perception("assumption_holds", "ADD"))
    assert planner.step() is None


def test_unexplained_failures_count_as_evidence_when_patience_is_set() -> None:
    planner = started(relax=("AM", "AS"), patience=3)
    while (step := planner.step()) is not None:
        for adaptation in step.adaptations:
            planner.perceive(applied(adaptation))
    settled = Planner(DOMAIN, relax=("AM",), patience=3)
    first_adaptations(settled, 5)
    for _ in range(3):
        settled.perceive(perception("situation_failure", "LacksMotor", cause="failed"))
    assert settled.relaxed == {"AM": "forced"}


def test_the_same_perceptions_give_the_same_adaptations() -> None:
    one, other = Planner(DOMAIN), Planner(read_domain(KITTING))
    assert settle(one) == settle(other)


def test_a_goal_or_an_assumption_that_does_not_exist_is_an_error_with_the_nearest_name() -> None:
    with pytest.raises(InputError, match="no goal Kiting, did you mean Kitting"):
        Planner(DOMAIN, goal="Kiting")
    with pytest.raises(InputError, match="ADX is not an assumption"):
        Planner(DOMAIN, relax=("ADX",))
    with pytest.raises(InputError, match="no goal"):
        Planner(read_domain("atp_fact P(a);"))


def test_an_impossible_goal_leaves_a_partial_reactor_and_says_why() -> None:
    text = KITTING.read_text()
    start = text.index("// Deliver[t]")
    domain = read_domain(text[:start] + text[text.index("// ---- basic actions: sensing") :])
    planner, book = Planner(domain), Book(domain)
    settle(planner, book)
    assert planner.impossible == {"FinishTray": "no plan achieves FinishTray (nothing brings about ToDownStream)"}
    assert not planner.ideal
    assert "FinishTray" in {s.name for s in planner.model if s.is_stub}
    assert "FindGetInsert" in texts(planner)["LacksMotor"] or "Insert" in texts(planner)["LacksMotor"]


def test_the_statistics_add_up() -> None:
    planner = Planner(DOMAIN)
    issued = settle(planner)
    statistics = planner.statistics()
    assert statistics["issued"] == statistics["adaptation_applied"] == len(issued)
    assert statistics["normal"] == 9
    assert planner.pending == ()
