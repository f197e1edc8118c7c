"""Hostile texts are refused where they become too much, whatever they are made of. Never a RecursionError."""

from __future__ import annotations

import sys

import pytest

from planner_reactor.errors import RSError
from planner_reactor.rs.checks import check, check_text
from planner_reactor.rs.expressions import EvaluationError, evaluate
from planner_reactor.rs.grammar import TOKEN
from planner_reactor.rs.parser import parse_process, parse_program
from planner_reactor.rs.printer import show
from planner_reactor.rs.terms import Call
from planner_reactor.rs.tokens import BUDGETS, Budgets

SIZE = 200_000
BOMBS = ["(", "~", "~(", "if ", "A|(", "A:(B;", "A:;(", "A#(B|", "if A then ", "if A then B else "]
ARGUMENT_BOMBS = ["(", "-", "-(", "f(", "f(1,", "1+(", "f(-", "x*-"]


@pytest.mark.parametrize("bomb", [*BOMBS, *(f"P[{b}" for b in ARGUMENT_BOMBS)])
def test_a_bomb_is_refused_at_the_nesting_that_exceeds_the_budget(bomb: str) -> None:
    opening, repeated = ("P[", bomb[2:]) if bomb.startswith("P[") else ("", bomb)
    text = opening + repeated * (SIZE // len(repeated))
    for refused, start in ((parse_process, ""), (parse_program, "P = ")):
        with pytest.raises(RSError) as caught:
            refused(start + text)
        (found,) = caught.value.diagnostics
        assert found.code == "too-deep"
        tokens_read = len(TOKEN.findall((start + text)[: found.place.column]))
        assert tokens_read <= 6 * BUDGETS.nesting


@pytest.mark.parametrize("bomb", ["[", "P[", "P<", ")", "#", "::", "P = ", "=", '"', "//", "0", "P[f["])
def test_other_nonsense_is_refused_within_a_few_tokens(bomb: str) -> None:
    text = bomb * (SIZE // len(bomb))
    if bomb == "//":
        assert len(parse_program(text)) == 0
        return
    with pytest.raises(RSError) as caught:
        parse_program(text)
    assert len(caught.value.diagnostics) <= BUDGETS.errors
    assert all(f.place.column < 20 for f in caught.value.diagnostics)


def test_long_but_flat_texts_are_fine() -> None:
    assert len(show(parse_process(" ; ".join(["A"] * 20_000)))) > SIZE // 4
    assert len(parse_program("\n".join(f"P{i} = A | B" for i in range(2000)))) == 2000


def test_a_sum_is_as_deep_as_it_is_long() -> None:
    parse_process("P[" + "+".join(["1"] * (BUDGETS.depth - 1)) + "]")
    with pytest.raises(RSError, match="levels"):
        parse_process("P[" + "+".join(["1"] * 10_000) + "]")


def test_parentheses_that_make_the_term_deep_on_the_left_count_too() -> None:
    text = "A"
    for _ in range(60):
        text = f"({text} # B : C ; D)"
    with pytest.raises(RSError, match="more than 100 levels deep"):
        parse_process(text)


def deepest(wrap: str, *, within: str = "@") -> str:
    """The deepest text of this form that is still accepted: `@` stands for the inner text."""
    text = "A"
    while True:
        wider = wrap.replace("@", text)
        try:
            parse_process(within.replace("@", wider))
        except RSError:
            return text
        text = wider


@pytest.mark.parametrize(
    "wrap",
    [
        "~@",
        "(@)",
        "(@ ; B) : C",
        "(@ # B : C ; D) :; E | F",
        "B :; (C ; (D : (E # (@))))",
        "if @ then B else C",
    ],
)
def test_whatever_is_accepted_can_be_walked_by_everything_far_below_the_limit_of_recursion(wrap: str) -> None:
    text = deepest(wrap)
    before = sys.getrecursionlimit()
    sys.setrecursionlimit(_frames() + 700)
    try:
        process = parse_process(text)
        assert parse_process(show(process)) == process
        assert repr(process)
        hash(process)
        program = parse_program(f"P = {text}")
        assert show(program, width=40)
        check(program)
    finally:
        sys.setrecursionlimit(before)


@pytest.mark.parametrize("wrap", ["f(@)", "-@", "1 + (@)", "(@) * 2", "f(g(1, @), 2)"])
def test_whatever_is_accepted_as_an_argument_can_be_walked_too(wrap: str) -> None:
    inner = deepest(wrap, within="P[@]")
    call = parse_process(f"P[{inner}]")
    assert isinstance(call, Call)
    assert parse_process(show(call)) == call
    with pytest.raises(EvaluationError):
        evaluate(call.arguments[0], {}, {"f": abs, "g": max})
    check_text(f"P = P[{inner}]")


def test_size_is_bounded_in_characters_tokens_and_digits() -> None:
    small = Budgets(characters=50, tokens=10, digits=5)
    cases = {"too-long": "P = " + "A" * 60, "too-many-tokens": "P = A;A;A;A;A;A;A"}
    for code, text in cases.items():
        with pytest.raises(RSError) as caught:
            parse_program(text, budgets=small)
        assert caught.value.diagnostics[0].code == code
    with pytest.raises(RSError, match="more than 5 digits"):
        parse_program("P = A[123456]", budgets=small)
    with pytest.raises(RSError, match="more than 80 digits"):
        parse_program(f"P = A[{'9' * SIZE}]")


def _frames() -> int:
    frame = sys._getframe()
    count = 0
    while frame is not None:
        count += 1
        frame = frame.f_back  # type: ignore[assignment]
    return count
