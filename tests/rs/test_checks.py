"""All checks together: what a user of `planner-reactor check` sees."""

from __future__ import annotations

import re

from planner_reactor.errors import Place
from planner_reactor.rs import checks
from planner_reactor.rs.checks import check, check_text
from planner_reactor.rs.terms import STOP, Call, Program, Schema, Seq
from tests.rs.findings import findings


def test_a_finding_reads_as_file_line_column_what_hint_and_shows_the_line() -> None:
    (found,) = check_text("P = Delay[1]\n  ; Dleay[2]", "cell.rsl")
    assert str(found) == ("cell.rsl:2:5: unknown process Dleay, did you mean Delay?\n      ; Dleay[2]\n        ^")


def test_findings_stand_in_the_order_of_the_text() -> None:
    found = findings("P = Qq : Rr\nQ[x] = Act[1]\nR = P ; Q[1] ; (STOP :; STOP)")
    assert [(f.place.line, f.place.column, f.code) for f in found] == [
        (1, 5, "unknown-process"),
        (1, 10, "unknown-process"),
        (2, 1, "unused-parameter"),
        (3, 17, "silent-loop"),
    ]


def test_a_text_that_cannot_be_read_is_not_checked_further() -> None:
    found = findings("P = Qq ; ;\nR = Ss\nT = A : B ; C")
    assert [f.code for f in found] == ["syntax", "mixed-operators"]


def test_terms_that_were_never_text_can_be_checked() -> None:
    program = Program([Schema("P", (), (), Seq((STOP, Call("Nothing"))))])
    (found,) = check(program)
    assert (found.code, found.place, found.line_text) == ("unknown-process", Place(1, 1), "")


def test_every_code_is_in_the_list() -> None:
    listed = set(re.findall(r"\b[a-z]+(?:-[a-z]+)*\b", checks.__doc__ or ""))
    used = """syntax too-long too-deep too-many-tokens rebound clash mixed-operators redefined clause-form
        overlapping-clauses unknown-process unknown-function no-clause argument-count result-count
        argument-kind unbound may-be-unbound unguarded-recursion silent-loop sit-position self-call
        asserted-below-itself unserved-port unserved-situation unreachable unused-parameter"""
    assert set(used.split()) <= listed
