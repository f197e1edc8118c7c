"""The three modes on every small reactor of a family: nothing is to be said against them but what is known.

`wait` may be overtaken for ever, where instances overlap or a child fails again and again; whoever waits at a port for
one who is served no more waits for ever. Everything else holds, in every state. And each wrong order is seen.
"""

from __future__ import annotations

import pytest
from msgspec.structs import replace

from planner_reactor.analysis.labels import show_label
from planner_reactor.analysis.protocols import Checked
from planner_reactor.calls.replaying import replay
from planner_reactor.rs.bounds import Bounds
from planner_reactor.rs.configurations import World, spawned_situations
from planner_reactor.rs.parser import parse_process, parse_program
from planner_reactor.rs.terms import operands
from planner_reactor.rs.vocabulary import Signature
from tests.analysis.small_reactors import LEAVES, MODES, SHAPES, Case, cases, explored, looked_at, named

LOADED = {"overlapping", "persistent", "both", "shared"}
"""Shapes in which something of a situation may be on at every moment."""

AT_PORTS = {"meeting", "joined"}
"""Shapes in which a body waits for another one."""

QUICK = ("one", "two reactions :; a only", "meeting :;", "nested :;", "persistent :;", "joined")
SMALL = [case for case in cases() if case.name.startswith(QUICK)]
"""A part that takes seconds; the others are looked at by `python -m tests.analysis.small_reactors`."""


def shape_of(case: Case) -> str:
    return next(s.name for s in SHAPES if case.name.startswith(f"{s.name} "))


def is_as_known(case: Case, mode: str, found: Checked) -> bool:
    """Is nothing broken but what must be?"""
    if not found.broken:
        return True
    broken = found.broken.get("bounded")
    if set(found.broken) != {"bounded"} or broken is None:
        return False
    if shape_of(case) in AT_PORTS:  # the one is served, the other not any more
        return not broken.cycle
    return mode == "wait" and shape_of(case) in LOADED and broken.cycle > 0


@pytest.mark.parametrize("mode", MODES)
def test_every_mode_is_safe_consistent_atomic_local_and_ends(mode: str) -> None:
    wrong = {case.name: found.first for case in SMALL if not is_as_known(case, mode, found := explored(case, mode))}
    assert not wrong


def test_the_family_covers_what_it_should() -> None:
    names = [case.name for case in cases()]
    assert len(names) == len(set(names)) > 50
    assert {shape_of(case) for case in cases()} == {shape.name for shape in SHAPES}
    assert any("-c" in name for name in names)  # a child that is needed no more
    assert any("+e" in name for name in names)  # and one that is new


def test_bodies_that_wait_for_each_other_have_no_bound_and_so_are_never_adapted() -> None:
    case = named("meeting :; a")
    served = tuple(operands(reaction.schema.body)[1] for reaction in case.killed)
    assert Bounds(parse_program(case.text), LEAVES, {}, lambda situation: served).drains(["a"]) == float("inf")


# ------------------------------------------------------------------------------------ each wrong order has its steps


def steps(found: Checked, law: str) -> list[str]:
    return [show_label(label) for label in found.broken[law].path]  # type: ignore[index]


def runs(case: Case, script: str, found: Checked, law: str) -> bool:
    """Does the executer take these steps?"""
    program = parse_program(case.text)
    signatures = {name: Signature(name, window=(0.0, 1e6)) for name in LEAVES}
    world = World(program, signatures, spawned=spawned_situations(program))
    return replay([parse_process("R"), parse_process(script)], world, found.broken[law].path).done  # type: ignore[index]


OLD_AND_NEW = "an instance of a is served by the old reaction and by the new one"
TOO_EARLY = "KILL[2] is reached while its reaction is at work"
ALONE = "an instance of a is left that no reaction serves"


@pytest.mark.parametrize(
    ("script", "law", "why", "length"),
    [
        ("RENEW[a] : RETIRE[2] : POST[12] : WAITOLD[a] : KILL[2]", "consistent", OLD_AND_NEW, 7),
        ("RETIRE[2] : POST[12] : RENEW[a] : WAITOLD[a] : KILL[2]", "consistent", OLD_AND_NEW, 6),
        ("RENEW[a] : POST[12] : WAITOLD[a] : KILL[2]", "consistent", OLD_AND_NEW, 6),
        ("RETIRE[2] : RENEW[a] : POST[12] : KILL[2]", "safe", TOO_EARLY, 6),
        ("RETIRE[2] : RENEW[a] : POST[12] : KILL[2]", "consistent", ALONE, 6),
        ("DRAIN[a] : KILL[2] : UNINHIBIT[a]", "consistent", ALONE, 5),
        ("DRAIN[a] : POST[12] : UNINHIBIT[a] : KILL[2]", "consistent", OLD_AND_NEW, 7),
    ],
)
def test_each_wrong_order_is_seen(script: str, law: str, why: str, length: int) -> None:
    case = named("one :; a")
    found = looked_at(case, script, patient=True)
    assert found.broken[law].why == why  # type: ignore[index]
    assert len(found.broken[law].path) == length  # type: ignore[index]
    assert runs(case, script, found, law)


def test_what_an_old_parent_may_still_assert_must_not_go_before_it() -> None:
    case, surgery = named("nested :; p-c"), "RETIRE[2] : RETIRE[3] : RENEW[p] : POST[12]"
    found = looked_at(case, f"{surgery} : RENEW[c] : WAITOLD[c] : KILL[3] : WAITOLD[p] : KILL[2]", patient=True)
    assert found.broken["bounded"].why == "from here on the script cannot end"
    assert steps(found, "bounded")[-1] == "RENEW[c]"  # the old parent's next child is served by nobody
    assert not looked_at(
        case, f"{surgery} : WAITOLD[p] : KILL[2] : RENEW[c] : WAITOLD[c] : KILL[3]", patient=True
    ).broken


AGAIN = """
P[22] = SIT[p]<k> :; (~(ASSERT[c] : SUCCEED[p, k]) : FAIL[p, k])
P[23] = SIT[c]<k> :; (~(Works : SUCCEED[c, k]) : FAIL[c, k])
"""


def test_several_versions_stand_beside_each_other() -> None:
    case = named("one :; a")
    case = replace(case, text=case.text + "\nP[22] = SIT[a]<k> :; (~(Works : SUCCEED[a, k]) : FAIL[a, k])")
    first, second = "RETIRE[2] : RENEW[a] : POST[12]", "RETIRE[12] : RENEW[a] : POST[22]"
    found = looked_at(
        case, f"{first} : ((WAITOLD[a] : KILL[2]) & ({second})) : WAITOLD[a] : KILL[12]", patient=True,
        later=((frozenset({12}), frozenset({22})),),
    )  # fmt: skip
    assert not found.broken
    assert found.states > 100


@pytest.mark.parametrize(("renewed", "holds"), [("RENEW[c] : ", True), ("", False)])
def test_a_situation_that_comes_back_while_its_old_reaction_stands_is_renewed(renewed: str, holds: bool) -> None:
    case = named("nested :; p-c")
    case = replace(case, text=case.text + AGAIN)
    removal = "WAITOLD[p] : KILL[2] : RENEW[c] : WAITOLD[c] : KILL[3]"
    again = f"RETIRE[12] : RENEW[p] : {renewed}POST[23] : POST[22]"
    found = looked_at(
        case, f"RETIRE[2] : RETIRE[3] : RENEW[p] : POST[12] : (({removal}) & ({again})) : WAITOLD[p] : KILL[12]",
        patient=True, later=((frozenset({12}), frozenset({22, 23})),),
    )  # fmt: skip
    assert (not found.broken) == holds
    if not holds:
        assert found.broken["consistent"].why == "an instance of c is served by the old reaction and by the new one"


def test_what_comes_back_does_not_keep_the_old_from_going() -> None:
    """The next asserts again and again: waiting for none at all might take for ever, waiting for the old ends."""
    case = named("overlapping :; a")
    waits, waits_old = (looked_at(case, f"RETIRE[3] : RENEW[a] : POST[13] : {wait}[a]") for wait in ("WAIT", "WAITOLD"))
    assert waits.broken["bounded"].cycle
    assert not waits_old.broken


@pytest.mark.parametrize("mode", ["drain", "versions"])
def test_an_assumption_that_fails_meanwhile_changes_nothing(mode: str) -> None:
    case = named("nested :; c")
    case = replace(case, text=case.text + "\nBroken = DISABLE[c, A] ; ENABLE[c, A]")
    found = explored(case, mode, reactor="R | Broken")
    assert not found.broken
    assert found.states > explored(named("nested :; c"), mode).states
