"""Calls: that the process exists and is given what it expects."""

from __future__ import annotations

import pytest

from tests.rs.findings import errors, findings, messages

CODES = (
    "unknown-process",
    "unknown-function",
    "no-clause",
    "argument-count",
    "result-count",
    "argument-kind",
)


@pytest.mark.parametrize(
    ("text", "column", "code", "message"),
    [
        ("P = Sence<x>", 5, "unknown-process", "unknown process Sence, did you mean Sense?"),
        ("P = Delay[1] : Pp", 16, "unknown-process", "unknown process Pp"),
        ("P = delay[1]", 5, "unknown-process", "unknown process delay, did you mean Delay?"),
        ("P = Xyzzy", 5, "unknown-process", "unknown process Xyzzy"),
        ("P = Act[ff(1)]", 9, "unknown-function", "unknown function ff, did you mean f?"),
        ("P = Act[f(1 + h(2))]", 15, "unknown-function", "function h, functions come from the host"),
        ("P = Delay", 5, "argument-count", "Delay takes 1 argument, 0 given, expected Delay[number]"),
        ("P = Delay[1, 2]", 5, "argument-count", "Delay takes 1 argument, 2 given, expected Delay[number]"),
        ("P = Equal[1]", 5, "argument-count", "Equal takes 2 to 3 arguments, 1 given"),
        ("P = ASSERT", 5, "argument-count", "ASSERT takes at least 1 argument, 0 given"),
        ("P = Q[1]  Q = Act[1]", 5, "argument-count", "Q takes 0 arguments, 1 given, expected Q"),
        ("P = Q  Q[a, b] = Act[a + b]", 5, "argument-count", "Q takes 2 arguments, 0 given"),
        ("P = Sense<x, y>", 5, "result-count", "Sense returns 1 result, 2 named, expected Sense<x>"),
        ("P = Delay[1]<x>", 5, "result-count", "Delay returns 0 results, 1 named, expected Delay[number]"),
        ("P = Q<x, y>  Q<z> = Sense<z>", 5, "result-count", "Q returns 1 result, 2 named, expected Q<z>"),
        ("P = Q[3]  Q[1] = Act[1]  Q[2] = Act[2]", 5, "no-clause", "to Q[3], there are Q[1], Q[2]"),
        ("P = Delay[soon]", 11, "argument-kind", "soon is a symbol where a number is expected"),
        ("P[soon] = Delay[sooon]", 17, "argument-kind", "expected, did you mean soon?"),
        ("P = Sense<pose> : Delay[pos]", 25, "argument-kind", "expected, did you mean pose?"),
        ("P = Delay[soon]", 11, "argument-kind", "no parameter or result is called soon"),
        ('P = Delay["1"]', 5, "argument-kind", '"1" is a string where a number is expected'),
        ("P = Delay[1 < 2]", 5, "argument-kind", "1 < 2 is a truth value where a number is expected"),
        ("P = Act[red + 1]", 9, "argument-kind", "red is a symbol where a number is expected"),
        ("P = Act[f(-red)]", 12, "argument-kind", "red is a symbol where a number is expected"),
        ("P = IN[3]<x>", 5, "argument-kind", "3 is a number where the name of a port is expected"),
        ("P = ASSERT[1 + 2]", 5, "argument-kind", "1 + 2 is a number where the name of a situation"),
        ("P = SUCCEED[s, k]", 16, "argument-kind", "k is a symbol where the number of an instance"),
        ("P = E[k]", 7, "argument-kind", "k is a symbol where a label (a number) is expected"),
        ("P = ASSUMONITOR[AQ, often]", 21, "argument-kind", "often is a symbol where a number is expected"),
    ],
)
def test_wrong_calls(text: str, column: int, code: str, message: str) -> None:
    (found,) = findings(text, *CODES)
    assert (found.place.line, found.place.column, found.code) == (1, column, code)
    assert message in f"{found.message}, {found.hint}"


@pytest.mark.parametrize(
    "text",
    [
        "P[t] = Delay[t] : Delay[t + 1] : Delay[f(t)] : Delay[-t]",
        'P[p] = IN[p]<x> : OUT["p", red] : OUT[f(1), 1 < 2]',
        "P = Equal[1, 1.1, 0.2] : Equal[red, green]",
        "P = ASSERT[s, 1, red]<x, y, z> | ASSERT[s]  Q = SIT[s]<k, a, b> :; SUCCEED[s, k]",
        "P = SIT[s] :; STUB[s]  Q = ASSERT[s]",
        "P = ADD<m> :: (E[m] # R[m])",
        "P = POST[6] ; POST[5] ; KILL[2]",
        "P = Sense ; Sense<x>",
        "P = Ran[0, 1]<x> : REPORT[seen, x, 2]",
    ],
)
def test_right_calls(text: str) -> None:
    assert findings(text, *CODES) == []


def test_the_kind_of_a_parameter_is_what_it_is_used_for() -> None:
    text = "P = Q[soon, 3]\nQ[t, port] = R[t] | IN[port]<x>\nR[s] = Delay[s]"
    assert messages(text, "argument-kind") == [
        "3 is a number where the name of a port is expected",
        "soon is a symbol where a number is expected, no parameter or result is called soon",
    ]
    recursive = "P[n] = LST[n, 3] : P[n + 1]\nQ = P[one]"
    assert len(messages(recursive, "argument-kind")) == 1


def test_a_parameter_used_for_different_things_may_be_anything() -> None:
    text = "P[x] = (if Equal[x, red] then ASSERT[x] else Delay[x])\nQ = P[red] | P[2]\nS = SIT[red] :; Act[1]"
    assert errors(text) == []


def test_reactions_may_be_added_while_the_program_runs() -> None:
    assert errors("REACTOR = ADD<k> :: (E[k] # P[k])") == []
    assert errors("REACTOR = ADD<k> :: (E[k] # P[k + 1])") == ["unknown-process"]
    assert errors("REACTOR = ADD<k> :: (E[k] # P[k])  X = E[4] # P[4]  P[3] = Act[1]") == ["no-clause"]
