"""Adaptations verified before they are issued: sliced, remembered by shape, each defect refused with its reason."""

from __future__ import annotations

import pytest
from msgspec.structs import replace

from planner_reactor.analysis.adaptations import Environment, Verdict, Verifier
from planner_reactor.analysis.labels import show_label
from planner_reactor.analysis.slicing import sliced
from planner_reactor.rs.parser import parse_program
from planner_reactor.rs.printer import show
from planner_reactor.rs.reactions import Reaction, Surgery, reaction_of
from planner_reactor.rs.vocabulary import Signature

PRESENT = """
P[0] = STOP :; ASSERT[kit]
P[1] = SIT[kit]<k> :; (~(REASSERT[fetch]<x> : REASSERT[fill, x] : SUCCEED[kit, k]) : FAIL[kit, k])
P[2] = SIT[fetch]<k> :; (~(Find<x> : Get[x] : (UPDATE[fetch, k, x] ; SUCCEED[fetch, k])) : FAIL[fetch, k])
P[3] = SIT[fill]<k, x> :; (~((REASSERT[cap, x] & REASSERT[body, x]) : SUCCEED[fill, k]) : FAIL[fill, k])
P[4] = SIT[cap]<k, x> :; (~(Put[x] : SUCCEED[cap, k]) : FAIL[cap, k])
P[5] = SIT[body]<k, x> :; (~(Put[x] : SUCCEED[body, k]) : FAIL[body, k])
P[6] = ASSUMONITOR[A, 2000]
"""
NEW = """
P[7] = SIT[cap]<k, x> :; (~(Find<y> : Put[y] : SUCCEED[cap, k]) : FAIL[cap, k])
P[8] = SIT[body]<k, x> :; (~(Find<y> : Put[y] : SUCCEED[body, k]) : FAIL[body, k])
P[9] = SIT[fill]<k, x> :; (~(REASSERT[cap, x] : SUCCEED[fill, k]) : FAIL[fill, k])
P[10] = HOLDMONITOR[A, 2000]
"""
KNOWN = Environment({n: Signature(n, window=(0.0, t)) for n, t in (("Find", 3.0), ("Get", 4.0), ("Put", 5.0))})
CAP = Surgery(held=("cap",), kills=(4,), adds=(7,), named=("cap",))
BODY = Surgery(held=("body",), kills=(5,), adds=(8,), named=("body",))
FILL = Surgery(held=("fill", "cap"), kills=(3, 4), adds=(7, 9), named=("fill", "cap"))


def reactions(text: str) -> list[Reaction]:
    return [r for r in map(reaction_of, parse_program(text).schemas) if r is not None]


def verdict(surgery: Surgery, verifier: Verifier | None = None, *, present: str = PRESENT, new: str = NEW) -> Verdict:
    coming = [r for r in reactions(new) if r.label in surgery.adds]
    return (verifier or Verifier(KNOWN)).verify(reactions(present), coming, surgery)


@pytest.mark.parametrize(("surgery", "seconds"), [(CAP, 5.0), (BODY, 5.0), (FILL, 10.0)])
def test_a_right_adaptation_holds_and_its_bound_is_a_number(surgery: Surgery, seconds: float) -> None:
    found = verdict(surgery)
    assert found.holds, found
    assert found.bound_s == seconds


@pytest.mark.parametrize("mode", ["drain", "versions"])
def test_it_holds_in_every_mode_that_waits_for_nobody(mode: str) -> None:
    assert verdict(FILL, Verifier(KNOWN, mode=mode)).holds


def test_waiting_for_what_is_asserted_again_and_again_is_not_bounded() -> None:
    found = verdict(FILL, Verifier(KNOWN, mode="wait"))
    assert found.safe
    assert not found.bounded
    assert found.cycle


@pytest.mark.parametrize(
    ("surgery", "law", "why"),
    [
        (replace(CAP, held=()), "safe", "KILL[4] is reached while its reaction is at work"),
        (replace(FILL, held=("cap", "fill")), "local", "fill is held up at cap, and is not drained yet"),
        (replace(FILL, held=("cap",)), "safe", "KILL[3] is reached while its reaction is at work"),
        (replace(CAP, kills=(4, 99)), "atomic", "the script aborts half-way"),
        (replace(CAP, named=()), "local", "cap is held, and the adaptation does not name it"),
        (replace(CAP, kills=(4, 0)), "safe", "from here on the script cannot end"),
    ],
)
def test_each_defect_is_refused_with_its_reason(surgery: Surgery, law: str, why: str) -> None:
    root = PRESENT.replace("STOP :; ASSERT[kit]", "STOP :; (ASSERT[kit] ; Find)")
    found = verdict(surgery, present=root)
    assert not found.holds
    assert not getattr(found, law)
    assert found.why == why


def test_a_counterexample_speaks_the_names_of_the_reactor() -> None:
    found = verdict(replace(CAP, held=()))
    steps = [show_label(label) for label in found.counterexample]
    assert "ASSERT[cap] waits" in steps
    assert "SIT[cap]<1>" in steps


def test_what_may_go_on_for_ever_is_not_bounded() -> None:
    found = verdict(CAP, present=PRESENT.replace("Put[x] : SUCCEED[cap, k]", "(Put[x] :; Find<y>)"))
    assert not found.bounded
    unserved = verdict(CAP, present=PRESENT.replace("Put[x] : SUCCEED[cap, k]", "IN[port]<y> : SUCCEED[cap, k]"))
    assert (unserved.bounded, unserved.why) == (False, "what serves cap may go on for ever")


def test_a_situation_worked_out_at_run_time_is_refused() -> None:
    found = verdict(CAP, present=PRESENT.replace("REASSERT[cap, x]", "REASSERT[x]"))
    assert not found.holds
    assert found.why.startswith("P[3] asserts a situation that is worked out at run time")


def test_adaptations_of_one_shape_are_looked_at_once() -> None:
    verifier = Verifier(KNOWN)
    assert verdict(CAP, verifier).states > 0
    again = verdict(BODY, verifier)
    assert again.states == 0
    assert again.holds
    assert len(verifier.seen) == 1
    assert verdict(FILL, verifier).states > 0


def test_a_shape_that_was_refused_is_refused_again_under_its_own_names() -> None:
    verifier = Verifier(KNOWN)
    verdict(replace(CAP, named=()), verifier)
    again = verdict(replace(BODY, named=()), verifier)
    assert (again.states, again.why) == (0, "body is held, and the adaptation does not name it")


def test_a_slice_holds_what_is_touched_and_who_asks_for_it() -> None:
    made = sliced(reactions(PRESENT), [r for r in reactions(NEW) if r.label == 7], CAP).slice
    assert [show(schema) for schema in made.schemas] == [
        "P[0] = SIT[s0]<k> :; (~(Works : SUCCEED[s0, k]) : FAIL[s0, k])",
        "P[1] = SIT[s0]<k> :; (~(Works : SUCCEED[s0, k]) : FAIL[s0, k])",
    ]
    assert made.asked == ("s0",)


def test_what_lies_between_is_kept() -> None:
    surgery = Surgery(held=("kit", "cap"), kills=(1, 4), adds=(7, 11), named=("kit", "cap"))
    again = PRESENT.splitlines()[2].replace("P[1]", "P[11]")
    coming = reactions(NEW + again)
    part = sliced(reactions(PRESENT), [r for r in coming if r.label in (7, 11)], surgery)
    assert set(part.situations.values()) == {"kit", "cap", "fill"}


def test_monitors_come_and_go_without_a_look() -> None:
    found = verdict(Surgery(kills=(6,), adds=(10,)))
    assert found.holds
    assert found.states == 1


@pytest.mark.parametrize(
    ("surgery", "holds"), [(FILL, True), (replace(FILL, held=("cap", "fill")), False), (replace(CAP, held=()), False)]
)
def test_what_is_too_large_is_looked_at_situation_by_situation(surgery: Surgery, holds: bool) -> None:
    assert verdict(surgery, Verifier(KNOWN, small=3)).holds == holds
