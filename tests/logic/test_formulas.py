"""Atoms and unification: variables are numbers, constants are everything else."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from planner_reactor.logic.formulas import Atom, Bindings, Numeral, filled, variables

terms = st.one_of(st.integers(0, 4), st.sampled_from("abc"))
arguments = st.lists(terms, max_size=4).map(tuple)


def test_a_variable_stands_for_what_it_is_unified_with() -> None:
    bindings = Bindings()
    assert bindings.unify((0, "a", 1), ("b", 2, 2))
    assert bindings.ground(Atom("p", (0, 1, 2))) == Atom("p", ("b", "a", "a"))


def test_constants_unify_only_if_they_are_equal() -> None:
    assert not Bindings().unify(("a",), ("b",))
    assert not Bindings().unify((Numeral(1),), (Numeral(2),))
    assert Bindings().unify((Numeral(1),), (Numeral(1),))


def test_a_variable_is_never_taken_for_a_number() -> None:
    bindings = Bindings()
    assert bindings.unify((1,), (Numeral(1),))
    assert bindings.walk(1) == Numeral(1)


def test_undoing_forgets_what_was_bound_since_the_mark() -> None:
    bindings = Bindings()
    bindings.unify((0,), ("a",))
    mark = bindings.mark()
    bindings.unify((1,), ("b",))
    bindings.undo(mark)
    assert bindings.walk(1) == 1
    assert bindings.walk(0) == "a"


def test_shifting_renames_apart() -> None:
    assert Atom("p", (0, "a", 1)).shifted(10) == Atom("p", (10, "a", 11))
    assert list(variables((Atom("p", (3, "a")), Atom("q", (3, 1))))) == [3, 1]
    assert filled(Atom("p", (0, 1)), {0: "a"}) == Atom("p", ("a", 1))


@given(arguments, arguments)
def test_unification_makes_equal_and_is_symmetric(one: tuple[object, ...], other: tuple[object, ...]) -> None:
    there, back = Bindings(), Bindings()
    assert there.unify(one, other) == back.unify(other, one)
    if there.unify(one, other):
        assert there.ground(Atom("p", one)) == there.ground(Atom("p", other))
