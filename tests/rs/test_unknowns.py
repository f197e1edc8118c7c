"""Values with unknowns in them: arithmetic in one normal form, and courses that follow every open answer once."""

from __future__ import annotations

import pytest

from planner_reactor.rs.constraints import consistent
from planner_reactor.rs.expressions import EvaluationError, evaluate
from planner_reactor.rs.given import constant
from planner_reactor.rs.parser import parse_process, parse_program
from planner_reactor.rs.printer import show
from planner_reactor.rs.terms import Call
from planner_reactor.rs.unknowns import Applied, Compared, Undecided, Unknown, courses, equal

P, G = Unknown("p"), Unknown("g", 1)


def test_equal_sums_are_equal_values() -> None:
    assert P + G == G + P
    assert hash(P + G) == hash(G + P)
    assert (P + G) - G == P
    assert 2 * P - P == P
    assert (P + 1) - P == 1
    assert P / 2 + P / 2 == P


def test_sums_print_older_parts_first() -> None:
    assert repr(G + P) == "p + g"
    assert repr(3 - 2 * P) == "-2 * p + 3"
    assert show(constant(G - P)) == "g - p"
    assert show(constant(2 * (P + 1))) == "2 * p + 2"


def test_what_is_not_linear_is_a_value_of_its_own() -> None:
    assert P * G == G * P
    assert isinstance(P * G, Applied)
    assert repr((P + 1) * G) == "(p + 1) * g"


def test_a_function_of_the_host_is_applied_to_what_is_known_of_its_argument() -> None:
    def double(x: float) -> float:
        return 2 * x

    (argument,) = parse_call("Use[double(x)]").arguments
    scope = {"x": 3}
    assert evaluate(bound(argument, scope), {}, {"double": double}) == 6
    assert evaluate(bound(argument, {"x": P}), {}, {"double": double}) == Applied("double", (P,))


def bound(argument: object, scope: dict[str, object]):  # type: ignore[no-untyped-def]
    from planner_reactor.rs.given import expression_with_values

    return expression_with_values(argument, scope)  # type: ignore[arg-type]


def parse_call(text: str) -> Call:
    call = parse_process(text)
    assert isinstance(call, Call)
    return call


def test_a_question_that_nobody_answers_is_an_error() -> None:
    with pytest.raises(Undecided):
        bool(P < 3)


def test_courses_take_every_open_answer_once() -> None:
    def which() -> str:
        if P < 1:
            return "below"
        return "in" if P <= 2 else "above"

    found = dict(courses(which, [], consistent))
    assert set(found) == {"below", "in", "above"}
    assert found["below"] == (Compared(P - 1, "<"),)
    known = [Compared(P, "<")]
    assert list(courses(which, known, consistent)) == [("below", ())]


def test_a_question_whose_answer_is_known_is_not_put_again() -> None:
    def twice() -> tuple[bool, bool]:
        return P < 1, P < 2

    assert {result for result, _ in courses(twice, [], consistent)} == {(True, True), (False, True), (False, False)}


def test_equality_asks_only_what_structure_leaves_open() -> None:
    assert equal(P + 1, 1 + P)
    assert [r for r, _ in courses(lambda: equal(P, P + 1), [], consistent)] == [False]
    assert sorted(r for r, _ in courses(lambda: equal(P, 3), [], consistent)) == [False, True]


def test_a_clause_is_chosen_by_an_unknown_under_a_condition() -> None:
    program = parse_program("Pick[1] = STOP\nPick[2] = ABORT")
    chosen = courses(lambda: program.select("Pick", (P,)), [], consistent)
    found = {show(s.body) if s is not None else "none": len(supposed) for s, supposed in chosen}
    assert found == {"STOP": 1, "ABORT": 2, "none": 2}


def test_division_by_what_may_be_zero_goes_both_ways() -> None:
    def divided() -> object:
        (argument,) = parse_call("Use[1 / x]").arguments
        try:
            return evaluate(bound(argument, {"x": P}), {}, {})
        except EvaluationError:
            return "no value"

    assert {str(r) for r, _ in courses(divided, [], consistent)} == {"no value", "1 / p"}
