"""Loading: all of a text or nothing of it, beside what is there already."""

from __future__ import annotations

import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from planner_reactor.errors import Diagnostic, Place, RSError
from planner_reactor.rs.checks import check, check_addition
from planner_reactor.rs.loading import load, load_process
from planner_reactor.rs.parser import parse_process
from planner_reactor.rs.terms import Call, Number, Program, Schema, Symbol
from tests.strategies import HOST, Scope, Tape, processes, sound_leaf

REACTOR = "REACTOR = ADD<m> :: (E[m] # P[m])\nP[1] = SIT[s]<k> :; (Act[1] ; SUCCEED[s, k])"


def test_the_definitions_of_the_text_are_returned() -> None:
    program = load(REACTOR, signatures=HOST)
    assert sorted(program.names) == ["P", "REACTOR"]


def test_an_addition_is_checked_beside_what_is_there_and_returned_alone() -> None:
    there = load(REACTOR, signatures=HOST)
    added = load("P[2] = SIT[t]<k> :; (ASSERT[s] ; SUCCEED[t, k])", signatures=HOST, given=there)
    assert len(added) == 1
    assert len(there) == 2


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
    there = load(REACTOR, signatures=HOST)
    with pytest.raises(RSError, match=message) as caught:
        load(text, file="new.rsl", signatures=HOST, given=there)
    assert caught.value.diagnostics[0].line_text == text


def test_warnings_do_not_stop_a_program() -> None:
    load("P[x] = Act[1] : Act[2] ; ASSERT[nowhere]", signatures=HOST)


def test_all_errors_are_reported_together() -> None:
    with pytest.raises(RSError) as caught:
        load("P = Qq\nR = Delay[soon]", given=Program())
    assert [f.code for f in caught.value.diagnostics] == ["unknown-process", "argument-kind"]


def wild_call(tape: Tape, scope: Scope, fresh: str) -> Call:
    """Calls of each other's definitions, situations and guards, in every wrong way."""
    situation = Symbol(tape.choose(("s", "t")))
    match tape.choose(("step", "own", "own", "SIT", "ASSERT", "E")):
        case "own":
            label = tape.choose((None, 1, 2))
            number = tape.choose((1, 2, 3, 4))
            return Call(f"D{number}") if label is None else Call("P", (Number(label),))
        case "SIT":
            return Call("SIT", (situation,))
        case "ASSERT":
            return Call("ASSERT", (situation,))
        case "E":
            return Call("E", (Number(1),))
        case _:
            return sound_leaf(tape, scope, fresh)


def wild_programs() -> st.SearchStrategy[Program]:
    body = processes(depth=2, leaf=wild_call)
    names = [("D1", ()), ("D2", ()), ("D3", ()), ("D4", ()), ("P", (Number(1),)), ("P", (Number(2),))]
    chosen = st.lists(st.sampled_from(names), min_size=2, max_size=5, unique=True)
    return chosen.flatmap(
        lambda heads: st.tuples(*[body] * len(heads)).map(
            lambda bodies: Program(
                Schema(name, head, (), b, Place(line, 1))
                for line, ((name, head), b) in enumerate(zip(heads, bodies, strict=True), 1)
            )
        )
    )


def broken(found: tuple[Diagnostic, ...]) -> set[tuple[str, str]]:
    return {(f.code, f.message) for f in found if f.severity == "error"}


@given(wild_programs(), st.integers(0, 4))
@settings(max_examples=200, deadline=None)
def test_an_addition_is_wrong_exactly_if_the_whole_is_wrong(program: Program, first: int) -> None:
    """If what is there passed the checks, looking at the addition alone misses nothing."""
    there, added = Program(program.schemas[:first]), Program(program.schemas[first:])
    assume(not broken(check(there, signatures=HOST)))
    assert bool(broken(check_addition(there, added, signatures=HOST))) == bool(broken(check(program, signatures=HOST)))


def test_a_process_is_loaded_beside_the_definitions_that_it_calls() -> None:
    there = load("Serve[t] = Delay[t]", signatures=HOST)
    assert load_process("Serve[3] ; Act[1]", given=there, signatures=HOST) == parse_process("Serve[3] ; Act[1]")


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("Sevre[3]", "<process>:1:1: unknown process Sevre, did you mean Serve?"),
        ("Serve[soon]", "<process>:1:7: soon is a symbol where a number is expected"),
        ("Serve", "<process>:1:1: Serve takes 1 argument, 0 given, expected Serve[t]"),
        ("Serve[3", "<process>:1:8: expected `]`, found the end of the text"),
    ],
)
def test_a_process_that_cannot_be_started_says_why(text: str, message: str) -> None:
    there = load("Serve[t] = Delay[t]")
    with pytest.raises(RSError) as caught:
        load_process(text, given=there)
    assert message in str(caught.value)
