"""A changed domain changes what is planned; nothing but the text is changed here."""

from __future__ import annotations

import re

import pytest

from planner_reactor.logic.domain import Domain
from planner_reactor.logic.reader import read_domain
from planner_reactor.planner import Planner
from tests.planner.driving import KITTING, TRIED, Book, first_adaptations, planner_without, settle, texts

TEXT = KITTING.read_text()


def with_kinds(*kinds: str) -> Domain:
    names = [f"y{n}" for n in range(len(kinds))]
    body = " and ".join(f"Instance({k}, {y}) @ i and In(t, {y}) @ i" for k, y in zip(kinds, names, strict=True))
    rule = f"atp_rule forall t, {', '.join(names)}, i: {body} => Contents(t) @ i;"
    return read_domain(re.sub(r"atp_rule[^;]*=> Contents\(t\) @ i;", rule, TEXT))


def ideal(domain: Domain, **options: object) -> dict[str, str]:
    planner = Planner(domain, relax="none", **options)  # type: ignore[arg-type]
    settle(planner, Book(domain))
    assert planner.ideal
    return texts(planner)


def test_a_fourth_kind_is_filled_too() -> None:
    found = ideal(with_kinds("motor", "cap", "body", "label"))
    assert "REASSERT[LacksLabel, x1]" in found["FillTray"]
    assert "FindGetInsert[label, x1]" in found["LacksLabel"]


def test_one_kind_alone_needs_no_composition() -> None:
    assert "(~(REASSERT[LacksLid, x1] : SUCCEED" in ideal(with_kinds("lid"))["FillTray"]


def test_the_order_of_the_rule_is_the_order_of_the_text() -> None:
    (second,) = first_adaptations(Planner(with_kinds("body", "motor", "cap")), 2)[1:]
    assert [c.situation for c in second.changes] == ["FillTray", "LacksBody", "LacksMotor", "LacksCap"]
    assert "FindGetInsert[body, x1]" in second.definitions


def test_two_of_a_kind_are_two_calls_of_one_situation() -> None:
    found = ideal(with_kinds("screw", "screw", "plate"))
    assert found["FillTray"].count("REASSERT[LacksScrew, x1]") == 2


def test_with_many_kinds_the_first_adaptation_is_as_small_as_ever() -> None:
    few, many = (
        first_adaptations(Planner(with_kinds(*kinds)), 1)[0] for kinds in (["a"], [f"p{n}" for n in range(60)])
    )
    assert few.definitions == many.definitions


def test_many_kinds_are_planned_once_and_repeated() -> None:
    domain = with_kinds(*(f"p{n}" for n in range(60)))
    planner = Planner(domain)
    settle(planner, Book(domain, loads=False))
    assert planner.ideal
    assert planner.statistics()["refinements"] < 40


def test_a_kind_that_the_domain_tells_apart_is_planned_for_by_itself() -> None:
    domain = read_domain(TEXT + "atp_fact Vacant(nothing, motor);")
    assert ideal(domain)["LacksMotor"] == ideal(read_domain(TEXT))["LacksMotor"]


def test_a_fixed_order_of_filling_is_kept() -> None:
    """Each kind but the first needs the one before it in its place: a chain, not side by side."""
    text = TEXT.replace(
        "executability: Instance(tray, t) @ i3 and ITL(i3, encompasses, Lacks);",
        "executability: Exists j: Filled(t, j) @ i1 and After(j, k) @ i1;\n"
        "                   Instance(tray, t) @ i3 and ITL(i3, encompasses, Lacks);",
    ).replace(
        "and In(t, x) @ i5 and ITL(Lacks, meets, i5);",
        "and In(t, x) @ i5 and Filled(t, k) @ i5 and ITL(Lacks, meets, i5);",
    )
    text += """
    atp_fact After(nothing, motor) and After(motor, cap) and After(cap, body);
    atp_rule forall t, i: Instance(tray, t) @ i => Filled(t, nothing) @ i;
    """
    found = ideal(read_domain(text))["FillTray"]
    assert "REASSERT[LacksMotor, x1] : REASSERT[LacksCap, x1] : REASSERT[LacksBody, x1] : SUCCEED" in found


def test_a_new_abstract_action_becomes_a_situation() -> None:
    """Trays are wiped before they are filled, once the domain says so."""
    text = TEXT.replace(
        "executability: Instance(tray, t) @ i2 and ITL(i2, encompasses, FillTray);",
        "executability: Clean(t) @ i2 and Instance(tray, t) @ i2 and ITL(i2, encompasses, FillTray);",
    )
    text += """
    atp_actionschema CleanTray <t><>
    intervals i1, i2;
        executability: Instance(tray, t) @ i1 and ITL(i1, encompasses, CleanTray);
        effects:       Clean(t) @ i2 and ITL(CleanTray, meets, i2);
        expansions:    Clean(t) @ i2;
    endactionschema
    atp_actionschema Wipe <t><>
    intervals i2;
        effects:       Clean(t) @ i2 and ITL(Wipe, meets, i2);
    endactionschema
    """
    found = ideal(read_domain(text))
    assert "REASSERT[AcquireTray]<x1> : REASSERT[CleanTray, x1] : REASSERT[FillTray, x1]" in found["Kitting"]
    assert "Wipe[x1]" in found["CleanTray"]


def test_another_basic_action_takes_the_place_of_a_longer_way() -> None:
    text = (
        TEXT
        + """
    atp_actionschema FetchTray <><t>
    intervals i1, i2;
        executability: Free(arm) @ i1 and ITL(i1, [m o si e di fi], FetchTray);
        effects:       Instance(tray, t) @ i2 and Position(t, trayarea) @ i2 and ITL(FetchTray, meets, i2);
    endactionschema
    """
    )
    assert "FetchTray<x1> : (UPDATE" in ideal(read_domain(text))["AcquireTray"]


def test_another_likelihood_changes_the_order_of_relaxation() -> None:
    domain = read_domain(TEXT.replace("AO()  likelihood 0.90", "AO()  likelihood 0.01"))
    planner = Planner(domain)
    settle(planner)
    assert [r.assumption for r in planner.relaxations][:2] == ["AO", "AQ"]


def test_an_assumption_may_speak_of_one_kind_at_a_time() -> None:
    text = TEXT.replace("atp_assumption AQ() ", "atp_assumption AQ(k) ")
    text = text.replace(
        "forall x, i, j: AQ() @ j => Good(x) @ i", "forall k, x, i, j: Instance(k, x) @ i and AQ(k) @ j => Good(x) @ i"
    )
    text = text.replace("AQ() @ i1 and ITL(i1, encompasses, FindPart)", "AQ(m) @ i1 and ITL(i1, encompasses, FindPart)")
    text = text.replace("AQ() @ i1 and AS()", "AQ(m) @ i1 and AS()")
    planner = planner_without(read_domain(text), ["AQ(motor)"])
    settle(planner)
    found = texts(planner)
    assert "Test[motor" in found["FindGoodPartMotor"]
    assert "FindGetInsert[cap, x1]" in found["LacksCap"]
    assert "AQ(cap)" in planner.assumptions_in_use
    assert "AQ(motor)" not in planner.assumptions_in_use


def test_situations_may_keep_their_parameters() -> None:
    """R §5.1: three instances of one situation at once, served by a loop that serves all."""
    domain = read_domain(TEXT)
    planner = Planner(domain, fold=False)
    settle(planner, Book(domain))
    found = texts(planner)
    assert planner.ideal
    assert "REASSERT[Lacks, motor, x1] & REASSERT[Lacks, cap, x1] & REASSERT[Lacks, body, x1]" in found["FillTray"]
    assert found["Lacks"].startswith("SIT[Lacks]<k, x1, x2> :: ")
    assert "REASSERT[FindGoodPart, x1]<x3>" in found["Lacks"]


@pytest.mark.parametrize("path", [TRIED, KITTING], ids=lambda p: p.stem)
def test_retrying_spoils_what_was_only_assumed(path: object) -> None:
    """A tray that failed its verification is filled again: its slots may not be taken to be vacant any
    more.
    """
    planner = planner_without(read_domain(path), ["ACT"])  # type: ignore[arg-type]
    settle(planner)
    found = texts(planner)
    assert "Verify[x1] : SUCCEED" in found["FillTray"]
    assert "if SlotVacant[x1, motor] then FindGetInsert[motor, x1] else STOP" in found["LacksMotor"]
    assert "REASSERT[FillTray, x1] : Deliver[x1]" in found["FinishTray"]
