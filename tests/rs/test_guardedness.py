"""N7, N8: nothing goes on for ever without a step."""

from __future__ import annotations

import pytest
from hypothesis import given, settings

from planner_reactor.rs.checks import check
from planner_reactor.rs.terms import Program
from tests.rs.findings import findings, messages, places
from tests.strategies import FUNCTIONS, HOST, programs

CODES = ("unguarded-recursion", "silent-loop")


@pytest.mark.parametrize(
    "text",
    [
        "P = Delay[1] ; P",
        "P = Delay[1] : (P | P)",
        "P[n] = GTR[n, 0] : P[n - 1]",
        "P = Q ; P  Q = R  R = Act[1]",
        "P = (STOP # Act[1]) ; Act[2] ; P",
        "P = STOP :; Act[1]",
        "P = Act[1] :; STOP",
        "P = Act[1] :: STOP",
        "P = ABORT : P",
        "P = NIL ; P",
        "P = if ABORT then P else Act[1]",
        "P = ABORT :; P",
        "P = (~STOP) :; P",
        "P[1] = P[2]  P[2] = P[3]  P[3] = Act[1]",  # clauses, not names
        "STREAM2[y, v] = OUT[y, v] :; STOP",
        "P = ((Delay[1] | STOP) : STOP) :; STOP",
    ],
)
def test_guarded(text: str) -> None:
    assert findings(text, *CODES) == []


@pytest.mark.parametrize(
    "text",
    [
        "P = P",
        "P = STOP : P",
        "P = ABORT ; P",
        "P = STOP ; STOP ; P",
        "P = ~P",
        "P = P | Act[1]",
        "P = Act[1] | P",
        "P = Act[1] # P",
        "P = Act[1] & (STOP : P)",
        "P = P :; Act[1]",
        "P = STOP :; P",
        "P = if P then STOP else STOP",
        "P = if STOP then P else Act[1]",
        "P = if ABORT then Act[1] else P",
        "P = (~ABORT) : P",
        "P = (STOP # Act[1]) ; P",
        "P = (STOP | ABORT) : P",
        "P = ~(STOP & ABORT) : P",
        "P = (ABORT :; Act[1]) ; P",
        "P[n] = P[n - 1]",
        "P[1] = P[2]  P[2] = P[1]",
        "P = Q : P  Q = R  R = STOP",
    ],
)
def test_recursion_that_no_step_guards(text: str) -> None:
    found = findings(text, *CODES)
    assert [f.code for f in found] == ["unguarded-recursion"]
    assert (found[0].place.line, found[0].place.column) == (1, 1)


def test_the_way_round_is_shown() -> None:
    assert messages("A = Act[1] : B\nB = C\nC = STOP ; (Act[2] | D)\nD = B", *CODES) == [
        "B calls itself before it takes a step (B → C → D → B), put a process that takes a step before the call"
    ]


@pytest.mark.parametrize(
    ("text", "column"),
    [
        ("P = STOP :; STOP", 5),
        ("P = Act[1] ; (STOP :; ABORT)", 15),
        ("P = STOP :; (if STOP then ABORT else Act[1])", 5),
        ("P = Q :; Q  Q = STOP", 5),
        ("P = STOP :: Act[1]", 5),
        ("P = (~ABORT) :: Act[1]", 7),
        ("P = Act[1] :; ((STOP : STOP) :; (ABORT # Act[1]))", 17),
    ],
)
def test_loops_that_go_round_without_a_step(text: str, column: int) -> None:
    assert [f.code for f in findings(text, *CODES)] == ["silent-loop"]
    assert places(text, *CODES) == [(1, column)]


def test_the_two_loops_are_told_apart() -> None:
    assert "a round of this `:;` may pass without a step" in messages("P = STOP :; STOP", *CODES)[0]
    assert "this `::` spawns for ever at one instant" in messages("P = STOP :: Act[1]", *CODES)[0]


def test_chains_of_definitions_may_be_long() -> None:
    chain = "\n".join(f"P{i} = P{i + 1}" for i in range(1000))
    assert findings(f"{chain}\nP1000 = Act[1]", *CODES) == []
    assert len(findings(f"{chain}\nP1000 = P0", *CODES)) == 1


@given(programs())
@settings(max_examples=60, deadline=None)
def test_sound_programs_pass_all_checks(program: Program) -> None:
    found = check(program, signatures=HOST, functions=frozenset(FUNCTIONS))
    assert [f for f in found if f.severity == "error"] == []
