"""Formulas and their notation: what is read is what is shown; mistakes are told with place and nearest name."""

from __future__ import annotations

import random

import pytest

from planner_reactor.analysis.notation import names_of, read_property
from planner_reactor.analysis.observing import WORDS, Atom
from planner_reactor.analysis.temporal import Formula, Here, atoms, holds, normal
from planner_reactor.errors import SourceError
from planner_reactor.rs.parser import parse_program
from tests.analysis.random_runs import formula, run

PROGRAM = parse_program("Main = ASSERT[Kit] : OUT[bell, 1] | IN[bell]<x> : Find[cap] | SIT[Kit]<k> :; SUCCEED[Kit, k]")


def true(text: str, *moments: str, loop: int = 0) -> bool:
    """Is it true of a run of moments such as "sent p, on s"?"""
    seen = [[a for part in m.split(",") if part for a in atoms(read_property(part).formula)] for m in moments]
    return holds(read_property(text).formula, list(map(frozenset, seen)), loop)


def test_words_mean_what_they_say() -> None:
    assert true("eventually sent p", "", "", "sent p")
    assert not true("eventually sent p", "sent q", "")
    assert true("always (sent p -> next on s)", "sent p", "on s", loop=0)
    assert not true("always (sent p -> next on s)", "sent p", "on s", "sent p", loop=2)
    assert true("sent p until sent q", "sent p", "sent p", "sent q")
    assert not true("sent p until sent q", "sent p", "")
    assert not true("sent p until sent q", "sent p")
    assert true("sent p unless sent q", "sent p")
    assert not true("never sent p", "", "sent p")
    assert true("sent p leads to sent q", "sent p", "sent q", "")
    assert not true("sent p leads to sent q", "sent q", "sent p", "", loop=2)
    assert true("sent q releases sent p", "sent p", "sent p, sent q", "")
    assert not true("sent q releases sent p", "sent p", "sent q", "")
    assert true("sent p <-> sent q", "sent p, sent q")


@pytest.mark.parametrize("text", [
    "always (asserted Kit -> eventually succeeded Kit) under weak fairness",
    "not sent p[3] until (on s or killed 4) under strong fairness of Find, Test",
    "always eventually stopped Find[cap] -> never ended abort",
    "next next (inhibited s and not stuck) <-> tick releases reported done",
    'true unless served "a name"',
])  # fmt: skip
def test_what_is_shown_reads_as_the_same(text: str) -> None:
    read = read_property(text)
    assert read_property(str(read)) == read


def test_operators_bind_as_the_notation_says() -> None:
    assert read_property("not on a and on b or on c -> on d") == read_property("((not on a and on b) or on c) -> on d")
    assert read_property("always on a until on b") == read_property("(always on a) until on b")
    assert read_property("on a -> on b -> on c") == read_property("on a -> (on b -> on c)")


def test_the_normal_form_means_the_same_and_has_negations_at_atoms_only() -> None:
    dice = random.Random(1)
    for _ in range(300):
        made, (moments, loop) = formula(dice, 4), run(dice)
        assert holds(normal(made), moments, loop) == holds(made, moments, loop)
        assert holds(normal(made, negated=True), moments, loop) != holds(made, moments, loop)


@pytest.mark.parametrize(("text", "column", "said"), [
    ("alwys sent bell", 1, "did you mean always?"),
    ("always (sent bell", 18, "for the `(` at column 8"),
    ("always sent bell)", 17, "expected an operator or the end, found `)`"),
    ("sent bell and", 14, "found the end"),
    ("sent", 1, "`sent` of which port?"),
    ("sent bel", 6, "the program has no port bel, did you mean bell?"),
    ("succeeded Kot", 11, "the program has no situation Kot, did you mean Kit?"),
    ("stopped Fnd", 9, "did you mean Find?"),
    ("sent bell undr weak fairness", 11, "did you mean under?"),
    ("sent bell under week fairness", 17, "did you mean weak?"),
    ("sent bell under weak", 21, "expected `fairness`"),
    ("sent bell & on Kit", 11, "`&` has no meaning in a property"),
    ("sent bell[", 11, "expected a value"),
    ("sent bell leads", 16, "expected `to` after `leads`"),
    ("(" * 200 + "true", 101, "levels of nesting"),
    ("not " * 200 + "true", 1 + 4 * 101, "levels of nesting"),
    ("", 1, "found the end"),
])  # fmt: skip
def test_a_mistake_is_told_with_its_place(text: str, column: int, said: str) -> None:
    with pytest.raises(SourceError) as caught:
        read_property(text, names_of(PROGRAM))
    assert said in str(caught.value)
    assert caught.value.place.column == column


def test_every_word_can_be_read() -> None:
    for word, (subject, _) in WORDS.items():
        name = {"nothing": "", "outcome": "stop", "label": "3"}.get(subject, "x")
        read: Formula = read_property(f"{word} {name}").formula
        assert read == Here(Atom(word, 3 if name == "3" else name))
