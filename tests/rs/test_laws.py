"""The algebraic laws of docs/language.md, on random terms: those that hold, and those that must fail."""

from __future__ import annotations

from itertools import count

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from planner_reactor.analysis.equivalence import behaviour, bisimilar
from planner_reactor.rs.configurations import World
from planner_reactor.rs.parser import parse_process
from planner_reactor.rs.terms import (
    ABORT,
    NIL,
    STOP,
    All,
    Call,
    Cond,
    Disable,
    If,
    Loop,
    Not,
    Number,
    Par,
    Process,
    Seq,
    Spawn,
    cond,
    seq,
)
from planner_reactor.rs.vocabulary import Signature

INFINITY = float("inf")
BASIC = {n: Signature(n, (), ("x",), window=(0.0, INFINITY)) for n in "abc"}
UNTIMED = World(signatures=BASIC, endings=lambda name, arguments: [(True, (name,)), (False, (name,))])

FEW = settings(max_examples=40, deadline=None)


@st.composite
def terms(draw: st.DrawFn, depth: int = 2, timed: bool = False) -> Process:
    """A small closed process over basic processes that may end either way at any time."""


    def leaf() -> Process:
        kind = draw(st.sampled_from(["a", "b", "c", "STOP", "ABORT", "delay" if timed else "a"]))
        if kind == "delay":
            return Call("Delay", (Number(draw(st.sampled_from([1, 2, 3]))),))
        if kind in ("STOP", "ABORT"):
            return Call(kind)
        return Call(kind, (), ("x",))

    def term(depth: int) -> Process:
        if depth == 0 or draw(st.integers(0, 3)) == 0:
            return leaf()
        kind = draw(st.sampled_from([";", ":", "|", "&", "#", "~", "if"]))
        if kind == "~":
            return Not(term(depth - 1))
        if kind == "if":
            return If(term(depth - 1), term(depth - 1), term(depth - 1))
        left, right = term(depth - 1), term(depth - 1)
        return {";": lambda: seq(left, right), ":": lambda: cond(left, right)}.get(
            kind, lambda: {"|": Par, "&": All, "#": Disable}[kind]((left, right))
        )()

    return term(depth)


def apart(*processes: Process) -> tuple[Process, ...]:
    """The same processes with result names that are all different."""
    counter = count(1)

    def renamed(p: Process) -> Process:
        match p:
            case Call(name, arguments, results):
                return Call(name, arguments, tuple(f"x{next(counter)}" for _ in results))
            case Not(body):
                return Not(renamed(body))
            case If(test, then, otherwise):
                return If(renamed(test), renamed(then), renamed(otherwise))
            case Loop() | Spawn():
                raise AssertionError
            case _:
                return type(p)(tuple(renamed(q) for q in p.parts))

    return tuple(renamed(p) for p in processes)


def same(p: Process, q: Process, *, bindings: bool = True) -> bool:
    return bisimilar(p, q, UNTIMED, bindings=bindings)


SMALL = terms(depth=1)
TINY = terms(depth=0)


@FEW
@given(SMALL, SMALL, TINY)
def test_concurrency_is_commutative_and_associative(p: Process, q: Process, r: Process) -> None:
    p, q, r = apart(p, q, r)
    for operator in (Par, All):
        assert same(operator((p, q)), operator((q, p)))
        assert same(operator((operator((q, r)), p)), operator((q, operator((r, p)))))
        assert same(operator((operator((q, r)), p)), operator((q, r, p)))


@FEW
@given(SMALL, SMALL, TINY)
def test_disabling_is_commutative_and_associative_where_no_two_end_at_once(p: Process, q: Process, r: Process) -> None:
    p, q, r = apart(p, q, r)
    assert same(Disable((p, q)), Disable((q, p)), bindings=False)
    assert same(Disable((Disable((p, q)), r)), Disable((p, Disable((q, r)))), bindings=False)


@FEW
@given(SMALL, SMALL, TINY)
def test_sequence_and_condition_are_associative(p: Process, q: Process, r: Process) -> None:
    p, q, r = apart(p, q, r)
    assert same(Seq((Seq((p, q)), r)), seq(p, seq(q, r)))
    assert same(Cond((Cond((p, q)), r)), cond(p, cond(q, r)))
    assert same(Cond((Seq((p, q)), r)), seq(p, cond(q, r)))


@FEW
@given(terms(), SMALL)
def test_negation_is_its_own_inverse_and_passes_a_sequence(p: Process, q: Process) -> None:
    p, q = apart(p, q)
    assert same(Not(Not(p)), p)
    assert same(Not(seq(p, q)), seq(p, Not(q)))


@FEW
@given(terms())
def test_the_units_of_sequence_and_condition(p: Process) -> None:
    p, = apart(p)
    assert same(seq(STOP, p), p)
    assert same(seq(ABORT, p), p)
    assert same(cond(STOP, p), p)
    assert same(cond(p, STOP), p)
    assert same(cond(ABORT, p), ABORT)


@FEW
@given(terms())
def test_stop_and_abort_beside_a_process(p: Process) -> None:
    p, = apart(p)
    assert same(Par((p, ABORT)), p)
    assert same(Par((p, STOP)), seq(p, STOP))
    assert same(Disable((p, STOP)), STOP, bindings=False)
    assert same(Disable((p, NIL)), p)


@FEW
@given(SMALL, TINY)
def test_the_loops_unfold(a: Process, b: Process) -> None:
    a, b = apart(a, b)
    basic = Call("a")  # a condition that takes a step, so that no round passes silently
    condition = cond(basic, a)
    loop = Loop(condition, b)
    assert same(loop, cond(condition, seq(b, loop)), bindings=False)


@pytest.mark.parametrize("body", ["a", "a;b", "a#b", "ABORT", "STOP", "~a", "Delay[1]"])
def test_spawning_unfolds_into_a_concurrent_body(body: str) -> None:
    left = parse_process(f"(IN[p]<x> :: ({body})) | (OUT[p, 1] ; OUT[p, 2])")
    right = parse_process(f"(IN[p]<x> : (({body}) | (IN[p]<y> :: ({body})))) | (OUT[p, 1] ; OUT[p, 2])")
    assert same(left, right, bindings=False)


@pytest.mark.parametrize(("body", "outcome"), [("STOP", True), ("ABORT", False), ("Delay[1]", True)])
def test_spawning_stops_if_a_body_stopped_though_its_condition_aborted(body: str, outcome: bool) -> None:
    once = parse_process(f"((IN[p]<x> : GTR[x, 0]) :: ({body})) | ((OUT[p, 1] ; OUT[p, 0]) : ABORT)")
    ends = {end for end in behaviour(once, UNTIMED).ends if end is not None}
    assert ends == {outcome}


@FEW
@given(terms(timed=True), terms(depth=1, timed=True))
def test_laws_hold_with_delays_too(p: Process, q: Process) -> None:
    p, q = apart(p, q)
    assert same(Par((p, q)), Par((q, p)))
    assert same(Not(seq(p, q)), seq(p, Not(q)))
    assert same(Disable((p, STOP)), STOP, bindings=False)


NON_LAWS = {
    "(P:Q);R = P:(Q;R)": ("(a:b);c", "a:(b;c)"),
    "~(P:Q) = ~P:~Q": ("~(a:b)", "~a:~b"),
    "~(P|Q) = ~P|~Q": ("~(a|b)", "~a|~b"),
    "P;STOP = P": ("a;STOP", "a"),
    "P|STOP = P": ("a|STOP", "a"),
    "P|P = P": ("a|a", "a"),
    "P#P = P with two different ends": ("(a;b)#(a;b)", "a;b"),
    "; over |": ("a;(b|c)", "(a;b)|(a;c)"),
    ": over #": ("a:(b#c)", "(a:b)#(a:c)"),
    "& is |": ("a&b", "a|b"),
}


@pytest.mark.parametrize(("left", "right"), NON_LAWS.values(), ids=list(NON_LAWS))
def test_what_is_no_law_fails(left: str, right: str) -> None:
    assert not same(parse_process(left), parse_process(right), bindings=False)
