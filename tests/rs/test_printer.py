"""The printer: what it writes reads back as the same term, and is always written in the same way."""

from __future__ import annotations

import pytest
from hypothesis import given, settings

from planner_reactor.rs.parser import parse_process, parse_program
from planner_reactor.rs.printer import show
from planner_reactor.rs.terms import Call, Negative, Number, Operation, Process, Program, Symbol, Text
from tests.strategies import expressions, processes, programs

VARIABLES = ("a", "b")


@given(processes(bound=VARIABLES))
@settings(max_examples=150, deadline=None)
def test_a_printed_process_parses_back_to_itself(process: Process) -> None:
    assert parse_process(show(process), bound=VARIABLES) == process


@given(processes(bound=VARIABLES, depth=4))
@settings(max_examples=60, deadline=None)
def test_layout_over_several_lines_changes_nothing(process: Process) -> None:
    assert parse_process(show(process, width=60), bound=VARIABLES) == process


@given(expressions(VARIABLES))
@settings(max_examples=150, deadline=None)
def test_a_printed_expression_parses_back_to_itself(expression: object) -> None:
    call = Call("P", (expression,))  # type: ignore[arg-type]
    assert parse_process(show(call), bound=VARIABLES) == call


@given(programs())
@settings(max_examples=40, deadline=None)
def test_a_printed_program_parses_back_to_itself(program: Program) -> None:
    assert parse_program(show(program)) == program
    assert parse_program(show(program, width=80)) == program


@pytest.mark.parametrize(
    ("written", "printed"),
    [
        ("A:B;C", "(A : B) ; C"),
        ("A;B:C", "A ; (B : C)"),
        ("A#B|C", "(A # B) | C"),
        ("~A#B", "(~A) # B"),
        ("A#B#C:D", "(A # B # C) : D"),
        ("SIT[s]<k>:;A:B", "SIT[s]<k> :; (A : B)"),
        ("SIT[s]:;P1|SIT[s]:;P2", "SIT[s] :; P1 | SIT[s] :; P2"),
        ("A:;~B", "A :; ~B"),
        ("~(A;B)", "~(A ; B)"),
        ("A|B;C|D:E", "A | B ; C | D : E"),
        ("(A|B)|C", "(A | B) | C"),
        ("((A))", "A"),
        ("if A then B else C|D", "if A then B else C | D"),
        ("(if A then B else C);D", "(if A then B else C) ; D"),
        ("A[]<>", "A"),
        ('P[ 1,2.50 ,"a\\"b"]< x >', 'P[1, 2.5, "a\\"b"]<x>'),
        ("P[(a+b)*c-(d-e)-f]", "P[(a + b) * c - (d - e) - f]"),
        ("P[(a<b)==(c<d)]", "P[(a < b) == (c < d)]"),
        ("P[-(-3), - 3, -x, -(x+1), f(-x)]", "P[-(-3), -3, -x, -(x + 1), f(-x)]"),
    ],
)
def test_printing_is_canonical(written: str, printed: str) -> None:
    process = parse_process(written)
    assert show(process) == printed
    assert parse_process(printed) == process


def test_a_negated_number_is_told_from_a_negative_number() -> None:
    assert show(Negative(Number(3))) == "-(3)"
    assert show(Number(-3)) == "-3"
    assert show(Operation("-", Symbol("x"), Number(-3))) == "x - -3"


@pytest.mark.parametrize("text", ["", '"', "\\", "two\nlines", "\t", "// no comment", "é\u2028\x00"])
def test_any_string_can_be_written(text: str) -> None:
    call = Call("P", (Text(text),))
    assert parse_process(show(call)) == call


def test_long_definitions_are_broken_at_their_outermost_operators() -> None:
    body = "SIT[fill]<k, x> :; (~(First[x] : Second[x] : SUCCEED[fill, k]) : FAIL[fill, k])"
    program = parse_program(f"P[7] = {body}")
    assert show(program, width=44) == (
        "P[7] =\n"
        "    SIT[fill]<k, x>\n"
        "    :; (~(First[x]\n"
        "          : Second[x]\n"
        "          : SUCCEED[fill, k])\n"
        "        : FAIL[fill, k])"
    )
