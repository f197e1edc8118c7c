"""Expressions: their values, and everything that has none."""

from __future__ import annotations

import contextlib

import pytest
from hypothesis import given, settings

from planner_reactor.errors import PlannerReactorError
from planner_reactor.rs.expressions import EvaluationError, Unbound, evaluate, same
from planner_reactor.rs.parser import parse_process
from planner_reactor.rs.terms import Call, Expression, Value
from tests.strategies import expressions

ENVIRONMENT: dict[str, Value] = {"x": 3, "half": 0.5, "name": "red", "yes": True, "host": frozenset({1})}
FUNCTIONS = {"f": lambda *given: len(given), "g": lambda a: a * 2, "broken": lambda: 1 // 0}


def value(text: str) -> Value:
    call = parse_process(f"P[{text}]", bound=ENVIRONMENT)
    assert isinstance(call, Call)
    return evaluate(call.arguments[0], ENVIRONMENT, FUNCTIONS)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("1 + 2 * x", 7),
        ("(1 + 2) * x", 9),
        ("10 - 4 - 3", 3),
        ("1 / 4", 0.25),
        ("-x", -3),
        ("- -x", 3),
        ("half + half", 1.0),
        ("red", "red"),
        ('"red" == name', True),
        ("red == name", True),
        ("1 == 1.0", True),
        ("yes == 1", False),
        ("yes /= 1", True),
        ("x < 4", True),
        ("x >= 4", False),
        ('"a" < "b"', True),
        ("host == host", True),
        ("f()", 0),
        ("f(1, g(x))", 2),
        ("(x < 4) == (1 < 2)", True),
    ],
)
def test_values(text: str, expected: Value) -> None:
    found = value(text)
    assert found == expected
    assert type(found) is type(expected)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("red + 1", "+ needs numbers, not 'red' and 1"),
        ("yes + 1", "+ needs numbers, not True and 1"),
        ("-name", "- needs numbers, not 0 and 'red'"),
        ('"a" * 3', "* needs numbers"),
        ("1 / 0", "1 is divided by zero"),
        ("1 / (x - 3)", "1 is divided by zero"),
        ("1 < red", "< orders two numbers or two strings, not 1 and 'red'"),
        ("yes < 2", "< orders two numbers or two strings"),
        ("1e308 * 10", "is not a finite number"),
        ("h(1)", "no function h is registered"),
        ("brokn()", "did you mean broken?"),
        ("broken()", "broken() failed: integer division or modulo by zero"),
        ("g(1, 2)", "g(1, 2) failed"),
    ],
)
def test_what_has_no_value_says_why(text: str, message: str) -> None:
    with pytest.raises(EvaluationError) as caught:
        value(text)
    assert message in str(caught.value)


def test_an_unbound_variable_is_told_apart() -> None:
    call = parse_process("P[y]", bound=["y"])
    assert isinstance(call, Call)
    with pytest.raises(Unbound, match="y is not bound") as caught:
        evaluate(call.arguments[0], {}, {})
    assert caught.value.name == "y"
    assert isinstance(caught.value, LookupError)


def test_integers_stay_small_whatever_is_calculated() -> None:
    big: Value = 3
    call = parse_process("P[n * n]", bound=["n"])
    assert isinstance(call, Call)
    for _ in range(7):
        big = evaluate(call.arguments[0], {"n": big}, {})
    with pytest.raises(EvaluationError, match="more than 256 bits"):
        evaluate(call.arguments[0], {"n": big}, {})
    huge = parse_process("P[n / 3]", bound=["n"])
    assert isinstance(huge, Call)
    with pytest.raises(EvaluationError, match="too large"):
        evaluate(huge.arguments[0], {"n": 10**400}, {})


def test_what_functions_of_a_host_make_is_bounded_too() -> None:
    functions = {"twice": lambda x: 2 * x, "power": lambda x: 2**x}
    call = parse_process("P[twice(text)]", bound=["text"])
    assert isinstance(call, Call)
    longest = "x" * (1 << 15)
    assert evaluate(call.arguments[0], {"text": longest}, functions) == 2 * longest
    with pytest.raises(EvaluationError, match="twice makes a string of more than 65536 characters"):
        evaluate(call.arguments[0], {"text": longest + "x"}, functions)
    power = parse_process("P[power(n)]", bound=["n"])
    assert isinstance(power, Call)
    with pytest.raises(EvaluationError, match="power makes an integer of more than 256 bits"):
        evaluate(power.arguments[0], {"n": 256}, functions)


def test_values_of_a_host_that_cannot_be_compared_do_no_harm() -> None:
    class Odd:
        def __eq__(self, other: object) -> bool:
            raise RuntimeError("no")

        __hash__ = None  # type: ignore[assignment]

    with pytest.raises(EvaluationError, match="cannot be compared: no"):
        same(Odd(), 1)


@given(expressions(tuple(ENVIRONMENT)))
@settings(max_examples=200, deadline=None)
def test_every_expression_has_a_value_or_says_why_not(expression: Expression) -> None:
    with contextlib.suppress(PlannerReactorError):
        evaluate(expression, ENVIRONMENT, FUNCTIONS)
