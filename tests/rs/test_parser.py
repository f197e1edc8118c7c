"""The parser: which term a text means, where its parts stand, and where two readings meet."""

from __future__ import annotations

import pytest

from planner_reactor.errors import Place
from planner_reactor.rs.parser import parse_process, parse_program
from planner_reactor.rs.terms import (
    All,
    Apply,
    Call,
    Cond,
    Disable,
    Head,
    If,
    Loop,
    Negative,
    Not,
    Number,
    Operation,
    Par,
    Parameter,
    Process,
    Seq,
    Spawn,
    Symbol,
    Text,
    Variable,
)

A, B, C, D = (Call(name) for name in "ABCD")


@pytest.mark.parametrize(
    ("text", "term"),
    [
        ("A;B;C", Seq((A, B, C))),
        ("(A;B);C", Seq((Seq((A, B)), C))),
        ("A;(B;C)", Seq((A, B, C))),
        ("A:B:C", Cond((A, B, C))),
        ("A|B|C", Par((A, B, C))),
        ("A&B&C", All((A, B, C))),
        ("A|(B&C)", Par((A, All((B, C))))),
        ("A#B#C", Disable((A, B, C))),
        ("(A#B)#C", Disable((Disable((A, B)), C))),
        ("~~A", Not(Not(A))),
        ("~A:B", Cond((Not(A), B))),
        ("A:B;C", Seq((Cond((A, B)), C))),
        ("A;B:C", Seq((A, Cond((B, C))))),
        ("A#B:C", Cond((Disable((A, B)), C))),
        ("A#~B", Disable((A, Not(B)))),
        ("A#B|C", Par((Disable((A, B)), C))),
        ("A:;B:C", Loop(A, Cond((B, C)))),
        ("A;B:;C", Loop(Seq((A, B)), C)),
        ("A::B|C", Par((Spawn(A, B), C))),
        ("A:;(B::C)", Loop(A, Spawn(B, C))),
        ("if A then B else C;D", If(A, B, Seq((C, D)))),
        ("if A;B then C|D else A", If(Seq((A, B)), Par((C, D)), A)),
        ("if if A then B else C then D else A", If(If(A, B, C), D, A)),
        ("if A then if B then C else D else A", If(A, If(B, C, D), A)),
        ("(if A then B else C) | D", Par((If(A, B, C), D))),
    ],
)
def test_strength_of_operators(text: str, term: Process) -> None:
    assert parse_process(text) == term


def test_tokens_are_as_long_as_they_can_be() -> None:
    assert parse_process("A:;B") == Loop(A, B)
    assert parse_process("A::B") == Spawn(A, B)
    assert parse_process("A: ~B") == parse_process("A:~B") == Cond((A, Not(B)))
    assert parse_program("P<x>=IN[p]<x>").schemas[0].results == ("x",)


def test_comments_and_blanks_separate_tokens() -> None:
    assert parse_process(" A // ; B\n\t;\r\n B//") == Seq((A, B))


def test_definitions_need_no_separator() -> None:
    program = parse_program("P = A\nQ[x] = B R = C // the last")
    assert [schema.name for schema in program.schemas] == ["P", "Q", "R"]
    assert len(parse_program("")) == 0


def test_a_bare_name_in_a_head_is_a_parameter_and_constants_make_clauses() -> None:
    program = parse_program('SP[6, x, -1.5, "red"] = A[x] SP[7, y, 0, z] = B')
    expected: tuple[Head, ...] = (Number(6), Parameter("x"), Number(-1.5), Text("red"))
    assert program.schemas[0].head == expected
    assert program.select("SP", (6, "anything", -1.5, "red")) is program.schemas[0]
    assert program.select("SP", (6, "anything", -1.5, "green")) is None


def test_arguments_are_expressions() -> None:
    call = parse_process('P[x, -y, 1+2*3, (1+2)*3, a-b-c, f(), g(x, "s"), 1e-3, a/=b]', bound=["x", "y"])
    x, y = Variable("x"), Variable("y")
    one, two, three = Number(1), Number(2), Number(3)
    a, b, c = Symbol("a"), Symbol("b"), Symbol("c")
    assert isinstance(call, Call)
    assert call.arguments == (
        x,
        Negative(y),
        Operation("+", one, Operation("*", two, three)),
        Operation("*", Operation("+", one, two), three),
        Operation("-", Operation("-", a, b), c),
        Apply("f", ()),
        Apply("g", (x, Text("s"))),
        Number(0.001),
        Operation("/=", a, b),
    )


def test_every_name_knows_its_place() -> None:
    program = parse_program("P[x] =\n  A[x,\n    y] ; B[f(x)]", file="cell.rsl")
    body = program.schemas[0].body
    assert isinstance(body, Seq)
    first, second = body.parts
    assert isinstance(first, Call)
    assert isinstance(second, Call)
    assert program.schemas[0].place == Place(1, 1, "cell.rsl")
    assert first.place == Place(2, 3, "cell.rsl")
    y = first.arguments[1]
    assert isinstance(y, Symbol)
    assert y.place == Place(3, 5, "cell.rsl")
    f = second.arguments[0]
    assert isinstance(f, Apply)
    assert f.place == Place(3, 12, "cell.rsl")


def test_places_do_not_count_in_equality() -> None:
    assert parse_process("A ; B") == parse_process("A\n;\nB")
