"""Errors in a text: each says where it is, what was found, and what would have been right."""

from __future__ import annotations

import pytest

from planner_reactor.errors import Diagnostic, RSError
from planner_reactor.rs.parser import parse_process, parse_program


def errors(text: str) -> tuple[Diagnostic, ...]:
    with pytest.raises(RSError) as caught:
        parse_program(text)
    return caught.value.diagnostics


CASES = [
    # text, column, message, hint
    ("P", 2, "expected `=` after P, found the end of the text", "or is an operator missing before P?"),
    ("P = A B | C", 9, "expected `=` after B, found `|`", "or is an operator missing before B?"),
    ("= A", 1, "`=` where a definition should begin", "expected Name[…]<…> = P"),
    ("if = A", 1, "`if` where a definition should begin", "expected Name[…]<…> = P"),
    ("P = ", 5, "the end of the text where a process should stand", "expected a name, `~P`, `(P)` or `if`"),
    ("P = A ; ; B", 9, "`;` where a process should stand", "expected a name, `~P`, `(P)` or `if`"),
    ("P = (A ; B", 11, "expected `)`, found the end of the text", "to close the `(` at 1:5"),
    ("P = A)", 6, "`)` after the end of a process", "no parenthesis is open here"),
    ("P = A]", 6, "`]` after the end of a process", "no bracket is open here"),
    ("P = A, B", 6, "`,` after the end of a process", "processes are composed by `;` `:` `|` `&`"),
    ("P = A else B", 7, "`else` after the end of a process", "no `if` is open here"),
    ("P = A 3", 7, "`3` after the end of a process", "expected an operator, or the next definition"),
    ("P = A :; B :; C", 12, "`:;` and `:;` do not chain", "write (A :; B) :; C or A :; (B :; C)"),
    ("P = A :; B :: C", 12, "`:;` and `::` do not chain", "write (A :; B) :: C or A :; (B :: C)"),
    ("P = A | B & C", 11, "`|` and `&` do not mix without parentheses", "write (A | B) & C or A | (B & C)"),
    ("P = A ; if B then C else D", 9, "`if` within a larger expression", "put it in parentheses"),
    ("P = ~if A then B else C", 6, "`if` within a larger expression", "put it in parentheses"),
    ("P = if A then B", 16, "expected `else`, found the end of the text", "the form is if P then P else P"),
    ("P = if A : B", 13, "expected `then`, found the end of the text", "the form is if P then P else P"),
    ("P = Move(x)", 9, "`(` after the process Move", "arguments stand in square brackets: Move[…]"),
    ("P = Move<x>[y]", 12, "`[` after results", "arguments stand before results: Name[…]<…>"),
    ("P = A[f[1]]", 8, "`[` after f in an argument", "a function takes its arguments in parentheses: f(…)"),
    ("P = A[x = 1]", 9, "`=` in an argument", "`==` compares"),
    ("P = A[1,]", 9, "`]` where an argument should stand", 'expected a number, a name, a "string", f(…)'),
    ("P = A[1 2]", 9, "expected `]`, found `2`", "to close the `[` at 1:6"),
    ("P = A[(1]", 9, "expected `)`, found `]`", "to close the `(` at 1:7"),
    ("P = A[a < b < c]", 13, "`<` and `<` do not chain", "put parentheses around it"),
    ("P = A[1e999]", 7, "1e999 is too large", "the largest number is about 1.8e308"),
    ("P = A[12x]", 7, "this is not a number", "numbers are written 12, 0.5 or 1e-3"),
    ("P = A[.5]", 7, "`.` has no meaning in RS", ""),
    ('P = A["abc]', 7, "this string has no end", 'a string ends with `"` on the line on which it begins'),
    (r'P = A["\q"]', 7, "this string has a wrong escape", "expected"),
    ("P = A['abc']", 7, "`'` has no meaning in RS", 'strings are written "in double quotes"'),
    ("P = {A}", 5, "`{` has no meaning in RS", "processes are grouped by parentheses: `(P)`"),
    ("P = !A", 5, "`!` has no meaning in RS", "`~P` negates a process"),
    ("P = A<3>", 7, "`3` where the name of a result should stand", "results are names: <x, y>"),
    ("P = A<x", 8, "expected `>`, found the end of the text", "to close the `<` at 1:6"),
    ("P[x+1] = A", 4, "expected `]`, found `+`", "to close the `[` at 1:2"),
    ("P[~] = A", 3, "`~` in a head", "a head holds names, numbers and strings"),
    ("P[-x] = A", 5, "`]` in a head", "a head holds names, numbers and strings"),
]


@pytest.mark.parametrize(("text", "column", "message", "hint"), CASES, ids=[case[0] for case in CASES])
def test_an_error_says_where_what_and_what_was_expected(text: str, column: int, message: str, hint: str) -> None:
    found = errors(text)[0]
    assert (found.severity, found.code) == ("error", "syntax")
    assert (found.place.line, found.place.column) == (1, column)
    assert found.message == message
    assert hint in found.hint


def test_an_error_shows_its_line_with_a_caret() -> None:
    with pytest.raises(RSError) as caught:
        parse_program("P = A\nQ =\t(B ; )\n", file="cell.rsl")
    assert str(caught.value) == (
        "cell.rsl:2:10: `)` where a process should stand, expected a name, `~P`, `(P)` or `if`\n"
        "    Q =\t(B ; )\n"
        "       \t     ^"
    )


def test_reading_goes_on_after_an_error_at_the_next_definition() -> None:
    text = "P = A ; ;\n    B\nQ = C\nR = (D\nS[x] = E[\n"
    found = errors(text)
    assert [(f.place.line, f.place.column) for f in found] == [(1, 9), (5, 1), (6, 1)]


def test_no_more_than_twenty_errors_are_listed() -> None:
    assert len(errors("P = ;\n" * 100)) == 20


def test_a_lone_process_must_be_all_of_the_text() -> None:
    with pytest.raises(RSError) as caught:
        parse_process("A ; B C", file="<argument>")
    assert caught.value.place.column == 7
    assert caught.value.place.file == "<argument>"


def test_a_very_long_line_is_not_shown_beyond_the_place() -> None:
    found = errors("P = " + "A ; " * 20 + "; " + "B ; " * 10_000)
    assert len(found[0].line_text) < 1000
