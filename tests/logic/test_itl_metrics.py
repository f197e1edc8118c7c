"""Durations and resources in a domain: what is read, and what each fault says."""

from __future__ import annotations

import pytest

from planner_reactor.errors import DomainError
from planner_reactor.logic.domain import Demand, Duration
from planner_reactor.logic.formulas import Atom
from planner_reactor.logic.reader import check_domain, read_domain

TEXT = """
atp_resource arm;
atp_resource slot(t) capacity 4;
atp_goal G Done(box);
atp_actionschema Fill <t><>
    duration: 5500 .. 7000;
    uses: arm, slot(t) 2, slot(t);
    effects: Done(t);
endactionschema
"""


def test_a_schema_says_how_long_it_lasts_and_what_it_takes() -> None:
    domain = read_domain(TEXT)
    fill = domain.schemas["Fill"]
    assert fill.duration == Duration(5500.0, 7000.0)
    assert fill.uses == (Demand(Atom("arm"), 1), Demand(Atom("slot", (0,)), 3))
    assert {name: (r.parameters, r.capacity) for name, r in domain.resources.items()} == {"arm": (0, 1), "slot": (1, 4)}
    assert not check_domain(TEXT)


def test_one_number_is_an_exact_duration() -> None:
    assert read_domain(TEXT.replace("5500 .. 7000", "6500.5")).schemas["Fill"].duration == Duration(6500.5, 6500.5)


def test_a_domain_without_numbers_has_none() -> None:
    domain = read_domain("atp_goal G Done(box);\natp_actionschema Fill <t><> effects: Done(t); endactionschema")
    assert domain.schemas["Fill"].duration is None
    assert domain.schemas["Fill"].uses == ()
    assert not domain.resources


@pytest.mark.parametrize(
    ("old", "new", "code", "line", "column", "says"),
    [
        ("uses: arm", "uses: amr", "unknown-resource", 7, 11, "did you mean arm"),
        ("slot(t) 2", "slot 2", "arity", 7, 16, "expected 1, as the resource declares"),
        ("slot(t) 2", "slot(t) 4", "over-capacity", 7, 27, "uses 5 of slot(t), there is 4"),
        ("capacity 4", "capacity 0", "not-whole", 3, 31, "above 0"),
        ("slot(t) 2", "slot(t) 1.5", "not-whole", 7, 24, "whole number"),
        ("5500 .. 7000", "7000 .. 5500", "empty-duration", 6, 15, "7000 .. 5500 ms"),
        ("5500 .. 7000", "0", "empty-duration", 6, 15, "more than 0"),
        ("5500 .. 7000", "5500 7000", "syntax", 6, 20, "expected .. or ;"),
        ("slot(t) capacity", "slot(t) capacty", "syntax", 3, 22, "expected capacity or ;"),
        ("resource arm;", "resource Fill;", "duplicate-name", 5, 18, "name of the resource"),
    ],
)
def test_a_fault_has_its_place_and_its_cause(old: str, new: str, code: str, line: int, column: int, says: str) -> None:
    with pytest.raises(DomainError) as caught:
        read_domain(TEXT.replace(old, new))
    found = next(finding for finding in caught.value.diagnostics if finding.code == code)
    assert (found.place.line, found.place.column) == (line, column)
    assert says in str(found)


def test_a_resource_that_nothing_uses_is_odd() -> None:
    codes = [finding.code for finding in check_domain(TEXT + "atp_resource camera;")]
    assert codes == ["unused-resource"]
