"""Budgets: nothing that a text says can eat the machine."""

from __future__ import annotations

from planner_reactor.runtime import Budgets, Host
from tests.runtime.driving import begin, run
from tests.runtime.toys import Opener

TIGHT = Budgets(turns=500, quantum=0.5)


def test_a_root_that_never_lets_time_pass_goes_on_a_quantum_later() -> None:
    ran = run("(OUT[p,1] :; STOP) | (IN[p]<x> :; STOP) | (Delay[2] : OUT[q,1]) | (IN[q]<y> ; Delay[1])",
              budgets=TIGHT, until=4.0)  # fmt: skip
    assert ran.root.outcome is None
    assert ran.results == {}
    assert ("COM", ("q", 1), "ok", ()) in ran.seen  # the others live on
    assert ran.executer.statistics().zeno == "root"
    assert ran.executer.statistics().rendezvous < 20_000


def test_the_definition_is_named() -> None:
    ran = run("Spin # Delay[1]", "Spin = Equal[1,1] : Spin", budgets=TIGHT)
    assert ran.outcome == "stop"
    assert ran.executer.statistics().zeno == "Spin"
    assert {event.data["name"] for event in ran.trace.of("zeno")} == {"Spin"}


def test_a_served_body_that_never_lets_time_pass_is_aborted() -> None:
    opener = Opener(most=2)
    process = "(OPEN<k> :; (Delay[1] : ((OUT[p,1] :; STOP) | (IN[p]<x> :; STOP)))) | Delay[5]"
    ran = run(process, controls=[opener], budgets=TIGHT)
    assert opener.log == [("opened", 1), ("abort", 1), ("opened", 2), ("abort", 2)]
    assert set(opener.causes) == {"budget"}
    assert (ran.seen[-1], ran.at[-1]) == (("Delay", (5,), "ok", ()), 5.0)


def test_only_the_nearest_body_is_aborted() -> None:
    opener = Opener(most=2)
    run("OPEN<k> ; ((OPEN<m> : (Spin | Delay[1])) ; Delay[1])", "Spin = Equal[1,1] : Spin",
        controls=[opener], budgets=TIGHT)  # fmt: skip
    assert opener.log == [("opened", 1), ("opened", 2), ("abort", 2), ("stop", 1)]


def test_an_aborted_body_in_a_call_goes_on_with_the_callers_bindings() -> None:
    opener = Opener(most=1)
    program = "Q[a] = (OPEN<k> : Deep[a]) ; OUT[p,a]   Deep[b] = Equal[1,1] : (Deep[b] ; STOP)"
    ran = run("Q[7] | IN[p]<x>", program, controls=[opener], budgets=TIGHT)
    assert ran.results == {"x": 7}


def test_a_silent_loop_is_caught_too() -> None:
    assert run("(STOP :; STOP) # Delay[1]", budgets=TIGHT).outcome == "stop"


def test_a_process_of_no_duration_is_caught_too() -> None:
    host = Host("h")

    @host.process(limit=1)
    def Blink():  # type: ignore[no-untyped-def]
        yield 0.0

    ran = run("(Blink :; STOP) # Delay[1]", host=host, budgets=TIGHT)
    assert ran.outcome == "stop"
    assert ran.executer.statistics().zeno == "root"


def test_many_strands_at_one_instant_are_no_zeno() -> None:
    program = "All[n] = if GTR[n,0] then (IN[n]<x> | All[n-1]) else NIL"
    begun = begin("All[3000]", program, budgets=TIGHT)
    begun.executer.run(0.0)
    assert begun.executer.statistics().processes_live > 3000


def test_no_more_strands_live_than_the_budget_allows() -> None:
    few = Budgets(processes=50)
    ran = run("P[0]", "P[n] = (Delay[1] : (NIL | P[n+1])) ; STOP", budgets=few)
    assert ran.executer.statistics().processes_live <= 50
    opener = Opener(most=1)
    run("OPEN<k> : P[0]", "P[n] = Delay[1] : (NIL | P[n+1])", budgets=few, controls=[opener])
    assert opener.log == [("opened", 1), ("abort", 1)]


def test_spawning_beyond_the_budget_is_dropped_and_noted() -> None:
    ran = run("Delay[0.1] :: NIL", budgets=Budgets(processes=20), until=10.0)
    assert ran.executer.statistics().processes_live == 20
    assert list(ran.trace.of("crowded"))


def test_calls_within_calls_are_bounded() -> None:
    ran = run("P", "P = Delay[1] : (P ; STOP)", budgets=Budgets(depth=30))
    assert ran.outcome == "stop"
    assert ran.executer.statistics().zeno == "P"
