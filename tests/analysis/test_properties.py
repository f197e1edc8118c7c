"""Deadlock, Zeno and properties of programs: each verdict also on a program with a defect."""

from __future__ import annotations

import pytest

from planner_reactor.analysis.labels import show_label
from planner_reactor.analysis.notation import read_property
from planner_reactor.analysis.properties import Verdict, check, deadlock_free, zeno_free
from planner_reactor.analysis.systems import System, build
from planner_reactor.analysis.temporal import atoms
from planner_reactor.rs.configurations import World, spawned_situations
from planner_reactor.rs.evolves import started
from planner_reactor.rs.parser import parse_process, parse_program
from planner_reactor.rs.vocabulary import BUILT_IN, Signature

OPEN = (0.0, float("inf"))
SIGNATURES = {**BUILT_IN, **{n: Signature(n, (), (), window=OPEN) for n in ("Try", "Rest")}}


def system(text: str, *asked: str, start: str = "Main", beside: str = "", limit: int = 5_000) -> System:
    program = parse_program(text)
    process = parse_process(start)
    world = World(program, SIGNATURES, spawned=spawned_situations(program, process))
    config = started(process, world)
    if beside:
        config = started(parse_process(beside), world, config=config)
    wanted = dict.fromkeys(a for p in asked for a in atoms(read_property(p).formula))
    return build(config, world, tuple(wanted), limit=limit)


def verdict(text: str, asked: str, *, beside: str = "") -> Verdict:
    return check(system(text, asked, beside=beside), read_property(asked))


def holds(text: str, asked: str, *, beside: str = "") -> bool | None:
    return verdict(text, asked, beside=beside).holds


def steps(found: Verdict) -> tuple[list[str], list[str]]:
    assert found.counterexample is not None
    return list(map(show_label, found.counterexample.prefix)), list(map(show_label, found.counterexample.cycle))


# ------------------------------------------------------------------------------------------------ deadlock and Zeno


def test_two_that_wait_for_each_other_are_a_deadlock_and_the_way_to_it_is_shortest() -> None:
    crossed = "Main = (IN[a]<x> : Delay[1] : IN[p]<y> : OUT[q, y]) | (OUT[a, 1] : IN[q]<z> : OUT[p, z])"
    found = deadlock_free(system(crossed))
    assert found.holds is False
    assert steps(found) == (["a!1", "1 s pass", "Delay[1]"], [])
    straight = "Main = (IN[a]<x> : Delay[1] : IN[p]<y> : OUT[q, y]) | (OUT[a, 1] : (OUT[p, 3] : IN[q]<z>))"
    assert deadlock_free(system(straight)).holds


def test_an_end_is_not_a_deadlock() -> None:
    assert deadlock_free(system("Main = Delay[1]")).holds
    assert deadlock_free(system("Main = ABORT")).holds


def test_the_tracking_stream_without_a_quantum_is_zeno_and_with_one_it_is_not() -> None:
    printed = "Main = (OUT[p, 1] :; STOP) | (IN[p]<x> :; STOP)"
    found = zeno_free(system(printed))
    assert found.holds is False
    assert steps(found) == ([], ["p!1"])
    assert zeno_free(system("Main = ((OUT[p, 1] ; Delay[0.1]) :; STOP) | (IN[p]<x> :; STOP)")).holds


def test_zeno_behind_something_that_takes_time_has_its_prefix() -> None:
    found = zeno_free(system("Main = Delay[2] : ((OUT[p, 1] :; STOP) | (IN[p]<x> :; STOP))"))
    assert steps(found) == (["2 s pass", "Delay[2]"], ["p!1"])


def test_a_loop_that_may_go_round_at_once_but_need_not_is_not_zeno() -> None:
    assert zeno_free(system("Main = Term[1] :; STOP")).holds
    assert zeno_free(system("Main = Try :; STOP")).holds


def test_beyond_the_limit_nothing_is_claimed_but_what_was_found_stands() -> None:
    grows = "Main = Count[0]\nCount[n] = Delay[1] : Count[n + 1]"
    some = system(grows, "eventually ended", limit=50)
    assert not some.complete
    assert deadlock_free(some).holds is None
    assert check(some, read_property("eventually ended")).holds is None
    assert check(system(grows, "never tick", limit=50), read_property("never tick")).holds is False


def test_what_can_be_seen_by_the_end_of_a_prefix_has_no_cycle() -> None:
    found = verdict("Main = Delay[1] :; STOP", "never stopped Delay").counterexample
    assert found is not None
    assert found.decided
    assert steps(verdict("Main = Delay[1] :; STOP", "never stopped Delay")) == (["1 s pass", "Delay[1]"], [])


# -------------------------------------------------------------------------------------------------------- fairness

RETRY = "Main = Asks | Serves\nAsks = Rest :; REASSERT[Kit]\n" + (
    "Serves = SIT[Kit]<k> :; (~(Try : SUCCEED[Kit, k]) : FAIL[Kit, k])"
)


def test_an_assertion_succeeds_only_if_trying_does_not_fail_for_ever() -> None:
    asked = "always (asserted Kit -> eventually succeeded Kit)"
    assert holds(RETRY, asked) is False
    assert holds(RETRY, f"{asked} under weak fairness") is False
    assert holds(RETRY, f"{asked} under strong fairness") is True
    assert holds(RETRY, f"{asked} under strong fairness of Try") is True
    assert holds(RETRY, f"{asked} under strong fairness of Rest") is False
    prefix, cycle = steps(verdict(RETRY, f"{asked} under weak fairness"))
    assert prefix == ["Rest"]
    assert cycle == ["REASSERT[Kit] waits", "SIT[Kit]<1>", "Try aborts", "FAIL[Kit, 1]"]


def test_weak_fairness_is_for_those_who_can_always_go_on() -> None:
    """Without it the other part may run for ever; it is not enough for whoever can go on only now and then."""
    two = "Main = (Try :; STOP) | (Rest :; OUT[p, 1]) | (IN[p]<x> :; STOP)"
    assert holds(two, "always eventually sent p") is False
    assert holds(two, "eventually stopped Rest under weak fairness") is False  # it may abort, which ends its loop
    always_able = "Main = Turn | (Delay[1] : OUT[go, 1])\nTurn = if IN[go]<x> then STOP else STOP"
    assert holds(always_able, "eventually ended under weak fairness") is True
    asks = "Main = (Try ; Rest) :; STOP"
    assert holds(asks, "always eventually stopped Try under weak fairness") is False
    assert holds(asks, "always eventually (stopped Try or aborted Try) under weak fairness of Rest") is False


def test_now_and_then_is_enough_for_strong_fairness() -> None:
    """A writer meets one reader or the other: the second is passed over for ever unless fairness is strong."""
    text = "Main = Writer | Reader[1] | Reader[2]\nWriter = Delay[1] : OUT[p, 1] : Writer\n" + (
        "Reader[n] = IN[p]<x> : REPORT[met, n] : Reader[n]"
    )
    assert holds(text, "eventually reported met[2] under weak fairness") is False
    assert holds(text, "eventually reported met[1]") is False
    assert holds(text, "always eventually sent p") is True


# ----------------------------------------------------------------------------------------------------------- words

TWO = """
Main = (STOP :; (ASSERT[s] ; Delay[1])) # P
P = SIT[s]<k> :; (~(Delay[2] : SUCCEED[s, k]) : FAIL[s, k])
"""


@pytest.mark.parametrize(("asked", "told"), [
    ("always (served s -> on s)", True),
    ("asserted s leads to served s", True),
    ("served s leads to succeeded s", True),
    ("always (succeeded s -> serving s)", True),
    ("never failed s", True),
    ("always (on s -> not quiescent s)", True),
    ("always not serving s", False),
    ("always (running Delay[1] or running Delay[2] or on s or asserted s)", True),
    ("always (tick -> running Delay)", True),
    ("stopped Delay[2] leads to stopped Delay[1]", True),
    ("never stopped Delay[2]", False),
    ("eventually ended", False),
])  # fmt: skip
def test_words_about_situations_and_processes(asked: str, told: bool) -> None:
    assert holds(TWO, asked) is told


@pytest.mark.parametrize(("asked", "told"), [
    ("eventually inhibited s under weak fairness", True),
    ("always (inhibited s -> never served s)", True),
    ("never queued s", False),
    ("asserted s leads to succeeded s under weak fairness", False),
    ("never failed s", False),
])  # fmt: skip
def test_words_about_a_drain(asked: str, told: bool) -> None:
    """DRAIN withdraws what is on: it ends as failed though nobody says FAIL."""
    assert holds(TWO, asked, beside="Try ; DRAIN[s] : NIL") is told


def test_words_about_ports_outcomes_and_ends() -> None:
    assert holds("Main = OUT[p, 3] | IN[p]<x>", "sent p[3] and not sent p[4] and next ended stop") is True
    assert holds("Main = Delay[1] : ABORT", "eventually ended abort and never ended stop") is True
    assert holds("Main = IN[p]<x> # Delay[1]", "never stuck and eventually ended") is True
    assert holds("Main = IN[p]<x>", "stuck") is True
    assert holds("Main = Try", "eventually aborted Try under weak fairness") is False
    assert holds("Main = E[1] # NIL", "eventually killed 1 under weak fairness", beside="KILL[1]") is True
    posted = "posted 2 or posted 3"
    adds = "Main = ADD<m> :: (E[m] # NIL)"
    assert holds(adds, f"eventually ({posted}) under weak fairness", beside="POST[2]") is True
    assert holds(adds, "eventually posted 3 under weak fairness", beside="POST[2]") is False
    stub = "Main = ASSERT[s] | (SIT[s]<k> : (STUB[s] ; FAIL[s, k]))"
    assert holds(stub, "eventually (stubbed s and eventually failed s)") is True
    assert holds("Main = REPORT[done, 4]", "reported done[4] and not reported done[5]") is True
