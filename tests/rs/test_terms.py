"""Terms are values: where something stands in a text makes no difference to what it is."""

from __future__ import annotations

import pytest

from planner_reactor.errors import Place
from planner_reactor.logic.domain import Assumption
from planner_reactor.rs.parser import parse_program
from planner_reactor.rs.terms import Apply, Call, Number, Schema, Symbol, Variable

HERE, THERE = Place(1, 2), Place(3, 4)

ALIKE = (
    (Symbol("tray", HERE), Symbol("tray", THERE), Symbol("belt", HERE)),
    (Variable("x", HERE), Variable("x", THERE), Variable("y", HERE)),
    (Apply("twice", (Number(1),), HERE), Apply("twice", (Number(1),), THERE), Apply("twice", (Number(2),), HERE)),
    (Call("Go", (Symbol("a", HERE),), (), HERE), Call("Go", (Symbol("a", THERE),), (), THERE), Call("Stay")),
    (Schema("P", (), (), Call("Go"), HERE), Schema("P", (), (), Call("Go"), THERE), Schema("P", (), (), Call("Stay"))),
    (Assumption("A", place=HERE), Assumption("A", place=THERE), Assumption("B", place=HERE)),
)


@pytest.mark.parametrize(("one", "same", "other"), ALIKE, ids=lambda value: type(value).__name__)
def test_places_make_no_difference(one: object, same: object, other: object) -> None:
    assert one == same
    assert not one != same  # noqa: SIM202  # both comparisons are written by hand
    assert hash(one) == hash(same)
    assert one != other
    assert not one == other  # noqa: SIM201


def test_a_program_is_what_it_says_wherever_its_lines_are() -> None:
    assert parse_program("P = Go[a] ; Stay") == parse_program("\n\n  P =\n Go[a]   ; Stay")
