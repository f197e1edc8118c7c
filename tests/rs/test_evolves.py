"""Each rule of the semantics, by its id: what it says, and what it does not (docs/language.md)."""

from __future__ import annotations

import pytest

from planner_reactor.analysis.explore import explore
from planner_reactor.errors import BudgetError
from planner_reactor.rs.configurations import Config, World, spawned_situations
from planner_reactor.rs.evolves import started
from planner_reactor.rs.leaves import elapsed, slack, steps
from planner_reactor.rs.parser import parse_process, parse_program
from planner_reactor.rs.states import Ended
from planner_reactor.rs.vocabulary import Signature

OPEN = (0.0, float("inf"))
LEAVES = {n: Signature(n, (), ("r",), window=OPEN) for n in ("a", "b", "c")}
LEAVES |= {"yes": Signature("yes", (), ("r",), window=OPEN), "no": Signature("no", (), ("r",), window=OPEN)}
LEAVES["timed"] = Signature("timed", (), (), window=(1.0, 3.0))


def endings(name: str, arguments: tuple[object, ...]) -> list[tuple[bool, tuple[object, ...]]]:
    match name:
        case "yes":
            return [(True, (1,))]
        case "no":
            return [(False, (0,))]
        case "timed":
            return [(True, ())]
        case _:
            return [(True, (name,)), (False, (name,))]


def world(program: str = "", *texts: str) -> World:
    definitions = parse_program(program)
    spawned = spawned_situations(definitions, *(parse_process(t) for t in texts))
    return World(definitions, LEAVES, endings=endings, spawned=spawned)


def run(*texts: str, program: str = "") -> set[tuple[bool, tuple[tuple[str, object], ...]] | str]:
    """Every way in which the last of these roots may end: (stopped?, results), or "runs"."""
    w = world(program, *texts)
    config = Config()
    for n, text in enumerate(texts):
        config = started(parse_process(text, file=f"root{n}"), w, config=config)
    found = explore(config, w)
    assert found.complete
    ends = [found.states[n].roots[-1][1] for n in found.ends]
    return {(e.ok, e.bindings) if isinstance(e, Ended) else "runs" for e in ends}


STOPS = {(True, ())}
ABORTS = {(False, ())}


def test_n1_a_sequence_goes_on_after_stop_and_after_abort() -> None:
    assert run("yes;STOP") == STOPS
    assert run("no;STOP") == STOPS
    assert run("yes<x>;yes<y>") == {(True, (("x", 1), ("y", 1)))}


def test_n1_the_outcome_of_a_sequence_is_not_that_of_its_first_part() -> None:
    assert run("yes;ABORT") == ABORTS


def test_n2_a_condition_goes_on_after_stop() -> None:
    assert run("yes:no") == ABORTS
    assert run("yes<x>:GTR[x, 0]") == {(True, (("x", 1),))}


def test_n2_a_condition_does_not_go_on_after_abort() -> None:
    assert run("no<x>:yes<y>") == {(False, (("x", 0),))}


def test_n3_negation_swaps_outcomes_and_keeps_results() -> None:
    assert run("~yes<x>") == {(False, (("x", 1),))}
    assert run("~no") == STOPS


def test_n3_negation_does_not_swap_what_follows() -> None:
    assert run("~no:ABORT") == ABORTS


def test_n4_concurrent_parts_stop_if_one_stops_once_all_have_ended() -> None:
    assert run("yes|no") == STOPS
    assert run("no|no") == ABORTS
    assert run("yes<x>|no<y>") == {(True, (("x", 1), ("y", 0)))}


def test_n4_concurrent_parts_do_not_end_before_the_last() -> None:
    assert run("yes|NIL") == {"runs"}


def test_n4_all_parts_must_stop_for_the_ampersand() -> None:
    assert run("yes&yes") == STOPS
    assert run("yes&no") == ABORTS


def test_n5_the_first_part_to_end_decides() -> None:
    assert run("a#NIL") == {(True, ()), (False, ())}
    assert run("Delay[1]#(Delay[2]:ABORT)") == STOPS


def test_n5_stop_wins_if_two_parts_end_in_one_step() -> None:
    assert run("ABORT#STOP") == STOPS
    assert run("STOP#ABORT#NIL") == STOPS


def test_n5_results_of_the_losers_are_unbound() -> None:
    assert run("((yes<x>;NIL)#Delay[1]) : GTR[x, 0]") == ABORTS


def test_n5_an_ended_part_is_decided_before_any_other_step() -> None:
    assert run("(OUT[p, 1]#STOP) | IN[p]<x>") == {"runs"}


def test_n5_inner_disablings_are_decided_before_outer_ones() -> None:
    assert run("~(STOP#NIL)#ABORT#NIL") == ABORTS
    assert run("~(ABORT#NIL)#ABORT#NIL") == STOPS


def test_n6_results_pass_outwards_and_later_ones_are_kept() -> None:
    assert run("yes<x>;(no<y>;STOP)") == {(True, (("x", 1), ("y", 0)))}


def test_n6_and_n7_only_declared_results_leave_a_definition() -> None:
    assert run("T<y>", program="T<r> = yes<r> ; no<s>") == {(False, (("y", 1),))}
    assert run("T", program="T<r> = yes<r> ; no<s>") == ABORTS


def test_n7_arguments_are_values_and_clauses_are_chosen_by_them() -> None:
    program = "T[1] = STOP\nT[2] = ABORT"
    assert run("T[2-1]", program=program) == STOPS
    assert run("T[2]", program=program) == ABORTS
    assert run("T[3]", program=program) == ABORTS  # no clause applies: cause error


def test_n7_recursion_that_nothing_guards_does_not_run() -> None:
    with pytest.raises(BudgetError):
        run("T", program="T = T")


def test_n8_a_loop_ends_only_when_its_condition_aborts() -> None:
    assert run("no:;yes") == ABORTS
    assert run("(IN[p]<x> : GTR[x, 0]) :; no", "OUT[p, 1] ; OUT[p, 0]") == STOPS


def test_n8_bindings_of_a_body_are_hidden_and_those_of_the_last_condition_leave() -> None:
    text = "((IN[p]<x> : GTR[x, 0]) :; yes<y>) | (OUT[p, 1] ; OUT[p, 0])"
    assert run(text) == {(True, (("x", 0),))}


def test_n8_spawning_goes_on_while_its_bodies_run() -> None:
    text = "((IN[p]<x> : GTR[x, 0]) :: (IN[q]<y>)) | (OUT[p, 1] ; OUT[p, 0])"
    assert run(text) == {"runs"}
    assert run(text, "OUT[q, 1]") == STOPS


def test_n9_an_aborted_assert_fails_its_instance() -> None:
    reactor = "SIT[s]<k> :; (Delay[5] ; SUCCEED[s, k])"
    assert run(reactor, "ASSERT[s] # Delay[1]", "Delay[2] ; WAIT[s]") == STOPS


def test_n9_an_aborted_drain_releases_its_queue() -> None:
    reactor = "SIT[s]<k> :; (Delay[5] ; SUCCEED[s, k])"
    assert run(reactor, "ASSERT[s]", "(DRAIN[s] # Delay[1]) ; STOP", "Delay[2] ; ASSERT[s]") == STOPS


def test_n10_the_test_decides_once() -> None:
    assert run("if yes then no else yes") == ABORTS
    assert run("if no then no else yes") == STOPS


def test_n10_the_papers_if_runs_its_else_when_the_then_part_aborts() -> None:
    """Equation (1) read literally: `~(C:P):Q`, and the whole aborts when P stops."""
    assert run("~(yes:no):yes<x>") == {(True, (("x", 1),))}
    assert run("~(yes:yes):yes<x>") == ABORTS


def test_com_one_reader_for_each_write() -> None:
    assert run("OUT[p, 7] | IN[p]<x> | IN[p]<y>") == {"runs"}
    assert run("OUT[p, 7] | IN[p]<x>") == {(True, (("x", 7),))}


def test_time_passes_only_when_nothing_is_urgent() -> None:
    w = world()
    config = started(parse_process("GTR[2, 1] ; Delay[3]"), w)
    assert [s.label[0] for s in steps(config, w) if s.urgent] == ["GTR"]
    (after,) = [s.after for s in steps(config, w)]
    assert slack(after, w) == 3
    assert not list(steps(elapsed(after, 2.0, w), w))
    assert [s.urgent for s in steps(elapsed(after, 3.0, w), w)] == [True]


def test_time_a_basic_process_ends_inside_its_window_and_is_urgent_at_its_end() -> None:
    w = world()
    config = started(parse_process("timed"), w)
    assert not list(steps(config, w))
    assert [s.urgent for s in steps(elapsed(config, 1.0, w), w)] == [False]
    assert [s.urgent for s in steps(elapsed(config, 3.0, w), w)] == [True]


def test_an_argument_without_a_value_aborts() -> None:
    assert run("(no<x> # NIL) ; Delay[x]") == {(True, (("x", 0),))}
    assert run("((yes<x>;NIL)#STOP) : Delay[x]") == ABORTS
    assert run("Delay[port]") == ABORTS


# ------------------------------------------------------------------------------------------------- situations

SERVE = "SIT[s]<k, x> :; (UPDATE[s, k, x + 1] ; SUCCEED[s, k])"


def test_assert_returns_the_values_that_were_updated() -> None:
    assert run(SERVE, "ASSERT[s, 4]<y>") == {(True, (("y", 5),))}


def test_assert_aborts_if_the_instance_fails() -> None:
    assert run("SIT[s]<k> :; FAIL[s, k]", "ASSERT[s]") == ABORTS


def test_assert_does_not_return_while_a_body_is_in_service() -> None:
    assert run("SIT[s]<k> :; (SUCCEED[s, k] ; NIL)", "ASSERT[s]") == {"runs"}


def test_the_first_verdict_wins_and_verdicts_themselves_stop() -> None:
    assert run("SIT[s]<k> :; (FAIL[s, k] : SUCCEED[s, k])", "ASSERT[s]") == ABORTS


def test_sit_serves_one_instance_at_a_time_with_a_synchronous_loop() -> None:
    reactor = "SIT[s]<k> :; (IN[p]<x> ; SUCCEED[s, k])"
    assert run(reactor, "ASSERT[s] | ASSERT[s]", "Delay[1] ; OUT[p, 1] ; WAIT[s]") == {"runs"}


def test_sit_serves_all_instances_with_an_asynchronous_loop() -> None:
    reactor = "SIT[s]<k> :: (OUT[p, 1] ; SUCCEED[s, k])"
    assert run(reactor, "ASSERT[s] & ASSERT[s]", "IN[p]<x> ; IN[p]<y>") == {(True, (("x", 1), ("y", 1)))}


def test_sit_does_not_run_away_for_an_instance_that_it_serves() -> None:
    found = explore(
        started(parse_process("(SIT[s]<k> :: NIL) | ASSERT[s]"), world("", "SIT[s]<k> :: NIL")), world()
    )
    assert found.complete
    assert len(found.states) < 10


def test_sit_delivers_the_least_recently_served_instance_first() -> None:
    reactor = "SIT[s]<k, x> :; OUT[p, x]"
    read = "Delay[1] ; IN[p]<a1> ; IN[p]<a2> ; IN[p]<a3>"
    assert run(reactor, "ASSERT[s, 1] | ASSERT[s, 2]", read) <= {
        (True, (("a1", 1), ("a2", 2), ("a3", 1))),
        (True, (("a1", 2), ("a2", 1), ("a3", 2))),
    }


def test_an_instance_that_ends_cancels_its_descendants() -> None:
    reactor = "(SIT[s]<k> :; (ASSERT[t] | (Delay[1] ; SUCCEED[s, k])))"
    assert run(reactor, "ASSERT[s]") == STOPS


def test_an_owner_that_has_ended_asserts_nothing_more() -> None:
    reactor = "(SIT[s]<k> :; (SUCCEED[s, k] ; ~ASSERT[t] : OUT[p, 1]))"
    assert run(reactor, "ASSERT[s]", "IN[p]<x>") == {(True, (("x", 1),))}


def test_asserting_a_situation_from_below_itself_is_an_error_unless_it_is_spawned() -> None:
    body = "(~ASSERT[s] : OUT[p, 1]) ; FAIL[s, k]"
    assert run(f"SIT[s]<k> :; ({body})", "ASSERT[s]", "IN[p]<x>") == {(True, (("x", 1),))}
    spawned = "SIT[s]<k, n> :: (((GTR[n, 0] : ASSERT[s, n - 1]) ; SUCCEED[s, k]))"
    assert run(spawned, "ASSERT[s, 2]") == STOPS


def test_inhibit_keeps_a_situation_from_being_served_and_lets_it_be_asserted() -> None:
    assert run(SERVE, "INHIBIT[s] ; NIL", "Delay[1] ; ASSERT[s, 1]") == {"runs"}


def test_an_inhibition_ends_with_its_owner_and_only_its_owner_takes_it_back() -> None:
    assert run(SERVE, "INHIBIT[s]", "Delay[1] ; ASSERT[s, 1]<y>") == {(True, (("y", 2),))}
    assert run(SERVE, "INHIBIT[s] ; NIL", "Delay[1] ; UNINHIBIT[s] ; ASSERT[s, 1]<y>") == {"runs"}
    assert run(SERVE, "INHIBIT[s] ; Delay[2] ; UNINHIBIT[s] ; NIL", "Delay[1] ; ASSERT[s, 1]<y>") == {
        (True, (("y", 2),))
    }


def test_inhibitions_are_counted() -> None:
    assert run(SERVE, "INHIBIT[s] ; INHIBIT[s] ; UNINHIBIT[s] ; NIL", "Delay[1] ; ASSERT[s, 1]") == {"runs"}


def test_wait_asks_for_the_ends_of_bodies_too() -> None:
    reactor = "SIT[s]<k> :; (SUCCEED[s, k] ; NIL)"
    assert run(reactor, "ASSERT[s]", "Delay[1] ; WAIT[s]") == {"runs"}
    assert run(reactor, "WAIT[s]") == STOPS


def test_waitinhibit_inhibits_inside_the_last_release() -> None:
    """A root that asserts again at the same instant does not slip in between."""
    reactor = "(SIT[s]<k> :; (Delay[1] ; SUCCEED[s, k])) | (STOP :; ASSERT[s])"
    w = world("", reactor)
    config = started(parse_process("WAITINHIBIT[s] ; OUT[p, 1]"), w, config=started(parse_process(reactor), w))
    found = explore(config, w)
    reached = [s for s in found.states if "OUT" in {getattr(spot.leaf, "name", "") for spot in s.spots()}]
    assert reached
    assert all(not s.store.run for s in reached)


def test_drain_withdraws_what_is_on_and_queues_what_comes() -> None:
    reactor = "SIT[s]<k> :; (Delay[5] ; SUCCEED[s, k])"
    assert run(reactor, "ASSERT[s]", "Delay[1] ; DRAIN[s] ; UNINHIBIT[s]") == STOPS
    assert run(reactor, "Delay[1] ; DRAIN[s] ; Delay[9] ; UNINHIBIT[s]", "ASSERT[s]") == ABORTS  # withdrawn
    assert run(reactor, "DRAIN[s] ; Delay[9] ; UNINHIBIT[s]", "Delay[1] ; ASSERT[s]") == STOPS  # queued


def test_a_success_while_being_withdrawn_counts_as_a_failure() -> None:
    reactor = "SIT[s]<k> :; (Delay[5] : SUCCEED[s, k])"
    assert run(reactor, "Delay[1] ; DRAIN[s]", "ASSERT[s]") == ABORTS


def test_reassert_repeats_until_it_succeeds() -> None:
    reactor = "SIT[s]<k> :; ((IN[p]<x> : GTR[x, 0] : SUCCEED[s, k]) ; FAIL[s, k])"
    assert run(reactor, "OUT[p, 0] ; OUT[p, 0] ; OUT[p, 1]", "REASSERT[s]") == STOPS


def test_reassert_as_printed_can_never_succeed() -> None:
    """`(~ASSERT) :; STOP` (R §5.5) aborts at the first success: a loop ends only by its condition aborting."""
    reactor = "SIT[s]<k> :; SUCCEED[s, k]"
    assert run(reactor, "(~ASSERT[s]) :; STOP") == ABORTS
    assert run(reactor, "~((~ASSERT[s]) :; STOP)") == STOPS


def test_reassert_gives_up_when_its_owner_is_drained() -> None:
    reactor = "(SIT[s]<k> :; (REASSERT[t] ; OUT[p, 1] ; FAIL[s, k])) | (SIT[t]<j> :; (Delay[1] ; FAIL[t, j]))"
    assert run(reactor, "ASSERT[s]", "DRAIN[s]", "IN[p]<x>") <= {(True, (("x", 1),)), "runs"}
    assert run(reactor, "Delay[3] ; DRAIN[s]", "ASSERT[s] | IN[p]<x>") == {(True, (("x", 1),))}


def test_a_failed_assumption_disables_what_is_not_in_service_and_queues_what_comes() -> None:
    serving = "SIT[s]<k> :; (Delay[5] ; SUCCEED[s, k])"
    assert run(serving, "Delay[1] ; DISABLE[s, A]", "ASSERT[s]") == STOPS  # in service: it finishes
    assert run("STOP", "DISABLE[s, A] ; ASSERT[s]") == {"runs"}  # queued
    assert run("ASSERT[s]", "Delay[1] ; DISABLE[s, A]", "Delay[2] ; WAIT[s]") == STOPS  # unserved: ended
    assert run(SERVE, "DISABLE[s, A] ; Delay[2] ; ENABLE[s, A]", "Delay[1] ; ASSERT[s, 1]<y>") == {
        (True, (("y", 2),))
    }


def test_kill_meets_its_guard_and_waits_while_a_body_is_in_service() -> None:
    reactor = "(E[1] # (SIT[s]<k> :; (IN[p]<x> ; SUCCEED[s, k]))) | ASSERT[s]"
    assert run(reactor, "Delay[1] ; KILL[1]") == {"runs"}
    assert run(reactor, "Delay[2] ; OUT[p, 1]", "Delay[1] ; KILL[1]") == STOPS


def test_kill_of_an_absent_guard_aborts() -> None:
    assert run("STOP", "KILL[9]") == ABORTS


def test_kill_takes_a_root_at_its_queued_assert_only() -> None:
    root = "(E[0] # (STOP :; ASSERT[s])) | (SIT[s]<k> :; (Delay[1] ; SUCCEED[s, k]))"
    assert run(root, "Delay[0.5] ; DRAIN[s] ; KILL[0] ; UNINHIBIT[s]") == STOPS
    assert run("E[0] # (STOP :; ASSERT[s])", "Delay[1] ; KILL[0]") == {"runs"}


def test_kill_waits_for_a_loop_that_senses_inside_a_round() -> None:
    rounds = "(E[1] # (Delay[1] :; (IN[q]<x> :; STOP)))"
    assert run(rounds, "Delay[2] ; KILL[1]") == {"runs"}
    assert run(rounds, "KILL[1]") == STOPS  # in the outermost condition: it only senses


ADDING = "ADD<m> :: (E[m] # P[m])"
TWO_VERSIONS = """
P[1] = SIT[s]<k> :; (Delay[2] ; UPDATE[s, k, 1] ; SUCCEED[s, k])
P[2] = SIT[s]<k> :; (Delay[2] ; UPDATE[s, k, 2] ; SUCCEED[s, k])
"""
CHANGE = "POST[1] : Delay[1] : RETIRE[1] : RENEW[s] : POST[2]"


def test_an_instance_keeps_the_version_with_which_it_was_asserted() -> None:
    def seen(asserting: str) -> set[object]:
        return run(ADDING, CHANGE, asserting, program=TWO_VERSIONS)

    assert seen("Delay[0.5] ; ASSERT[s]<x>") == {(True, (("x", 1),))}
    assert seen("Delay[1.5] ; ASSERT[s]<x>") == {(True, (("x", 2),))}
    waiting = "(Delay[0.2] ; ASSERT[s]<y>) | (Delay[0.5] ; ASSERT[s]<x>)"  # unserved when the new version comes
    assert seen(waiting) == {(True, (("x", 1), ("y", 1)))}


def test_a_reaction_serves_from_its_version_on_unless_it_is_retired() -> None:
    late = "Delay[1.5] ; ASSERT[s]<x>"
    assert run(ADDING, "POST[1] : RENEW[s]", late, program=TWO_VERSIONS) == {(True, (("x", 1),))}
    assert run(ADDING, "POST[1] : RETIRE[1] : RENEW[s]", late, program=TWO_VERSIONS) == {"runs"}
    assert run(ADDING, "POST[1] : RETIRE[1]", late, program=TWO_VERSIONS) == {(True, (("x", 1),))}
    early = "ASSERT[s]<x>"
    assert run(ADDING, "Delay[1] : RENEW[s] : POST[2]", early, program=TWO_VERSIONS) == {"runs"}


def test_retire_of_an_absent_guard_aborts() -> None:
    assert run("STOP", "RETIRE[9]") == ABORTS


def test_a_label_that_is_posted_again_is_not_retired_any_more() -> None:
    again = "POST[1] : RETIRE[1] : RENEW[s] : KILL[1] : POST[1]"
    assert run(ADDING, again, "Delay[1] ; ASSERT[s]<x>", program=TWO_VERSIONS) == {(True, (("x", 1),))}


def test_waitold_waits_for_older_versions_alone() -> None:
    serving = "SIT[s]<k> :: (Delay[5] ; SUCCEED[s, k])"
    asserting = "ASSERT[s] | (Delay[2] ; ASSERT[s])"
    timed = "Delay[1] ; RENEW[s] ; Delay[2] ; ((WAITOLD[s] ; OUT[p, old]) | (WAIT[s] ; OUT[p, all]))"
    first = "IN[p]<x> ; Delay[3] ; STOP"
    assert run(serving, asserting, timed, first) == {(True, (("x", "old"),))}
    assert run("STOP", "RENEW[s] ; WAITOLD[s]") == STOPS


def test_waitold_waits_for_the_versions_before_the_one_it_began_with() -> None:
    serving = "SIT[s]<k> :: (Delay[5] ; SUCCEED[s, k])"
    later = "(WAITOLD[s] ; OUT[p, first]) | (Delay[3] ; RENEW[s])"
    assert run(serving, "ASSERT[s] | (Delay[2] ; ASSERT[s])", f"Delay[1] ; RENEW[s] ; ({later})",
               "(IN[p]<x> # (Delay[6] ; OUT[p, late])) | Delay[9]") == {(True, (("x", "first"),))}  # fmt: skip


def test_renew_gives_up_what_is_on_of_a_disabled_situation() -> None:
    serving = "SIT[s]<k> :; (Delay[5] : SUCCEED[s, k])"
    assert run(serving, "Delay[1] ; DISABLE[s, A] ; ENABLE[s, A]", "ASSERT[s]") == STOPS
    assert run(serving, "Delay[1] ; DISABLE[s, A] ; RENEW[s] ; ENABLE[s, A]", "ASSERT[s]") == ABORTS
    assert run(serving, "Delay[1] ; RENEW[s]", "ASSERT[s]") == STOPS


def test_add_takes_a_posted_label_and_a_label_in_use_is_refused() -> None:
    program = "P[4] = OUT[p, 4]"
    reactor = "ADD<m> :: (E[m] # P[m])"
    assert run(reactor, "POST[4]", "IN[p]<x>", program=program) == {(True, (("x", 4),))}
    assert run(reactor, "Delay[1] ; POST[4]", program="P[4] = NIL") == STOPS
    assert run(reactor, "POST[4] : POST[4]", program="P[4] = NIL") == ABORTS


def test_a_guard_that_guards_nothing_is_no_guard() -> None:
    assert run("STOP | E[3]", "KILL[3]") == ABORTS
    assert run("STOP | E[3]", "RETIRE[3]") == ABORTS
    assert run("STOP | E[3]", "POST[3]", "ADD<m>") == {(True, (("m", 3),))}
