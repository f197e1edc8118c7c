"""The rules of docs/language.md for processes without situations, as the executer keeps them: one section per
rule id.
"""

from __future__ import annotations

import pytest

from tests.runtime.driving import run


@pytest.mark.parametrize(
    ("process", "outcome"),
    [
        ("STOP ; ABORT", "abort"),
        ("ABORT ; STOP", "stop"),
        ("STOP : ABORT", "abort"),
        ("ABORT : STOP", "abort"),
        ("STOP : STOP", "stop"),
        ("~ABORT", "stop"),
        ("~STOP", "abort"),
        ("~(ABORT ; STOP)", "abort"),
        ("STOP | ABORT", "stop"),
        ("ABORT | ABORT", "abort"),
        ("STOP & ABORT", "abort"),
        ("STOP & STOP", "stop"),
        ("STOP # NIL", "stop"),
        ("NIL # ABORT", "abort"),
        ("if STOP then ABORT else STOP", "abort"),
        ("if ABORT then ABORT else STOP", "stop"),
    ],
)
def test_outcomes_of_the_operators(process: str, outcome: str) -> None:
    assert run(process).outcome == outcome


def test_n1_seq_goes_on_after_an_abort_and_keeps_its_bindings() -> None:
    ran = run("(OUT[p,5] | ~IN[p]<x>) ; Equal[x,5]")
    assert ran.outcome == "stop"
    assert ran.results == {"x": 5}


def test_n1_seq_loses_the_outcome_of_its_left_part() -> None:
    assert run("GTR[1,2] ; STOP").outcome == "stop"


def test_n2_cond_does_not_go_on_after_an_abort() -> None:
    ran = run("GTR[1,2] : GTR[2,1]")
    assert ran.seen == [("GTR", (1, 2), "ab", ())]
    assert ran.outcome == "abort"


def test_n2_an_abort_keeps_what_was_bound_before_it() -> None:
    ran = run("(Ran[4,4]<x> : ABORT)")
    assert ran.outcome == "abort"
    assert ran.results == {"x": 4.0}


def test_n3_negation_swaps_stop_and_abort_and_keeps_bindings() -> None:
    ran = run("~(Ran[4,4]<x> : GTR[1,2]) : Equal[x,4]")
    assert ran.outcome == "stop"


def test_n4_par_waits_for_all_and_stops_if_one_does() -> None:
    ran = run("(Delay[3] : ABORT) | Delay[1]")
    assert (ran.outcome, ran.now) == ("stop", 3.0)


def test_n4_and_needs_every_part() -> None:
    ran = run("(Delay[3] : ABORT) & Delay[1]")
    assert (ran.outcome, ran.now) == ("abort", 3.0)


def test_n4_all_parts_bindings_leave() -> None:
    assert run("Ran[1,1]<x> | (Ran[2,2]<y> : ABORT)").results == {"x": 1.0, "y": 2.0}


def test_n5_the_first_to_end_decides_and_the_others_are_aborted() -> None:
    ran = run("(Delay[1] : ABORT) # (Delay[2] : OUT[p,1])")
    assert (ran.outcome, ran.now) == ("abort", 1.0)
    assert ran.executer.ports() == {}


def test_n5_the_bindings_of_the_losers_are_gone() -> None:
    ran = run("((Ran[1,1]<x> : Delay[9]) # (Ran[2,2]<y> : Delay[1])) ; OUT[p,x]")
    assert ran.seen[-1] == ("OUT", (), "ab", ())
    assert ran.results == {"y": 2.0}


def test_n5_of_two_that_stop_in_one_step_the_left_one_decides() -> None:
    program = "P<x> = (Delay[1] : Ran[1,1]<x>) | Q   Q = OUT[q,1]"
    ran = run("(IN[p]<x> # IN[p]<y>) | OUT[p,7]", program)
    assert ran.results == {"x": 7}


def test_n6_n7_only_declared_results_leave_a_definition() -> None:
    program = "P<x> = Ran[1,1]<x> : Ran[2,2]<y>"
    assert run("P<z>", program).results == {"z": 1.0}
    assert run("P", program).results == {}


def test_n7_a_result_that_was_not_bound_stays_unbound() -> None:
    program = "P<x> = GTR[1,2] : Ran[1,1]<x>"
    ran = run("P<z> ; OUT[p,z]", program)
    assert ran.results == {}
    assert ran.root.cause == "error"


def test_n7_an_abort_hands_over_results_too() -> None:
    assert run("P<z>", "P<x> = Ran[1,1]<x> : ABORT").results == {"z": 1.0}


def test_n7_each_call_has_bindings_of_its_own() -> None:
    program = "P[a]<x> = Delay[a] : (OUT[p,a] | IN[p]<x>)"
    assert run("P[1]<u> | P[2]<v>", program).results == {"u": 1, "v": 2}


def test_n8_a_loop_ends_when_its_condition_aborts_and_only_then() -> None:
    ran = run("((IN[p]<x> : LST[x,3]) :; ABORT) & (OUT[p,1] ; OUT[p,2] ; OUT[p,3])")
    assert ran.outcome == "abort"
    assert ran.names == ["COM", "LST"] * 3


def test_n8_the_bindings_that_leave_a_loop_are_those_of_its_last_condition() -> None:
    ran = run("((IN[p]<x> : LST[x,3]) :; STOP) | (OUT[p,1] ; OUT[p,2] ; OUT[p,8])")
    assert ran.results == {"x": 8}


def test_n8_results_are_fresh_in_each_round() -> None:
    loop = "(IN[p]<x> : (if GTR[x,1] then Ran[5,5]<y> else STOP)) :; OUT[q,y]"
    ran = run(f"({loop}) # (OUT[p,2] : IN[q]<z> : OUT[p,1] : Delay[1])")
    assert ran.results == {"z": 5.0}
    assert ("OUT", (), "ab", ()) in ran.seen


def test_n8_spawn_goes_on_at_once_and_ends_with_its_last_body() -> None:
    ran = run("((IN[p]<x> : LST[x,9]) :: (Delay[x] : GTR[x,2])) | (OUT[p,3] ; OUT[p,2] ; OUT[p,9])")
    assert ran.now == 3.0
    assert ran.outcome == "stop"
    assert ran.at[-2:] == [3.0, 3.0]


def test_n8_spawn_aborts_when_no_body_has_stopped() -> None:
    ran = run("((IN[p]<x> : LST[x,9]) :: GTR[x,5]) & (OUT[p,3] ; OUT[p,2] ; OUT[p,9])")
    assert ran.outcome == "abort"


def test_n8_each_spawned_body_has_the_bindings_of_its_own_round() -> None:
    ran = run("((IN[p]<x> :: (Delay[1] : OUT[q,x])) # Delay[5]) | (OUT[p,1] ; OUT[p,2]) | (IN[q]<a> ; IN[q]<b>)")
    assert (ran.results["a"], ran.results["b"]) == (1, 2)


def test_n8_what_a_body_binds_is_hidden() -> None:
    ran = run("((IN[p]<x> : LST[x,3]) :; Ran[1,1]<y>) | (OUT[p,1] ; OUT[p,3])")
    assert ran.results == {"x": 3}


def test_n10_the_condition_decides_once_and_its_bindings_are_seen_in_both_branches() -> None:
    assert run("if Ran[1,1]<x> then Equal[x,1] else STOP").outcome == "stop"
    assert run("if (Ran[1,1]<x> : GTR[x,2]) then STOP else Equal[x,2]").outcome == "abort"


def test_com_hands_a_value_over_once() -> None:
    ran = run("OUT[p,7] | IN[p]<x>")
    assert ran.seen == [("COM", ("p", 7), "ok", ())]
    assert ran.results == {"x": 7}


def test_com_serves_first_come_first() -> None:
    ran = run("IN[p]<a> | IN[p]<b> | (Delay[1] : OUT[p,1] : OUT[p,2])")
    assert ran.results == {"a": 1, "b": 2}
    ran = run("OUT[p,1] | OUT[p,2] | (Delay[1] : IN[p]<a> : IN[p]<b>)")
    assert ran.results == {"a": 1, "b": 2}


def test_com_a_partner_that_was_aborted_is_not_served() -> None:
    ran = run("(IN[p]<a> # Delay[1]) | IN[p]<b> | (Delay[2] : OUT[p,5])")
    assert ran.results == {"b": 5}


def test_com_parts_of_a_disable_may_meet_each_other() -> None:
    assert run("OUT[p,7] # IN[p]<x>").outcome == "stop"


def test_time_passes_for_all_together() -> None:
    ran = run("Delay[2] | Delay[1] | Delay[3]")
    assert ran.at == [1.0, 2.0, 3.0]


def test_time_waits_for_what_is_urgent() -> None:
    ran = run("(Delay[1] : OUT[p,1] : OUT[p,2]) | (IN[p]<x> : IN[p]<y> : GTR[y,x]) | Delay[1.5]")
    assert ran.names == ["Delay", "COM", "COM", "GTR", "Delay"]
    assert ran.at == [1.0, 1.0, 1.0, 1.0, 1.5]


def test_term_ends_at_a_random_age_up_to_its_bound() -> None:
    ages = [run("Term[2]", seed=seed).now for seed in range(20)]
    assert all(0 <= age <= 2 for age in ages)
    assert len(set(ages)) > 10


def test_suspend_counts_milliseconds() -> None:
    assert run("SUSPEND[250]").now == 0.25


def test_stream_writes_again_after_a_quantum() -> None:
    ran = run("STREAM[y,3] # Delay[0.095] # (IN[y]<a> :; STOP)")
    assert ran.executer.statistics().rendezvous == 10


def test_tests_compare_numbers_and_equal_any_value_with_a_tolerance() -> None:
    assert (
        run("GTR[2,1] : LST[1,2] : Equal[1,1.0000000001] : Equal[a,a] : ~Equal[a,b] : Equal[1,2,1.5]").outcome == "stop"
    )
    assert run("GTR[a,1]").outcome == "abort"


def test_arguments_without_a_value_are_one_step_that_aborts() -> None:
    ran = run("P[1/0] ; OUT[p,1/0] ; Delay[x] ; STOP", "P[a] = STOP")
    assert ran.seen == [("P", (), "ab", ()), ("OUT", (), "ab", ()), ("Delay", ("x",), "ab", ())]
    assert ran.outcome == "stop"


def test_a_clause_is_chosen_by_value_when_it_is_called() -> None:
    program = 'P[1] = STOP   P[2] = ABORT   P["a"] = STOP'
    assert run("P[1] : P[a] : ~P[2]", program).outcome == "stop"
    ran = run("P[3]", program)
    assert (ran.outcome, ran.root.cause, ran.seen) == ("abort", "error", [("P", (), "ab", ())])
