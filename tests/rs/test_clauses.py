"""Heads: clauses of one name agree in form and exclude each other."""

from __future__ import annotations

import pytest

from planner_reactor.rs.checks import check
from planner_reactor.rs.parser import parse_program
from tests.rs.findings import findings, messages, places


def test_clauses_told_apart_by_constants_are_fine() -> None:
    text = """
        SP[6] = Act[1]    SP[7] = Act[2]    SP["x"] = Act[3]
        Q[1, x] = Act[x]  Q[2, x] = Act[x]  Q[3, 4] = Act[4]
    """
    assert findings(text, "overlapping-clauses", "clause-form", "redefined") == []


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("P = Act[1]\nP = Act[2]", "P is defined twice, first at cell.rsl:1:1"),
        ("P[1] = Act[1]\nP[1] = Act[2]", "P[1] is defined twice, first at cell.rsl:1:1"),
        ("P[x] = Act[x]\nP[y] = Act[y]", "P[x] and P[y] can both apply, the first stands at cell.rsl:1:1"),
        ("P[1] = Act[1]\nP[x] = Act[x]", "P[1] and P[x] can both apply"),
        ("P[1, x] = Act[x]\nP[y, 2] = Act[y]", "P[1, x] and P[y, 2] can both apply"),
        ("P[1] = Act[1]\nP[1.0] = Act[2]", "P[1] and P[1.0] can both apply"),
    ],
)
def test_clauses_that_can_both_apply(text: str, message: str) -> None:
    (found,) = messages(text, "overlapping-clauses")
    assert message in found
    assert places(text, "overlapping-clauses") == [(2, 1)]


def test_every_clause_that_overlaps_is_named_once() -> None:
    text = "P[1] = Act[1]\nP[2] = Act[2]\nP[1] = Act[3]\nP[x] = Act[x]"
    assert places(text, "overlapping-clauses") == [(3, 1), (4, 1)]


def test_clauses_agree_in_form() -> None:
    text = "P[1] = Act[1]\nP[2, x] = Act[x]\nP[3]<y> = Sense<y>"
    assert messages(text, "clause-form") == [
        "P[2, x] differs in form from other clauses of P, the first is P[1], at cell.rsl:1:1",
        "P[3]<y> differs in form from other clauses of P, the first is P[1], at cell.rsl:1:1",
    ]


def test_names_of_basic_and_built_in_processes_are_taken() -> None:
    assert messages("Delay[x] = Act[x]\nSense<x> = IN[p]<x> | OUT[p, 1]", "redefined") == [
        "Delay is a basic process and cannot be defined, choose another name",
        "Sense is a basic process and cannot be defined, choose another name",
    ]


def test_many_clauses_are_compared_by_look_up() -> None:
    program = parse_program("\n".join(f"P[{n}] = Delay[{n}]" for n in range(2000)))
    assert [f for f in check(program) if f.severity == "error"] == []


def test_clauses_with_constants_at_different_places_exclude_each_other() -> None:
    text = 'P[x, "a"] = Act[x]\nP["b", "c"] = Act[1]\nP["d", "c"] = Act[2]\nP["b", "a"] = Act[3]'
    assert places(text, "overlapping-clauses") == [(4, 1)]
