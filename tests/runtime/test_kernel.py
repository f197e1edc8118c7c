"""The order in which things happen, and what a long-lived executer must not do: grow, recurse, or leave
rubbish.
"""

from __future__ import annotations

import gc
import inspect
import sys
from collections.abc import Iterator

import pytest

from planner_reactor.rs.parser import parse_process
from planner_reactor.runtime import Body, Budgets, Strand
from planner_reactor.runtime.strands import Fork
from tests.runtime.driving import Run, begin, run

FIFO = Budgets(slice=1)


@pytest.mark.parametrize("budgets", [Budgets(), FIFO])
class TestOrder:
    def test_a_stop_decides_before_an_abort_of_the_same_step(self, budgets: Budgets) -> None:
        assert run("ABORT # STOP", budgets=budgets).outcome == "stop"
        assert run("STOP # ABORT", budgets=budgets).outcome == "stop"

    def test_what_has_lost_never_takes_a_step(self, budgets: Budgets) -> None:
        ran = run("(OUT[p,1] # STOP) | (IN[p]<x> # Delay[1])", budgets=budgets)
        assert ran.seen == [("Delay", (1,), "ok", ())]
        assert ran.results == {}

    def test_an_inner_disable_is_decided_before_an_outer_one(self, budgets: Budgets) -> None:
        # the inner verdict is a stop, which then decides the outer one, although its left part aborted first
        assert run("ABORT # (ABORT # STOP)", budgets=budgets).outcome == "stop"

    def test_of_two_equally_deep_the_left_one_is_decided_first(self, budgets: Budgets) -> None:
        ran = run("OUT[p,1] | (((IN[p]<x> # NIL) & NIL) # ((STOP # NIL) & Delay[1]))", budgets=budgets)
        assert ran.outcome == "stop"

    def test_both_partners_of_a_rendezvous_go_on_before_any_verdict(self, budgets: Budgets) -> None:
        # both parts end in the same step: the stop of the right one wins over the abort of the left one
        ran = run("(OUT[p,1] : ABORT) # (IN[p]<x> : STOP)", budgets=budgets)
        assert (ran.outcome, ran.results) == ("stop", {"x": 1})

    def test_a_killed_writer_leaves_no_value_behind(self, budgets: Budgets) -> None:
        ran = run("((OUT[p,1] | OUT[p,2]) # Delay[1]) ; (IN[p]<x> # Delay[1])", budgets=budgets)
        assert ran.results == {}


def strands_of(begun: Run) -> list[Strand]:
    """The live strands of this run."""
    return [o for o in gc.get_objects() if isinstance(o, Strand) and o.alive and o.root is begun.root]


@pytest.fixture
def shallow() -> Iterator[None]:
    """Next to no recursion is allowed."""
    limit = sys.getrecursionlimit()
    sys.setrecursionlimit(len(inspect.stack()) + 150)
    yield
    sys.setrecursionlimit(limit)


@pytest.mark.usefixtures("shallow")
def test_fifty_thousand_nested_forks_are_killed_without_recursion() -> None:
    begun = begin("D[50000] # Delay[1]", "D[n] = if GTR[n,0] then (NIL # D[n-1]) else NIL")
    begun.executer.run(0.5)
    assert begun.executer.statistics().processes_live == 100_003
    begun.executer.run()
    assert begun.outcome == "stop"
    assert begun.executer.statistics().processes_live == 0


@pytest.mark.usefixtures("shallow")
def test_endings_run_through_ten_thousand_nested_forks_without_recursion() -> None:
    begun = begin("D[10000]", "D[n] = if GTR[n,0] then (NIL # (D[n-1] & STOP)) else Delay[1]")
    begun.executer.run()
    assert begun.outcome == "stop"


def test_a_root_is_killed_from_outside() -> None:
    begun = begin("(Delay[5] | IN[p]<x>) ; STOP")
    begun.executer.run(1.0)
    begun.executer.kill(begun.root)
    begun.executer.run(1.0)
    assert (begun.outcome, begun.root.cause) == ("abort", "cancelled")
    assert begun.executer.statistics().processes_live == 0
    assert begun.executer.ports() == {}


def test_tail_calls_and_loops_take_constant_space() -> None:
    begun = begin("T[0] # L", "T[n] = Delay[1] : GTR[n,-1] : T[n+1]   L = Delay[1] :; (Delay[1] ; STOP)")
    begun.executer.run(10.0)
    depths = [strand.stack[3] if strand.stack else 0 for strand in strands_of(begun)]
    begun.executer.run(1000.0)
    assert [strand.stack[3] if strand.stack else 0 for strand in strands_of(begun)] == depths
    assert max(depths) == 1
    assert begun.executer.statistics().processes_live == 3


def test_a_tail_call_below_an_if_is_a_tail_call() -> None:
    begun = begin("T[0]", "T[n] = if GTR[n,5] then (Delay[1] ; T[0]) else (Delay[1] ; T[n+1])")
    begun.executer.run(1000.0)
    (strand,) = strands_of(begun)
    assert strand.stack is not None
    assert strand.stack[3] == 1


def test_spawned_bodies_that_have_ended_leave_nothing() -> None:
    begun = begin("Delay[1] :: Delay[0.5]")
    begun.executer.run(500.25)
    assert begun.executer.statistics().processes_live == 3  # the root, the head, one body


def test_siblings_share_names_but_not_those_of_hidden_bodies() -> None:
    ran = run("((IN[p]<a> : LST[a,3]) :; Ran[1,1]<y>) | (OUT[p,1] ; OUT[p,3]) | (Ran[2,2]<y> ; Delay[1] ; Equal[y,2])")
    assert ran.results == {"a": 3, "y": 2.0}


def test_what_ends_leaves_no_cyclic_garbage() -> None:
    program = "T[n] = GTR[n,0] : (((Delay[1] | IN[p]<x>) # Delay[0.5]) ; T[n-1])"
    executer = begin("T[20]", program).executer
    gc.collect()
    gc.disable()
    try:
        executer.run(5.0)
        gc.set_debug(gc.DEBUG_SAVEALL)
        gc.collect()
        rubbish = [o for o in gc.garbage if isinstance(o, Strand | Fork | Body)]
        gc.garbage.clear()
    finally:
        gc.set_debug(0)
        gc.enable()
    assert rubbish == []


def test_timeouts_that_never_fire_do_not_pile_up() -> None:
    begun = begin("T[0] # Delay[3000]", "T[n] = ((Delay[1] # Delay[5000]) ; T[n+1])")
    begun.executer.run(2999.0)
    assert len(begun.executer.scheduler._instants) < 1100


def test_a_port_that_is_no_longer_used_costs_nothing() -> None:
    begun = begin("T[0]", "T[n] = ((OUT[n,1] | IN[n]<x>) ; Delay[1] ; T[n+1])")
    begun.executer.run(5000.0)
    assert len(begun.executer._compiler.ports._by_name) <= 1025
    assert begun.executer.ports() == {}


def test_ready_strands_take_turns_of_a_slice() -> None:
    program = "C[p,n] = GTR[n,0] : C[p,n-1]"
    process = "C[a,3] | (Equal[b,b] : Equal[b,b] : Equal[b,b])"
    assert run(process, program, budgets=FIFO).names == ["GTR", "Equal"] * 3 + ["GTR"]
    assert run(process, program).names == ["GTR"] * 4 + ["Equal"] * 3


def test_the_cause_of_a_roots_abort_is_told() -> None:
    assert run("GTR[1,2]").root.cause == "failed"
    assert run("OUT[p,1/0] : STOP").root.cause == "error"
    assert run("(GTR[1,2] ; OUT[p,1/0]) | GTR[1,2]").root.cause == "error"


def test_roots_run_side_by_side_and_meet_at_ports() -> None:
    begun = begin("IN[p]<x>")
    other = begun.executer.start_process(parse_process("Delay[1] : OUT[p,4]"))
    begun.executer.run()
    assert (begun.results, other.outcome) == ({"x": 4}, "stop")


def test_run_returns_when_nothing_is_left_to_do() -> None:
    begun = begin("IN[p]<x>")
    begun.executer.run()
    assert begun.outcome is None
    assert begun.executer.ports() == {"p": "IN"}
