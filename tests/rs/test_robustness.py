"""Whatever the text, the answer is a program or findings with a place: nothing else is ever raised."""

from __future__ import annotations

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from planner_reactor.errors import RSError
from planner_reactor.rs.checks import check, check_text
from planner_reactor.rs.linking import Linked
from planner_reactor.rs.parser import parse_program
from planner_reactor.rs.printer import show
from planner_reactor.rs.terms import Process, Program, Schema
from planner_reactor.rs.vocabulary import BUILT_IN
from tests.strategies import Tape, processes, programs, tapes

TOKENS = (
    "P", "Q", "x", "k", "SIT", "E", "IN", "OUT", "ASSERT", "Delay", "STOP", "\nP", "\nQ", "=", ";", ":", "|", "&",
    "#", "~", ":;", "::", "(", ")", "[", "]", "<", ">", ",", "if", "then", "else", "1", "-", "+", "==", ">=", '"a"',
    "//", "\n", "{", '"', "f(",
)  # fmt: skip
EXAMPLES = settings(max_examples=300, deadline=None)


def soup(tape: Tape) -> str:
    return " ".join(tape.choose(TOKENS) for _ in range(40))


@given(tapes(least=60).map(soup) | st.text(max_size=60))
@example("P=A\x00")
@example("P=A\u2028;B")
@example("\ufeffP=A")
@example("P = A[٣]")
@example("P = A[1e5000]")
@example("P=\r\n\r\nA\r;")
@EXAMPLES
def test_any_text_is_read_or_refused_with_a_place(text: str) -> None:
    found = check_text(text, "any.rsl")
    lines = text.split("\n")
    for finding in found:
        assert finding.place.file == "any.rsl"
        assert 1 <= finding.place.line <= len(lines)
        assert 1 <= finding.place.column <= len(lines[finding.place.line - 1]) + 1
        assert finding.message
        assert str(finding)


@given(programs(), st.data())
@settings(max_examples=100, deadline=None)
def test_a_sound_text_with_one_character_changed_is_read_or_refused(program: Program, data: st.DataObject) -> None:
    text = show(program, width=60)
    at = data.draw(st.integers(0, len(text) - 1))
    other = data.draw(st.sampled_from(["", " ", ";", ":", "(", ")", "]", "<", "x", "1", '"', "~"]))
    check_text(text[:at] + other + text[at + 1 :])


@given(st.lists(processes(depth=2), min_size=1, max_size=3))
@settings(max_examples=100, deadline=None)
def test_any_program_can_be_checked(bodies: list[Process]) -> None:
    program = Program(Schema(name, (), (), body) for name, body in zip(("P", "Act", "Sense"), bodies, strict=False))
    check(program, roots=["P"])


def test_a_program_whose_calls_may_select_too_many_clauses_is_refused() -> None:
    """Ten callers of a hundred clauses are a thousand links."""
    clauses = [f"P[{n}] = Delay[{n}]" for n in range(100)]
    program = parse_program("\n".join([*clauses, *(f"Q{n}[x] = P[x]" for n in range(10))]))
    assert len(Linked(program, BUILT_IN, ()).calls) == 110
    linked = Linked(program, BUILT_IN, (), most_links=999)
    with pytest.raises(RSError, match="may select more than 999 clauses"):
        _ = linked.calls
