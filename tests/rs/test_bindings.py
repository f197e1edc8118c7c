"""Definite binding: which variables may have no value when they are used."""

from __future__ import annotations

import pytest

from tests.rs.findings import messages, places

DOUBTFUL = "may-be-unbound"


@pytest.mark.parametrize(
    "text",
    [
        "P = Sense<x> : Act[x]",
        "P = Sense<x> : (Delay[1] ; Act[x])",
        "P = IN[p]<x> ; Act[x] ; OUT[p, 1]",  # IN never aborts
        "P = (Sense<x> & Sense<y>) : Act[x] : Act[y]",
        "P = Sense<x> :; Act[x]",
        "P = (IN[p]<x> ; Delay[1]) :; OUT[p, x]",
        "P = (Sense<x> | NIL) : Act[x]",  # never comes there
        "P = (Sense<x> # NIL) : Act[x]",
        "P = (Sense<x> # (Delay[1] :; STOP)) : Act[x]",  # a loop never stops
        "P = if Sense<x> then Act[x] else STOP",
        "P = (if Act[1] then Sense<x> else Sense<x>) : Act[x]",
        "P = (if Act[1] then Sense<x> else ABORT) : Act[x]",
        "P = ~(ASSERT[s]<x> ; ABORT) : Act[x]  Q = SIT[s] :; Act[1]",
        "P = ASSERT[s]<x> ; Act[x]  Q = SIT[s] :; Act[1]",  # an ASSERT that aborts has values too
        "P = ((~ASSERT[s]<x>) :; STOP) ; Act[x]  Q = SIT[s] :; Act[1]",
        "P = Q<x> : Act[x]  Q<y> = Sense<y>",
        "P = (Monitor # IN[p]<x>) : Act[x]  Monitor = Delay[1] :: OUT[p, 2]",
    ],
)
def test_these_are_surely_bound(text: str) -> None:
    assert messages(text, DOUBTFUL, "unbound") == []


@pytest.mark.parametrize(
    ("text", "column"),
    [
        ("P = Sense<x> ; Act[x]", 20),
        ("P = (Sense<x> | Delay[1]) : Act[x]", 33),
        ("P = (Sense<x> # Delay[1]) : Act[x]", 33),
        ("P = ~Sense<x> : Act[x]", 21),
        ("P = ~(Sense<x> & Delay[1]) : Act[x]", 34),
        ("P = (Sense<x> :; Delay[1]) ; Act[x]", 34),
        ("P = if Sense<x> then STOP else Act[x]", 36),
        ("P = (if Act[1] then Sense<x> else STOP) : Act[x]", 47),
        ("P = Sense<x> ; Act[f(1, 2 + x)]", 29),
        ("P = Q<x> ; Act[x]  Q<y> = Sense<y>", 16),
    ],
)
def test_these_may_be_unbound(text: str, column: int) -> None:
    assert places(text, DOUBTFUL) == [(1, column)]


def test_a_warning_names_the_binder() -> None:
    assert messages("P = Sense<x> ; Act[x]", DOUBTFUL) == [
        "x may be unbound here, what binds it, at 1:5, may abort or lose a `#`"
    ]


def test_a_result_used_where_it_does_not_reach_is_an_error() -> None:
    assert messages("P = Sense<x> | Act[x]", "unbound") == [
        "x is not bound here, the result x bound at 1:5 does not reach this place"
    ]
    assert places("P = (Delay[1] :; Sense<x>) ; Act[f(x)]", "unbound") == [(1, 36)]


def test_a_result_of_a_definition_must_be_bound_in_it() -> None:
    assert messages("P<pose> = Sense<pos> : Act[pos]", "unbound") == [
        "nothing in P binds its result pose, did you mean pos?"
    ]
    assert places("P<x> = Delay[1] :; Sense<x>", "unbound") == [(1, 1)]
    assert messages("P<x> = Sense<x> ; Delay[1]", DOUBTFUL) == [
        "x may be unbound when P stops, what binds it, at 1:8, may abort or lose a `#`"
    ]
    assert messages("P<x> = Sense<x> : Delay[1]", DOUBTFUL, "unbound") == []


def test_results_are_followed_through_recursion() -> None:
    assert messages("P<x> = if Sense<y> then Sense<x> else P<x>", DOUBTFUL) == []
    assert places("P<x> = if Sense<y> then STOP else P<x>", DOUBTFUL) == [(1, 1)]
