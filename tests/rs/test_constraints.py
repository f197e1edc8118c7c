"""The small reasoner: what it calls impossible has no solution, what it calls possible has one, the rest it admits."""

from __future__ import annotations

from itertools import product
from random import Random

import pytest

from planner_reactor.rs.constraints import consistent, holds, implies, projected, satisfiable, solution
from planner_reactor.rs.unknowns import Alike, Applied, Compared, Constraint, Unknown

X, Y, Z = (Unknown(name) for name in "xyz")
GRID = [n / 2 for n in range(-6, 7)]


def random_constraint(draw: Random) -> Constraint:
    y, z = (draw.choice([0, 1, -1]) * part for part in (Y, Z))
    value = draw.choice([1, -1, 2]) * X + y + z + draw.randint(-3, 3)
    relation = draw.choice(["<", "<=", "==", "/="])
    return Compared(value, relation, draw.choice([0, 0.5]) if relation in ("==", "/=") else 0)


def some(count: int, seed: int) -> list[list[Constraint]]:
    draw = Random(seed)
    return [[random_constraint(draw) for _ in range(draw.randint(1, 5))] for _ in range(count)]


def test_what_is_impossible_has_no_solution_on_a_grid() -> None:
    impossible = [c for c in some(250, 1) if satisfiable(c) == "no"]
    assert len(impossible) > 20
    for constraints in impossible:
        for values in product(GRID[::2], repeat=3):
            known = dict(zip((X, Y, Z), values, strict=True))
            assert not all(holds(c, known, 0) for c in constraints)


def test_what_is_possible_has_the_solution_that_is_given() -> None:
    possible = [c for c in some(400, 2) if satisfiable(c) == "yes"]
    assert len(possible) > 100
    for constraints in possible:
        found = solution(constraints)
        assert found is not None
        assert all(holds(c, {X: 0, Y: 0, Z: 0, **found}, 1e-12) for c in constraints)


def test_strict_bounds_that_touch_are_impossible() -> None:
    assert satisfiable([Compared(X - 1, "<"), Compared(1 - X, "<")]) == "no"
    assert satisfiable([Compared(X - 1, "<="), Compared(1 - X, "<=")]) == "yes"
    assert satisfiable([Compared(X - 1, "<="), Compared(1 - X, "<="), Compared(X - 1, "/=")]) == "no"


def test_equality_is_within_its_tolerance() -> None:
    near = Compared(X - Y, "==", 0.1)
    assert satisfiable([near, Compared(X - Y - 0.1, "=="), Compared(Y, "==")]) == "yes"
    assert satisfiable([near, Compared(Y - X + 0.2, "<")]) == "no"


def test_what_is_not_linear_is_admitted() -> None:
    product_of_unknowns = X * Y
    assert isinstance(product_of_unknowns, Applied)
    assert satisfiable([Compared(product_of_unknowns, "<")]) == "unknown"
    assert satisfiable([Compared(product_of_unknowns, "<"), Compared(-product_of_unknowns, "<")]) == "no"
    assert consistent([Compared(product_of_unknowns, "<")])
    assert satisfiable([Alike(X, "cap")]) == "unknown"
    assert satisfiable([Alike(X, "cap"), Alike(X, "cap", False)]) == "no"


def test_what_follows() -> None:
    assert implies([Compared(X - Y, "<="), Compared(Y - Z, "<=")], Compared(X - Z, "<="))
    assert not implies([Compared(X - Y, "<=")], Compared(X - Z, "<="))


@pytest.mark.parametrize("seed", range(20))
def test_a_projection_says_of_the_others_what_can_still_be_met(seed: int) -> None:
    """z is forgotten: a point (x, y) is in the projection if some z fits."""
    draw = Random(seed)
    drawn = (random_constraint(draw) for _ in range(4))
    constraints = [c for c in drawn if isinstance(c, Compared) and c.relation != "/="]
    shadow = projected(constraints, {X, Y})
    for x, y in product(GRID[::3], repeat=2):
        at = [Compared(X - x, "=="), Compared(Y - y, "==")]
        assert (satisfiable([*constraints, *at]) == "yes") is all(holds(c, {X: x, Y: y}, 0) for c in shadow)
