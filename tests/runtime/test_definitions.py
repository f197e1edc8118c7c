"""Definitions come and go while everything runs."""

from __future__ import annotations

import pytest

from planner_reactor.errors import InputError
from planner_reactor.rs.parser import parse_program
from planner_reactor.runtime import Executer, Host, Scheduler, VirtualClock
from tests.runtime.driving import begin


def test_a_definition_loaded_while_a_program_runs_is_found_by_the_next_call() -> None:
    begun = begin("(P[1] ; Delay[1]) :; STOP", "P[1] = Delay[1]")
    executer = begun.executer
    executer.run(0.5)
    executer.unload(parse_program("P[1] = Delay[1]").schemas)
    executer.load(parse_program("P[1] = Delay[3]").schemas)
    executer.run(6.0)
    # the call in progress goes on with what it was; the next one takes three seconds
    assert begun.at == [1.0, 2.0, 5.0, 6.0]


def test_a_call_of_what_was_unloaded_aborts() -> None:
    begun = begin("Delay[1] : P[1]", "P[1] = STOP")
    begun.executer.unload(parse_program("P[1] = STOP").schemas)
    begun.executer.run()
    assert (begun.outcome, begun.root.cause) == ("abort", "error")


def test_clauses_are_found_by_their_constants_however_many_there_are() -> None:
    text = "\n".join(f"P[{n}] = Delay[{n}]" for n in range(2000)) + "\nP[a,b] = STOP P[a,7] = ABORT Q[n] = P[n]"
    begun = begin("Q[3] ; Q[1999]", text)
    begun.executer.run(5000)
    assert (begun.outcome, begun.now) == ("stop", 2002.0)


def test_two_clauses_with_the_same_head_are_refused_and_nothing_is_half_loaded() -> None:
    executer = begin("STOP", "P[1] = STOP").executer
    with pytest.raises(InputError, match="P"):
        executer.load(parse_program("P[2] = STOP   R = STOP   P[1] = ABORT").schemas)
    assert "R" not in executer.definitions
    executer.load(parse_program("P[2] = STOP").schemas)


def test_a_definition_may_not_take_the_name_of_a_process() -> None:
    host = Host("h")

    @host.process(limit=1)
    def Move() -> None: ...

    for name in ("Delay", "Move"):
        with pytest.raises(InputError, match=name):
            Executer(parse_program(f"{name} = STOP"), scheduler=Scheduler(VirtualClock()), host=host)


def test_start_takes_values_and_collects_the_declared_results() -> None:
    executer = begin("STOP", "P[a,b]<s> = (OUT[p,a+b] | IN[p]<s>) : Delay[b]").executer
    root = executer.start("P", (1, 2))
    executer.run()
    assert (root.outcome, root.results, executer.scheduler.now) == ("stop", {"s": 3}, 2.0)


def test_start_says_what_is_wrong() -> None:
    executer = begin("STOP", "Place[1] = STOP").executer
    with pytest.raises(InputError, match="did you mean Place"):
        executer.start("Plaec")
    with pytest.raises(InputError, match="no clause"):
        executer.start("Place", (2,))
