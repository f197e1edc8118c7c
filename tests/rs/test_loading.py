"""Loading: all of a text or nothing of it, beside what is there already."""

from __future__ import annotations

import pytest

from planner_reactor.errors import RSError
from planner_reactor.rs.loading import load
from planner_reactor.rs.terms import Program
from tests.strategies import HOST

REACTOR = "REACTOR = ADD<m> :: (E[m] # P[m])\nP[1] = SIT[s]<k> :; (Act[1] ; SUCCEED[s, k])"


def test_the_definitions_of_the_text_are_returned() -> None:
    program = load(REACTOR, signatures=HOST)
    assert sorted(program.names) == ["P", "REACTOR"]


def test_an_addition_is_checked_beside_what_is_there_and_returned_alone() -> None:
    given = load(REACTOR, signatures=HOST)
    added = load("P[2] = SIT[t]<k> :; (ASSERT[s] ; SUCCEED[t, k])", signatures=HOST, given=given)
    assert len(added) == 1
    assert len(given) == 2


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("P[1] = Act[2]", r"new.rsl:1:1: P\[1\] is defined twice"),
        ("P[2] = SIT[s]<k> : Act[1]", "in a reaction a SIT is the whole left side"),
        ("P[2] = SIT[t] :; ASSERT[t]", "situation t is asserted from below itself"),
        ("P[2, x] = Act[x]", "differs in form"),
        ("Q = Q", "calls itself before it takes a step"),
        ("Q = Atc[1]", "unknown process Atc, did you mean Act?"),
        ("Q = Act[1", "expected `]`"),
    ],
)
def test_an_addition_that_does_not_fit_is_refused(text: str, message: str) -> None:
    given = load(REACTOR, signatures=HOST)
    with pytest.raises(RSError, match=message) as caught:
        load(text, file="new.rsl", signatures=HOST, given=given)
    assert caught.value.diagnostics[0].line_text == text


def test_warnings_do_not_stop_a_program() -> None:
    load("P[x] = Act[1] : Act[2] ; ASSERT[nowhere]", signatures=HOST)


def test_all_errors_are_reported_together() -> None:
    with pytest.raises(RSError) as caught:
        load("P = Qq\nR = Delay[soon]", given=Program())
    assert [f.code for f in caught.value.diagnostics] == ["unknown-process", "argument-kind"]
