"""What a program has but does not use."""

from __future__ import annotations

from planner_reactor.rs.checks import check
from planner_reactor.rs.parser import parse_program
from tests.rs.findings import findings, messages, places


def test_with_roots_everything_must_be_reachable_from_them() -> None:
    program = parse_program("P = Q\nQ = Delay[1]\nR = S\nS = Delay[2] ; R")
    found = check(program, roots=["P"])
    assert [(f.code, f.place.line) for f in found] == [("unreachable", 3), ("unreachable", 4)]
    assert check(program, roots=["P", "S"]) == ()


def test_an_unknown_root_is_an_error() -> None:
    (found,) = [f for f in check(parse_program("Main = Delay[1]"), roots=["Man"]) if f.severity == "error"]
    assert found.code == "unknown-process"
    assert (found.message, found.hint) == ("unknown process Man", "did you mean Main?")


def test_without_roots_what_nothing_calls_is_a_root_unless_it_needs_arguments() -> None:
    assert findings("P = Act[1]\nQ = Act[2] ; Q", "unreachable") == []
    assert findings("A = Act[1] ; B\nB = Act[2] ; A", "unreachable") == []
    assert findings("Only[x] = Act[x]", "unreachable") == []
    assert messages("P = Act[1]\nLeft[x] = Over[x]\nOver[x] = Act[x]", "unreachable") == [
        "nothing calls Left[x], remove it, or call it",
        "nothing calls Over[x], remove it, or call it",
    ]


def test_clauses_called_by_label_are_reachable() -> None:
    assert findings("R = ADD<m> :: (E[m] # P[m])\nP[1] = Act[1]\nP[2] = Act[2]", "unreachable") == []
    assert places("R = P[1]\nP[1] = Act[1]\nP[x, y] = Act[x + y]", "unreachable") == [(3, 1)]


def test_a_parameter_that_nothing_reads() -> None:
    assert messages("P[x, y] = Act[x]", "unused-parameter") == [
        "parameter y of P is not used, _y says that it is meant so"
    ]
    assert findings("P[x, _y] = Act[x]", "unused-parameter") == []
    assert findings("P[0, x] = Act[0]\nP[1, x] = Act[x]", "unused-parameter") == []
    assert places("P[0, x] = Act[0]\nP[1, x] = Act[1]", "unused-parameter") == [(1, 1)]
