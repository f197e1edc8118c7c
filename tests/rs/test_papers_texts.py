"""The papers' own texts: they read, print and check; as printed, some do not."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from planner_reactor.errors import RSError
from planner_reactor.rs.checks import check
from planner_reactor.rs.parser import parse_program
from planner_reactor.rs.printer import show
from planner_reactor.rs.terms import Cond, Loop, Par, Program, Seq
from planner_reactor.rs.vocabulary import Signature
from tests.rs.findings import findings, messages

TEXTS = Path(__file__).parent / "papers"

ROBOT = {
    "Find": Signature("Find", ("symbol",), ("x",)),
    "Move": Signature("Move", ("any", "symbol")),
    "Test": Signature("Test", ("symbol", "any")),
    "FindGetInsert": Signature("FindGetInsert", ("symbol", "any")),
}


def read(name: str) -> Program:
    return parse_program((TEXTS / name).read_text(encoding="utf-8"), file=name)


@pytest.mark.parametrize(("name", "definitions"), [("reactors.rsl", 30), ("dynamics.rsl", 25)])
def test_every_text_of_the_papers_reads_and_prints(name: str, definitions: int) -> None:
    program = read(name)
    assert len(program) == definitions
    assert parse_program(show(program)) == program
    assert parse_program(show(program, width=80)) == program


def test_the_reactor_of_the_first_paper_passes_all_checks() -> None:
    """P0 to P14 of R §8.3 as clauses of a reactor: nothing is wrong, and the mixture of P4 is doubtful."""
    replaced = ("P4", "P23", "P24")
    program = read("reactors.rsl")
    numbered = [s for s in program.schemas if re.fullmatch(r"P\d+", s.name) and s.name not in replaced]
    text = "REACTOR = ADD<m> :: (E[m] # P[m])\n" + "\n".join(
        show(s).replace(s.name, f"P[{s.name[1:]}]", 1) for s in numbered
    )
    found = check(parse_program(text), signatures=ROBOT)
    assert [f for f in found if f.severity == "error"] == []


def test_the_precedence_that_the_papers_equations_force() -> None:
    program = read("reactors.rsl")
    (ite,) = program.clauses("ITE1")
    assert show(ite) == "ITE1 = ~(Cond1 : Then1) : Else1"
    assert isinstance(ite.body, Cond)
    (reactor,) = program.clauses("REACTOR")
    assert show(reactor) == "REACTOR = (E[1] # SP1) | (E[2] # SP2) | ADD<k> :: (E[k] # SP[k])"
    assert isinstance(reactor.body, Par)
    (served,) = program.clauses("PS")
    assert isinstance(served.body, Par)
    assert all(isinstance(part, Loop) for part in served.body.parts)


def test_p4_fails_its_situation_even_if_the_stub_aborts() -> None:
    """`STUB : SUSPEND ; FAIL` is (STUB : SUSPEND) ; FAIL, and the linter says that it is a mixture."""
    (p4,) = read("reactors.rsl").clauses("P4")
    assert isinstance(p4.body, Loop)
    assert isinstance(p4.body.body, Seq)
    text = "P4 = SIT[FillTray]<k,x1> :; (STUB[FillTray] : SUSPEND[2000] ; FAIL[FillTray,k])"
    (found,) = findings(text, "mixed-operators")
    assert (found.severity, found.place.column) == ("warning", 61)
    assert "A:B;C is (A:B);C" in found.hint
    assert findings(show(p4), "mixed-operators") == []


def test_as_printed_p23_lacks_a_parenthesis() -> None:
    with pytest.raises(RSError) as caught:
        parse_program(
            "P23 = SIT[AcquireTray]<k> :; (~(REASSERT[FindGoodPart]<x1> : Move[x1,trayarea]\n"
            "   : (UPDATE[AcquireTray,k,x1] ; SUCCEED[AcquireTray,k])) : FAIL[AcquireTray,k]\n"
        )
    assert "expected `)`, found the end of the text, to close the `(` at 1:30" in str(caught.value)


def test_as_printed_p0_would_spawn_for_ever() -> None:
    assert messages("P0 = STOP :: ASSERT[Kitting]", "silent-loop") == [
        "this `::` spawns for ever at one instant, "
        "its condition must take a step before it stops; `:;` waits for the body"
    ]
    assert findings("P0 = STOP :; ASSERT[Kitting]", "silent-loop") == []


def test_as_printed_add_takes_its_label_as_an_argument() -> None:
    with pytest.raises(RSError, match="arguments stand in square brackets"):
        parse_program("REACTOR = ADD(k) :: (E[k] # P[k])")
    (wrong, *_) = findings("REACTOR = ADD[k] :: (E[k] # P[k])\nP[1] = Act[1]")
    assert (wrong.code, wrong.hint) == ("argument-count", "expected ADD<m>")


def test_printed_definitions_of_built_in_processes_are_refused() -> None:
    """STREAM as printed is Zeno and REASSERT as printed aborts on success: both are built in."""
    text = "STREAM[y,v] = OUT[y,v] :; STOP\nREASSERT[s,p] = (~ASSERT[s,p]) :; STOP"
    assert [f.code for f in findings(text, "redefined")] == ["redefined", "redefined"]


def test_constants_of_a_model_must_be_given() -> None:
    """The models of X leave t0, eps, … open: they read, but they do not run before these are numbers."""
    found = check(read("dynamics.rsl"), signatures=ROBOT, functions={"f"})
    assert {f.code for f in found if f.severity == "error"} == {"argument-kind", "unknown-process"}
