"""Run-time terms: their parts, the leaves in them with what encloses each, the names that a text uses."""

from __future__ import annotations

from planner_reactor.rs.parser import parse_process
from planner_reactor.rs.states import (
    Ended,
    Group,
    InstanceNumber,
    Inverted,
    Leaf,
    Reaction,
    Serve,
    Spot,
    bind,
    guard_of,
    only,
    parts_of,
    put,
    spots,
    variables,
    with_parts,
)

E, WAITS, NIL = Leaf("E", (7,)), Leaf("IN", ("p",)), Leaf("NIL")


def test_the_guard_of_a_reaction_is_the_e_beside_it() -> None:
    assert guard_of(Group("#", (E, NIL))) == 7
    assert guard_of(Group("#", (NIL, E))) == 7
    assert guard_of(Group("|", (E, NIL))) is None
    assert guard_of(Group("#", (WAITS, NIL))) is None
    assert guard_of(Group("#", (Leaf("E"), WAITS))) is None
    assert guard_of(E) is None


def test_each_leaf_stands_under_the_nearest_guard_and_the_nearest_body() -> None:
    body = Serve("s", InstanceNumber(3), Reaction(7, None), Group("|", (NIL, Group("#", (WAITS, NIL)))))
    found = list(spots(Group("#", (E, Inverted(body), Ended(True)))))
    assert found == [
        Spot(0, (0,), E, 7, None),
        Spot(0, (1, 0, 0, 0), NIL, 7, InstanceNumber(3)),
        Spot(0, (1, 0, 0, 1, 0), WAITS, 7, InstanceNumber(3)),
        Spot(0, (1, 0, 0, 1, 1), NIL, 7, InstanceNumber(3)),
    ]
    inner = Serve("t", InstanceNumber(4), Reaction(8, None), NIL)
    nested = Serve("s", InstanceNumber(3), Reaction(7, None), Group("#", (Leaf("E", (8,)), inner)))
    assert [(s.guard, s.owner) for s in spots(nested, 2)] == [(8, 3), (8, 4)]
    assert {s.root for s in spots(nested, 2)} == {2}


def test_parts_can_be_replaced_each_in_its_place() -> None:
    group = Group("|", (NIL, E, WAITS))
    assert parts_of(group) == (NIL, E, WAITS)
    assert with_parts(group, (E, E, NIL)) == Group("|", (E, E, NIL))
    assert put(Inverted(group), (0, 1), NIL) == Inverted(Group("|", (NIL, NIL, WAITS)))
    assert put(Inverted(group), (0, 2), NIL) == Inverted(Group("|", (NIL, E, NIL)))
    assert parts_of(NIL) == ()


def test_the_names_that_a_text_uses_wherever_they_stand() -> None:
    text = parse_process("a<x> ; a<y> ; a<z> ; a<w> ; (OUT[p, -x] | GTR[f(y) + 1, 2 * (z - 1)]) ; OUT[q, 1]")
    assert variables(text) == {"x", "y", "z"}


def test_bindings_later_ones_win_and_only_those_asked_for_are_kept() -> None:
    assert bind((("y", 1), ("x", 1)), (("x", 2),)) == (("x", 2), ("y", 1))
    assert only((("x", 2), ("y", 1)), frozenset("y")) == (("y", 1),)
