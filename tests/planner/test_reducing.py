"""Sub-situations that turn out to be impossible: another way is sought, else less is put up with and said."""

from __future__ import annotations

from planner_reactor.logic.domain import Domain
from planner_reactor.logic.reader import read_domain
from planner_reactor.planner import Planner
from tests.planner.driving import Book, perception, planner_without, settle, texts

SHOP = """
atp_assumption WAX() likelihood 0.5 monitor flag 1000 reinstatable;     // there is always wax
atp_goal Shop Exists i: Clean(car) @ i and Shiny(car) @ i;
atp_actionschema Wash <><>
    effects: Clean(car) @ i1 and ITL(Wash, meets, i1);
intervals i1;
endactionschema
atp_actionschema Polish <><>                    // abstract, and the first that comes to mind
intervals i1, i2;
    executability: Clean(car) @ i1 and ITL(i1, [m o si e di fi], Polish);
    effects: Shiny(car) @ i2 and ITL(Polish, meets, i2);
    expansions: Waxed(car) @ i2;
endactionschema
atp_actionschema Wax <><>
intervals i1, i2;
    applicability: WAX() @ i1;
    effects: Waxed(car) @ i2 and ITL(Wax, meets, i2);
endactionschema
"""
BUFF = """
atp_actionschema Buff <><>                      // the other way
intervals i1, i2;
    executability: Clean(car) @ i1 and ITL(i1, [m o si e di fi], Buff);
    effects: Shiny(car) @ i2 and ITL(Buff, meets, i2);
endactionschema
"""


def planned(domain: Domain, *failed: str) -> tuple[Planner, Book]:
    planner, book = planner_without(domain, failed), Book(domain)
    settle(planner, book)
    return planner, book


def test_while_it_can_be_planned_the_abstract_way_is_taken() -> None:
    planner, _ = planned(read_domain(SHOP + BUFF))
    assert "Wash : REASSERT[Polish]" in texts(planner)["Shop"]
    assert "Wax" in texts(planner)["Polish"]


def test_another_way_is_taken_when_a_sub_situation_is_impossible() -> None:
    planner, book = planned(read_domain(SHOP + BUFF), "WAX")
    assert "Wash : Buff : SUCCEED" in texts(planner)["Shop"]
    assert planner.ideal
    assert not any("STUB" in text for text in book.reactions.values())


def test_a_sub_situation_that_becomes_impossible_is_replaced_where_it_is_called() -> None:
    planner, book = planned(read_domain(SHOP + BUFF))
    planner.perceive(perception("assumption_failure", "WAX"))
    settle(planner, book)
    assert "Wash : Buff : SUCCEED" in texts(planner)["Shop"]
    assert "Polish" not in texts(planner)
    assert planner.ideal


def test_what_was_avoided_is_used_again_once_it_is_possible() -> None:
    planner, book = planned(read_domain(SHOP + BUFF), "WAX")
    planner.perceive(perception("assumption_holds", "WAX"))
    settle(planner, book)
    assert "REASSERT[Polish]" in texts(planner)["Shop"]
    assert planner.ideal


def test_without_another_way_the_stub_stays_and_the_reason_is_told() -> None:
    planner, book = planned(read_domain(SHOP), "WAX")
    assert "Wash : REASSERT[Polish]" in texts(planner)["Shop"]
    assert any("STUB[Polish]" in text for text in book.reactions.values())
    assert planner.impossible == {"Polish": "no plan achieves Polish (nothing brings about Waxed; not without WAX)"}
    planner.perceive(perception("assumption_holds", "WAX"))
    settle(planner, book)
    assert planner.ideal


def test_what_is_out_of_reach_is_looked_for_behind_rules_and_actions() -> None:
    spread = SHOP.replace("Waxed(car) @ i2 and ITL(Wax", "Spread(car) @ i2 and ITL(Wax")
    rule = "atp_rule forall i: Spread(car) @ i and Clean(car) @ i => Waxed(car) @ i;"
    planner, _ = planned(read_domain(spread + rule), "WAX")
    assert planner.impossible == {"Polish": "no plan achieves Polish (nothing brings about Spread; not without WAX)"}


def test_a_reaction_for_which_there_is_no_other_stays_as_it_is() -> None:
    planner, book = planned(read_domain(SHOP))
    before = dict(book.reactions)
    planner.perceive(perception("assumption_failure", "WAX"))
    settle(planner, book)
    assert {n: t for n, t in book.reactions.items() if not t.startswith("HOLD")} == before
    assert planner.impossible == {"Polish": "no plan achieves Polish (nothing brings about Waxed; not without WAX)"}
    assert "HOLDMONITOR[WAX, 1000]" in book.reactions.values()
    planner.perceive(perception("assumption_holds", "WAX"))
    settle(planner, book)
    assert planner.ideal
    assert book.monitors("HOLDMONITOR") == set()
