"""Names: where a result reaches, and where it must not be bound again."""

from __future__ import annotations

import pytest

from planner_reactor.errors import RSError
from planner_reactor.rs.parser import parse_process, parse_program
from planner_reactor.rs.terms import Symbol, Variable, calls


def kinds(text: str, *bound: str) -> str:
    """For each call of U in the text: `v` if its argument is a variable, `s` if it is a symbol."""
    process = parse_process(text, bound=bound)
    arguments = [call.arguments[0] for call in calls(process) if call.name == "U"]
    assert all(isinstance(a, Variable | Symbol) for a in arguments)
    return "".join("v" if isinstance(a, Variable) else "s" for a in arguments)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("A<x> ; U[x]", "v"),
        ("A<x> : B : U[x]", "v"),
        ("U[x] ; A<x>", "s"),
        ("~A<x> : U[x]", "v"),
        ("(B ; A<x>) : U[x]", "v"),
        ("A<x> :; U[x]", "v"),
        ("A<x> :: U[x]", "v"),
        ("(A<x> :; B) ; U[x]", "v"),
        ("(B :; A<x>) ; U[x]", "s"),
        ("(B :: A<x>) | U[x]", "s"),
        ("(A<x> | B) ; U[x]", "v"),
        ("(A<x> # B) : U[x]", "v"),
        ("A<x> | U[x]", "s"),
        ("A<x> & U[x]", "s"),
        ("A<x> # U[x]", "s"),
        ("if A<x> then U[x] else U[x]", "vv"),
        ("(if A then B<x> else C<x>) ; U[x]", "v"),
        ("if A then B<x> else U[x]", "s"),
    ],
)
def test_where_a_result_reaches(text: str, expected: str) -> None:
    assert kinds(text) == expected


def test_parameters_reach_everywhere_in_their_definition_and_nowhere_else() -> None:
    program = parse_program("P[x] = U[x] | A :; U[x]\nQ = U[x]")
    uses = [call for schema in program.schemas for call in calls(schema.body) if call.name == "U"]
    found = [call.arguments[0] for call in uses]
    assert found == [Variable("x"), Variable("x"), Symbol("x")]
    assert kinds("U[x] | U[y]", "x") == "vs"


def test_names_within_expressions_are_resolved_but_functions_are_not() -> None:
    process = parse_process("U[f(x + -f) == y]", bound=["x", "f"])
    (call,) = calls(process)
    assert 'function="f"' in repr(call.arguments[0]).replace("'", '"')
    assert repr(call.arguments[0]).count("Variable") == 2


@pytest.mark.parametrize(
    ("text", "column", "code", "message", "hint"),
    [
        ("P = A<x> ; B<x>", 12, "rebound", "x is bound again within its scope", "bound at 1:5 already"),
        ("P[x] = A<x>", 8, "rebound", "x is bound again within its scope", "it is bound at 1:1 already"),
        ("P = A<x> :; B<x>", 13, "rebound", "x is bound again within its scope", "at 1:5 already"),
        ("P = if A<x> then B<x> else C", 18, "rebound", "x is bound again within its scope", "at 1:8"),
        ("P = A<x> ; (B | C<x>)", 17, "rebound", "x is bound again within its scope", "bound at 1:5"),
        ("P = A<x, x>", 5, "rebound", "x stands twice among these results", "choose another name"),
        ("P[x, x] = A", 1, "rebound", "x stands twice in the head of P", "choose another name"),
        ("P[x]<x> = A", 1, "rebound", "x stands twice in the head of P", "choose another name"),
        ("P = A<x> | B<x>", 12, "clash", "x is bound by two parts that run side by side", "bound at 1:5"),
        ("P = A<x> & (B ; C<x>)", 17, "clash", "x is bound by two parts that run side by side", "at 1:5"),
        ("P = A # B<x> # C<x>", 16, "clash", "x is bound by two parts that run side by side", "at 1:9"),
    ],
)
def test_no_name_is_bound_twice(text: str, column: int, code: str, message: str, hint: str) -> None:
    with pytest.raises(RSError) as caught:
        parse_program(text)
    (found,) = caught.value.diagnostics
    assert (found.place.line, found.place.column, found.code) == (1, column, code)
    assert found.message == message
    assert hint in found.hint
    assert found.line_text == text


@pytest.mark.parametrize(
    "text",
    [
        "(A :; B<x>) ; C<x>",
        "(A :; B<x>) | (C :; D<x>)",
        "(if A then B<x> else C<x>) ; U[x]",
        "(A :: B<x>) ; (C :: D<x>)",
    ],
)
def test_a_name_may_be_used_again_where_it_does_not_reach(text: str) -> None:
    parse_process(text)


def test_a_name_bound_outside_a_lone_process_is_not_bound_within() -> None:
    with pytest.raises(RSError, match="x is bound again within its scope, it is bound already"):
        parse_process("A<x>", bound=["x"])
