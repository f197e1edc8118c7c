"""The fine print of the rules, by their ids: causes, orders, what the store holds and how terms stay small.

`test_evolves` asks what each rule says; here is what a rule with a small mistake would still get right there. Most
of these tests were written for a mutant that survived the others (docs/analysis.md, Mutants).
"""

from __future__ import annotations

import pytest

from planner_reactor.analysis.explore import Exploration, explore
from planner_reactor.errors import BudgetError
from planner_reactor.rs.configurations import Config, World
from planner_reactor.rs.evolves import killed, started
from planner_reactor.rs.leaves import elapsed, offers, slack, steps, urgent, window
from planner_reactor.rs.parser import parse_process
from planner_reactor.rs.states import (
    Await,
    Chain,
    Ended,
    Export,
    InstanceNumber,
    Keep,
    Leaf,
    Reaction,
    Run,
    Spawning,
    parts_of,
)
from planner_reactor.rs.store import Instance, Store
from planner_reactor.rs.vocabulary import BUILT_IN, Signature
from tests.rs.test_evolves import ABORTS, STOPS, run, world

SERVED = "SIT[s]<k> :; (Delay[5] ; SUCCEED[s, k])"


def explored(*texts: str, program: str = "") -> Exploration:
    w = world(program, *texts)
    found = explore(begun(*texts, w=w), w)
    assert found.complete
    return found


def begun(*texts: str, w: World) -> Config:
    config = Config()
    for n, text in enumerate(texts):
        config = started(parse_process(text, file=f"root{n}"), w, config=config)
    return config


def finals(*texts: str, program: str = "") -> list[Config]:
    """The configurations in which nothing can happen any more."""
    found = explored(*texts, program=program)
    return [found.states[n] for n in found.ends]


def causes(*texts: str, program: str = "") -> set[str]:
    """Why the last root aborts, in every way that it may end."""
    ends = [config.roots[-1][1] for config in finals(*texts, program=program)]
    return {e.cause if isinstance(e, Ended) else "runs" for e in ends}


def following(*texts: str, until: float, program: str = "") -> Config:
    """The configuration after so many seconds, if at each moment the first step that is offered is taken."""
    w = world(program, *texts)
    config, now = begun(*texts, w=w), 0.0
    while True:
        if (step := next(steps(config, w), None)) is not None:
            config = step.after
            continue
        pause = min(slack(config, w), until - now)
        if pause <= 0:
            return config
        config, now = elapsed(config, pause, w), now + pause


def inside(term: Run) -> list[Run]:
    """A term and all its parts."""
    return [term, *(t for part in parts_of(term) for t in inside(part))]


# ------------------------------------------------------------------------------------------------------ causes


@pytest.mark.parametrize(
    ("text", "cause"),
    [
        ("ABORT", "failed"),
        ("no", "failed"),
        ("Delay[port]", "failed"),
        ("Delay[x]", "failed"),
        ("GTR[1, 2]", "failed"),
        ("Delay[1/0]", "error"),
        ("((yes<x>;NIL)#STOP) : Delay[x]", "error"),
        ("KILL[9]", "error"),
        ("no | Delay[1/0]", "failed"),
        ("Delay[1/0] | no", "error"),
        ("STOP & no", "failed"),
        ("~yes & (Delay[1] : Delay[1/0])", "error"),
        ("no ; STOP", ""),
        ("no | yes", ""),
        ("no : yes", "failed"),
        ("no :; yes", "failed"),
        ("Delay[1/0] :: yes", "error"),
        ("(no # NIL) : yes", "failed"),
        ("POST[4] # Delay[1] : ABORT", "failed"),
        ("ASSUMONITOR[a, 0]", "error"),
        ("HOLDMONITOR[a, port]", "error"),
    ],
)
def test_the_cause_of_an_abort(text: str, cause: str) -> None:
    assert causes(text) == {cause}


def test_the_cause_of_a_call_that_no_clause_fits() -> None:
    assert causes("T[3]", program="T[1] = STOP") == {"error"}
    assert causes("T", program="T = Delay[1/0]") == {"error"}


def test_n8_spawning_keeps_the_cause_of_its_condition_unless_a_body_stopped() -> None:
    for body, cause in (("no", "failed"), ("yes", "")):
        assert causes("OUT[p, 1] ; OUT[p, 0]", f"(IN[p]<x> : GTR[x, 0]) :: {body}") == {cause}
        assert causes("OUT[p, 1]", f"(IN[p]<x> : Delay[1/0]) :: {body}") == {"error"}


def test_assert_tells_why_its_instance_failed() -> None:
    assert causes("SIT[s]<k> :; FAIL[s, k]", "ASSERT[s]") == {"failed"}
    assert causes("SIT[s]<k> :; (STUB[s] ; FAIL[s, k])", "ASSERT[s]") == {"stub"}
    assert causes("SIT[s]<k> :; (STUB[s] ; SUCCEED[s, k])", "ASSERT[s]") == {""}
    assert causes(SERVED, "Delay[1] ; DRAIN[s]", "ASSERT[s]") == {"withdrawn"}
    assert causes("STOP", "Delay[1] ; DRAIN[s]", "ASSERT[s]") == {"withdrawn"}
    assert causes("STOP", "Delay[1] ; DISABLE[s, A]", "ASSERT[s]") == {"assumption"}
    assert causes("SIT[s]<k> :; (STUB[s] ; Delay[3])", "Delay[1] ; DISABLE[s, A]", "ASSERT[s]") == {"assumption"}
    assert causes("ASSERT[7]") == {"error"}


def test_assert_below_what_has_ended_is_withdrawn_and_below_itself_an_error() -> None:
    assert causes("SIT[s]<k> :; (SUCCEED[s, k] ; NIL)", "(SIT[t]<j> :; (FAIL[t, j] ; ASSERT[s])) | ASSERT[t]") == {
        "runs"
    }
    gone = following("SIT[s]<k> :; ((SUCCEED[s, k] ; ASSERT[t]) & NIL)", "ASSERT[s]", until=1)
    assert [e.cause for e in inside(gone.root(1)) if isinstance(e, Ended)] == ["withdrawn"]
    below = following("SIT[s]<k> :; (ASSERT[s] & NIL)", "ASSERT[s]", until=1)
    assert [e.cause for e in inside(below.root(1)) if isinstance(e, Ended)] == ["error"]


def test_assert_below_itself_is_found_through_what_lies_between() -> None:
    reactor = "(SIT[s]<k> :; ASSERT[t]) | (SIT[t]<j> :; (ASSERT[s] & NIL))"
    below = following(reactor, "ASSERT[s]", until=1)
    assert [e.cause for e in inside(below.root(1)) if isinstance(e, Ended)] == ["error"]


def test_reassert_that_gives_up_says_withdrawn() -> None:
    reactor = "(SIT[s]<k> :; (REASSERT[t] & NIL)) | (SIT[t]<j> :; (Delay[2] ; FAIL[t, j]))"
    config = following(reactor, "ASSERT[s]", "Delay[1] ; DRAIN[s]", until=9)
    assert [e for e in inside(config.root(1)) if isinstance(e, Ended)] == [Ended(False)]
    assert [e.cause for e in inside(config.root(1)) if isinstance(e, Ended)] == ["withdrawn"]


# ---------------------------------------------------------------------------------- terms that stay small and equal


def chain_of(calls: int) -> str:
    """D0 calls D1, … up to the last, which waits for a reader."""
    return "\n".join([*(f"D{n} = D{n + 1}" for n in range(calls)), f"D{calls} = IN[p]<x>"])


def test_n7_a_hundred_calls_may_unfold_without_a_process_between_and_no_more() -> None:
    assert run("D0", "OUT[p, 1]", program=chain_of(100)) == STOPS
    for text in ("D0", "D0 ; STOP", "D0 : STOP", "~D0", "D0 | NIL", "D0 # NIL", "D0 & NIL", "D0 :; STOP", "D0 :: STOP",
                 "if D0 then STOP else STOP"):  # fmt: skip
        with pytest.raises(BudgetError):
            run(text, program=chain_of(101))


def test_n7_each_round_of_a_loop_may_unfold_as_many_calls() -> None:
    for loop in (":;", "::"):
        config = following(f"D0 {loop} STOP", "OUT[p, 1] ; OUT[p, 2]", program=chain_of(100), until=1)
        assert config.root(2) == Ended(True)


def test_n7_parameters_have_the_values_of_the_arguments() -> None:
    program = "T[b, a] = OUT[p, b - a] ; OUT[p, a]"
    assert run("T[5, 2]", "IN[p]<x> ; IN[p]<y>", program=program) == {(True, (("x", 3), ("y", 2)))}


def test_n7_constants_of_a_head_bind_nothing() -> None:
    assert run("T[1, 5]", "IN[p]<x>", program="T[1, n] = OUT[p, n]") == {(True, (("x", 5),))}


def test_bindings_are_sorted_so_that_equal_states_are_equal() -> None:
    config = following("T[1, 2] & NIL", until=0, program="T[z, y] = IN[w]<v> ; OUT[y, z]")
    (chain,) = [t for t in inside(config.root(1)) if isinstance(t, Chain)]
    assert chain.scope == (("y", 2), ("z", 1))
    assert run("T<z, y>", program="T<v, u> = yes<v> ; no<u>") == {(False, (("y", 0), ("z", 1)))}
    served = "SIT[s]<k, x> :; (UPDATE[s, k, 8, 9] ; SUCCEED[s, k])"
    assert run(served, "ASSERT[s, 1]<z, y>") == {(True, (("y", 9), ("z", 8)))}


def test_what_waits_keeps_only_the_bindings_that_it_uses() -> None:
    config = following("yes<x> ; (yes<y> ; (IN[w]<v> ; OUT[q, x]))", until=0)
    (chain,) = [t for t in inside(config.root(1)) if isinstance(t, Chain)]
    assert isinstance(chain, Chain)
    assert chain.scope == (("x", 1),)
    for body in ("{} :; OUT[q, x]", "{} :: OUT[q, x]", "if {} then OUT[q, x] else STOP", "{} : OUT[q, x]"):
        config = following("T[1, 2] # NIL", until=0, program=f"T[x, y] = {body.format('IN[w]<v>')}")
        (scope,) = [t.scope for t in inside(config.root(1)) if hasattr(t, "scope")]
        assert scope == (("x", 1),)


def test_n6_nested_results_are_merged() -> None:
    config = following("yes<x> ; (yes<y> ; (no<z> ; NIL))", until=0)
    kept = [t for t in inside(config.root(1)) if isinstance(t, Keep)]
    assert [t.bindings for t in kept] == [(("x", 1), ("y", 1), ("z", 0))]
    assert not any(
        isinstance(t, Keep) and not t.bindings for t in inside(following("STOP ; IN[w]<v>", until=0).root(1))
    )


@pytest.mark.parametrize(
    "body", ["Delay[1] ; T", "Delay[1] : T", "(yes<x> ; Delay[1]) ; T", "if Delay[1] then T else T"]
)
def test_n6_tail_calls_take_no_space(body: str) -> None:
    assert len(explored("T", program=f"T = {body}").states) < 8


def test_n6_an_export_of_nothing_hides_what_is_kept_and_what_is_exported_below() -> None:
    config = following("T", until=3.5, program="T = yes<x> ; Delay[1] ; T")
    assert sum(isinstance(t, Export) for t in inside(config.root(1))) == 1
    assert not any(isinstance(t, Export) and isinstance(t.body, Export | Keep) for t in inside(config.root(1)))


def test_n6_a_result_that_was_never_bound_is_not_exported() -> None:
    assert run("T<y>", program="T<r> = (yes<r> ; NIL) # STOP") == STOPS


def test_n8_ended_bodies_are_merged_away_and_the_newest_stands_last() -> None:
    text = "(IN[p]<x> :: Delay[x]) | (OUT[p, 1] ; OUT[p, 5] ; OUT[p, 3])"
    for until, delays in ((0.5, [1, 5, 3]), (2, [5, 3]), (4, [5]), (6, [])):
        (spawning,) = [t for t in inside(following(text, until=until).root(1)) if isinstance(t, Spawning)]
        found = [t.arguments[0] for b in spawning.bodies for t in inside(b) if isinstance(t, Leaf)]
        assert found == delays
        assert len(spawning.bodies) == len(delays)
        assert spawning.stopped == (len(delays) < 3)


@pytest.mark.parametrize(("first", "second"), [("yes", "no"), ("no", "yes"), ("no", "no"), ("yes", "yes")])
def test_n8_spawning_remembers_that_a_body_stopped(first: str, second: str) -> None:
    body = f"if Equal[x, 1] then {first} else (Delay[3] ; {second})"
    text = f"(((IN[p]<x> : GTR[x, 0]) :: ({body})) | ((OUT[p, 1] ; OUT[p, 2] ; OUT[p, 0]) : ABORT))"
    assert {end for end, _ in run(text)} == {"yes" in (first, second)}


# ----------------------------------------------------------------------------------------------------- bodies of SIT


@pytest.mark.parametrize("operator", [";", ":", ":;", "::"])
def test_sit_what_follows_it_is_the_body_and_sees_what_is_in_scope(operator: str) -> None:
    reactor = f"yes<x> ; (SIT[s]<k, y> {operator} (OUT[p, x + y] ; (SUCCEED[s, k] ; NIL)))"
    assert run(reactor, "ASSERT[s, 4] | (IN[p]<z> ; NIL)") == {"runs"}
    config = following(reactor, "ASSERT[s, 4]", "IN[p]<z>", until=1)
    assert config.root(3) == Ended(True, (("z", 5),))
    assert [number for number, _ in config.store.run] == [1]
    assert isinstance(config.root(2), Await)  # it does not return while the body is in service


def test_sit_a_body_leaves_the_store_when_it_ends() -> None:
    for operator in (";", ":"):
        config = following(f"SIT[s]<k> {operator} Delay[1]", "ASSERT[s]", until=2)
        assert not config.store.run
        assert isinstance(config.root(1), Ended)


def test_n10_both_branches_see_the_results_of_the_test() -> None:
    for test, value in (("yes", 1), ("no", 0)):
        text = f"if {test}<x> then OUT[p, x] else OUT[p, x]"
        assert run(text, "IN[p]<y>") == {(True, (("y", value),))}
        assert run(f"if {test}<x> then STOP else STOP") == {(True, (("x", value),))}


def test_n10_the_branches_see_what_is_in_scope() -> None:
    assert run("yes<z> ; (if yes<x> then OUT[p, z] else STOP)", "IN[p]<y>") == {(True, (("y", 1),))}


# ----------------------------------------------------------------------------------------------- forced abort, orders


def test_n5_disablings_of_one_depth_are_decided_from_the_left_and_from_the_first_root() -> None:
    """Seen in the order in which two drains let their queues go."""
    for reactor in (
        ("(IN[p]<x> # DRAIN[s])", "(OUT[p, 1] # DRAIN[t])"),
        ("(IN[p]<x> # DRAIN[s]) | (OUT[p, 1] # DRAIN[t])",),
    ):
        assert released(*reactor) == ["s", "t"]
    for reactor in (
        ("(OUT[p, 1] # DRAIN[t])", "(IN[p]<x> # DRAIN[s])"),
        ("(OUT[p, 1] # DRAIN[t]) | (IN[p]<x> # DRAIN[s])",),
    ):
        assert released(*reactor) == ["t", "s"]


def test_n5_deeper_disablings_are_decided_first_wherever_they_stand() -> None:
    deep = "((((OUT[p, 1] # DRAIN[t]) ; NIL) # NIL) | NIL)"
    assert released(f"(IN[p]<x> # DRAIN[s]) | {deep}") == ["t", "s"]
    assert released(f"{deep} | (IN[p]<x> # DRAIN[s])") == ["t", "s"]
    assert released("(IN[p]<x> # DRAIN[s])", deep) == ["t", "s"]


def released(*roots: str) -> list[str]:
    """In which order two held situations s and t become instances, when these roots let them go."""
    holding = "(SIT[s]<k> :; NIL) | (SIT[t]<j> :; NIL) | ASSERT[s, 1] | ASSERT[t, 1]"
    late = [f"({root})" for root in roots]
    delayed = [root.replace("IN[p]", "Delay[3] ; IN[p]").replace("OUT[p, 1]", "Delay[3] ; OUT[p, 1]") for root in late]
    spaced = [root.replace("DRAIN", "Delay[1] ; DRAIN") for root in delayed]
    grouped = [regrouped(root) for root in spaced]
    config = following(holding, *grouped, "Delay[2] ; (ASSERT[s, 2] | ASSERT[t, 2])", until=4)
    return [i.situation for i in config.store.instances if i.arguments == (2,)]


def regrouped(text: str) -> str:
    """Sequences inside a `#` stand in parentheses."""
    for situation in "st":
        text = text.replace(f"Delay[1] ; DRAIN[{situation}]", f"(Delay[1] ; DRAIN[{situation}])")
    return text.replace("Delay[3] ; IN[p]<x>", "(Delay[3] ; IN[p]<x>)").replace(
        "Delay[3] ; OUT[p, 1]", "(Delay[3] ; OUT[p, 1])"
    )


def test_n9_an_aborted_assert_leaves_the_queue() -> None:
    config = following("DRAIN[s] ; NIL", "Delay[1] ; (ASSERT[s] # Delay[1])", until=3)
    assert config.store.queue == ()
    assert config.root(2) == Ended(True)


def test_n9_an_aborted_drain_lets_its_queue_go_at_once() -> None:
    config = following(
        "(SIT[s]<k> :; NIL) | ASSERT[s, 1]", "(Delay[1] ; DRAIN[s]) # Delay[3]", "Delay[2] ; ASSERT[s, 2]", until=4
    )
    assert config.store.drains == ()
    assert config.store.queue == ()
    assert [i.arguments for i in config.store.instances] == [(1,), (2,)]


def test_n9_an_aborted_body_is_counted_and_leaves_the_store() -> None:
    config = following("(SIT[s]<k> :; NIL) # Delay[2]", "ASSERT[s]", until=3)
    assert config.store.cut == 1
    assert config.store.run == ()
    twice = following("((SIT[s]<k> :; NIL) | (SIT[s]<j> :; NIL)) # Delay[2]", "ASSERT[s]", until=3)
    assert twice.store.cut == 2
    assert following(SERVED, "ASSERT[s]", until=9).store.cut == 0


def test_n9_an_aborted_await_fails_its_instance_with_a_cause_and_nobody_collects_it() -> None:
    config = following(SERVED, "ASSERT[s] # Delay[1]", until=2)
    (instance,) = config.store.instances
    assert (instance.status, instance.cause, instance.awaited) == ("ab", "cancelled", False)
    assert following(SERVED, "ASSERT[s] # Delay[1]", until=9).store.instances == ()


# -------------------------------------------------------------------------------------------------- the store's rules


def test_a_new_store_is_empty_and_numbers_begin_with_one() -> None:
    store, number = Store().asserted("s", (1,), None)
    assert number == 1
    assert store.asserted("s", (2,), None)[1] == 2
    (instance,) = store.instances
    assert (instance.situation, instance.arguments, instance.owner, instance.status) == ("s", (1,), None, "on")
    assert (instance.values, instance.withdrawn, instance.stub, instance.awaited, instance.cause) == (
        (),
        False,
        False,
        True,
        "",
    )
    assert instance.version == 0
    assert Store().cut == 0


def test_queued_asserts_have_tickets_of_their_own_and_keep_their_order() -> None:
    texts = (
        "(SIT[h]<k> :; NIL) | ASSERT[h, 0]",
        "Delay[1] ; DRAIN[h]",
        "Delay[2] ; (ASSERT[h, 1] | ASSERT[h, 2] | ASSERT[g, 3])",
    )
    config = following(*texts, until=3)
    assert [(q.situation, q.arguments, q.fate) for q in config.store.queue] == [("h", (1,), None), ("h", (2,), None)]
    assert len({q.ticket for q in config.store.queue}) == 2
    assert [i.situation for i in config.store.instances] == ["h", "g"]


def test_drain_holds_back_its_own_situation_only_and_until_it_is_uninhibited() -> None:
    busy = "(SIT[s]<k> :; (Delay[5] ; SUCCEED[s, k])) | (SIT[t]<j> :; SUCCEED[t, j]) | ASSERT[s]"
    script = "Delay[1] ; DRAIN[s] ; Delay[5] ; UNINHIBIT[s] ; NIL"
    for until, held in ((3, 1), (7, 1), (11, 0)):
        config = following(busy, script, "Delay[2] ; ASSERT[s]", "Delay[2] ; ASSERT[t]", until=until)
        assert len(config.store.queue) == held
        assert config.root(4) == Ended(True)


def test_inhibit_alone_holds_nothing_back_and_an_assumption_does() -> None:
    config = following("INHIBIT[s] ; NIL", "Delay[1] ; ASSERT[s]", until=2)
    assert config.store.queue == ()
    assert len(config.store.instances) == 1
    config = following("DISABLE[s, A]", "Delay[1] ; (ASSERT[s] | ASSERT[t])", until=2)
    assert [q.situation for q in config.store.queue] == ["s"]
    assert [i.situation for i in config.store.instances] == ["t"]


def test_disable_counts_once_for_each_assumption_and_situation() -> None:
    config = following("DISABLE[s, A] ; DISABLE[s, A] ; DISABLE[t, A] ; DISABLE[s, B]", until=1)
    found = [(h.situation, h.owner, h.kind) for h in config.store.inhibitions]
    assert found == [("s", ("assumption", "A"), "assumption"), ("t", ("assumption", "A"), "assumption"),
                     ("s", ("assumption", "B"), "assumption")]  # fmt: skip
    config = following("DISABLE[s, A] ; DISABLE[s, B] ; ENABLE[s, A]", "Delay[1] ; ASSERT[s]", until=2)
    assert [h.owner for h in config.store.inhibitions] == [("assumption", "B")]
    assert len(config.store.queue) == 1


def test_disable_ends_only_its_own_situation_and_only_what_is_not_in_service() -> None:
    config = following("ASSERT[s] | ASSERT[t]", SERVED.replace("s", "t"), "Delay[1] ; DISABLE[s, A]", until=2)
    assert [i.situation for i in config.store.instances] == ["t"]
    config = following(SERVED, "ASSERT[s]", "Delay[1] ; DISABLE[s, A]", until=2)
    assert [i.status for i in config.store.instances] == ["on"]


def test_an_inhibited_situation_is_not_delivered_and_others_are() -> None:
    reactor = "(SIT[s]<k> :; NIL) | (SIT[t]<j> :; NIL) | ASSERT[s] | ASSERT[t]"
    config = following("INHIBIT[s] ; NIL", reactor, until=1)
    assert [n for n, _ in config.store.run] == [2]
    config = following("DISABLE[h, A]", reactor, until=1)
    assert [n for n, _ in config.store.run] == [1, 2]


def test_uninhibit_takes_its_owners_latest_and_one_at_a_time() -> None:
    config = following("INHIBIT[s] ; INHIBIT[s] ; UNINHIBIT[s] ; NIL", "INHIBIT[s] ; NIL", until=1)
    assert [(h.situation, h.owner) for h in config.store.inhibitions] == [("s", 1), ("s", 2)]
    config = following("INHIBIT[s] ; DRAIN[s] ; UNINHIBIT[s] ; NIL", until=1)
    assert [h.kind for h in config.store.inhibitions] == ["inhibit"]
    config = following("INHIBIT[s] ; INHIBIT[t] ; UNINHIBIT[s] ; NIL", until=1)
    assert [h.situation for h in config.store.inhibitions] == ["t"]


def test_an_owner_that_ends_lets_all_go_and_nothing_of_others() -> None:
    config = following("INHIBIT[s] ; INHIBIT[t] ; INHIBIT[s] ; Delay[1]", "INHIBIT[s] ; NIL", until=2)
    assert [(h.situation, h.owner) for h in config.store.inhibitions] == [("s", 2)]


def test_waitinhibit_and_drain_leave_an_inhibition_of_their_kind() -> None:
    assert [(h.owner, h.kind) for h in following("WAITINHIBIT[s] ; NIL", until=1).store.inhibitions] == [(1, "inhibit")]
    config = following("STOP", "DRAIN[s] ; NIL", until=1)
    assert [(h.situation, h.owner, h.kind) for h in config.store.inhibitions] == [("s", 2, "drain")]
    assert config.store.drains == ()


def test_wait_waits_for_its_own_situation_only() -> None:
    assert run("ASSERT[t]", "WAIT[s]") == STOPS
    assert run("ASSERT[t] | ASSERT[s]", "WAIT[s]") <= {(True, ()), "runs"}
    assert run("ASSERT[s]", "Delay[1] ; WAIT[s]") == {"runs"}


def test_drain_withdraws_descendants_and_nothing_else() -> None:
    parent, child = "(SIT[s]<k> :; ((ASSERT[t] | ASSERT[t]) ; NIL))", "(SIT[t]<j> :; (ASSERT[u] ; NIL))"
    reactor = f"{parent} | {child} | (SIT[u]<i> :; NIL) | (SIT[v]<l> :; NIL)"
    config = following(reactor, "ASSERT[s] | ASSERT[v]", "Delay[1] ; DRAIN[s]", until=2)
    assert {i.situation: i.withdrawn for i in config.store.instances} == {"s": True, "t": True, "u": True, "v": False}
    config = following(reactor, "ASSERT[s] | ASSERT[v]", "Delay[1] ; DRAIN[t]", until=2)
    assert {i.situation: i.withdrawn for i in config.store.instances} == {"s": False, "t": True, "u": True, "v": False}


def test_an_instance_that_ends_cancels_its_descendants_and_only_them() -> None:
    reactor = "(SIT[s]<k> :; ((ASSERT[t] | (Delay[1] ; FAIL[s, k])) ; NIL)) | (SIT[t]<j> :; NIL)"
    config = following(reactor, "ASSERT[s]", "ASSERT[t]", until=2)
    assert sorted((i.situation, i.status, i.cause) for i in config.store.instances) == [
        ("s", "ab", "failed"), ("t", "ab", "cancelled"), ("t", "on", "")]  # fmt: skip


def test_a_queued_assert_fails_when_its_owner_is_withdrawn_or_has_ended() -> None:
    reactor = "(SIT[s]<k> :; ((Delay[3] ; ASSERT[t]) & NIL)) | (SIT[t]<i> :; NIL) | ASSERT[t]"
    config = following(reactor, "ASSERT[s]", "Delay[1] ; DRAIN[t]", "Delay[4] ; DRAIN[s]", until=5)
    assert config.store.queue == ()
    assert [(e.ok, e.cause) for e in inside(config.root(1)) if isinstance(e, Ended)] == [(False, "withdrawn")]


def test_update_changes_an_instance_that_is_on_and_of_its_situation() -> None:
    assert run("SIT[s]<k> :; (UPDATE[t, k, 7] ; SUCCEED[s, k])", "ASSERT[s]<x>") == {(True, ())}
    assert run("SIT[s]<k> :; (SUCCEED[s, k] ; UPDATE[s, k, 7])", "ASSERT[s]<x>") == {(True, ())}
    assert run("SIT[s]<k> :; (UPDATE[s, 7, 7] ; UPDATE[s, k, 8] ; SUCCEED[s, k])", "ASSERT[s]<x>") == {
        (True, (("x", 8),))
    }
    assert run("SIT[s]<k> :; (UPDATE[s, k, 8] ; FAIL[s, k])", "ASSERT[s]<x>") == {(False, (("x", 8),))}


def test_a_verdict_on_another_situation_or_on_nothing_has_no_effect() -> None:
    for verdict in ("SUCCEED[t, k]", "FAIL[t, k]", "SUCCEED[s, 99]", "FAIL[s, port]"):
        assert run(f"SIT[s]<k> :; ({verdict} ; NIL)", "ASSERT[s]") == {"runs"}


def test_stub_marks_the_instance_that_it_stands_in() -> None:
    config = following("SIT[s]<k> :; (STUB[s] ; NIL)", "ASSERT[s] | ASSERT[s]", until=1)
    assert [i.stub for i in config.store.instances] == [True, False]
    assert run("STUB[s]") == STOPS
    assert causes("SIT[s]<k> :; (STUB[s] ; NIL)", "Delay[1] ; DRAIN[s]", "ASSERT[s] # Delay[2]") == {""}


# ------------------------------------------------------------------------------------------------------- the labels


def test_the_labels_say_what_an_observer_sees() -> None:
    def labels(*texts: str) -> set[tuple[object, ...]]:
        w = world("", *texts)
        return {offer.label for offer in offers(begun(*texts, w=w), w)}

    assert labels("yes") == {("yes", (), "ok", (1,))}
    assert labels("no") == {("no", (), "ab", (0,))}
    assert labels("GTR[1, 2]") == {("GTR", (1, 2), "ab", ())}
    assert labels("OUT[p, 7] | IN[p]<x>") == {("COM", ("p", 7), "ok", ())}
    assert labels("ASSERT[s, 1]") == {("ASSERT", ("s", 1), "wait", ())}
    assert labels("WAIT[s]") == {("WAIT", ("s",), "wait", ())}
    assert labels("DRAIN[s]") == {("DRAIN", ("s",), "wait", ())}
    assert labels("KILL[9]") == {("KILL", (9,), "ab", ())}
    assert labels("POST[9] | ADD<m>") == {("POST", (9,), "ok", ())}
    assert labels("POST[9] | (E[9] # NIL) | ADD<m>") == {("POST", (9,), "ab", ())}
    assert labels("Delay[1/0]") == {("Delay", (), "ab", ())}
    assert labels("NIL | IN[p]<x> | ADD<m> | (E[1] # NIL) | ASSUMONITOR[a, 100]") == set()


def test_offers_that_show_a_label_are_those_of_all_that_show_it() -> None:
    texts = (
        "yes | no | GTR[2, 1] | OUT[p, 7] | OUT[q, 7] | IN[p]<x> | IN[q]<y> | IN[p]<z> | a",
        "ASSERT[s, 1] | KILL[4]",
    )
    w = world("", *texts)
    config = begun(*texts, w=w)
    every = list(offers(config, w))
    assert len(every) == 10
    for offer in every:
        assert list(offers(config, w, seen=offer.label)) == [o for o in every if o.label == offer.label]


def test_an_offer_tells_where_its_leaves_stand_a_writer_before_its_reader() -> None:
    w = world()
    (offer,) = offers(begun("IN[p]<x> | OUT[p, 7]", w=w), w)
    assert [site.column for site in offer.sites if site is not None] == [12, 1]


def test_time_steps_are_urgent_unless_their_window_is_open() -> None:
    w = world()
    assert [o.urgent for o in offers(begun("yes", w=w), w)] == [False]
    for text in ("GTR[1, 2]", "Delay[0]", "Term[0]", "OUT[p, 1] | IN[p]<x>", "KILL[9]", "ASSERT[s]"):
        assert all(step.urgent for step in steps(begun(text, w=w), w)), text
    assert [o.urgent for o in offers(begun("Term[1]", w=w), w)] == [False]


def test_time_ages_all_sides_together() -> None:
    w = world()
    config = elapsed(begun("Delay[3] | (NIL # Delay[5]) | a", w=w), 2.0, w)
    assert [t.age for t in inside(config.root(1)) if isinstance(t, Leaf)] == [2.0, 0.0, 2.0, 0.0]
    assert slack(config, w) == 1


@pytest.mark.parametrize(
    ("text", "seconds"),
    [("SUSPEND[500]", 0.5), ("Delay[2]", 2.0), ("Term[2]", 2.0), ("Delay[0 - 3]", 0.0), ("NIL", float("inf"))],
)
def test_time_how_long_a_leaf_may_last(text: str, seconds: float) -> None:
    w = world()
    assert slack(begun(text, w=w), w) == seconds


def test_testing_and_rounds_are_told_apart_by_kill() -> None:
    """In a round of a loop nothing may be cut, not even where it waits; only a queued ASSERT and a SIT may."""
    for body, ends in (("NIL", True), ("IN[p]<x>", False), ("Delay[9]", False), ("WAIT[s]", False)):
        config = following("ASSERT[s]", f"E[1] # (STOP :; ({body}))", "Delay[1] ; KILL[1]", until=2)
        assert isinstance(config.root(3), Ended) == ends, body
    for condition in ("IN[p]<x>", "NIL", "WAIT[s]", "(Delay[9] ; IN[p]<x>)", "ASSERT[s]"):
        config = following("ASSERT[s]", f"E[1] # ({condition} :; Delay[9])", "Delay[1] ; KILL[1]", until=2)
        assert config.root(3) == Ended(True), condition
        config = following("ASSERT[s]", f"E[1] # ({condition} :: Delay[9])", "Delay[1] ; KILL[1]", until=2)
        assert config.root(3) == Ended(True), condition


def test_kill_of_a_plain_process_waits_until_it_has_ended() -> None:
    for plain in ("Delay[9]", "ASSERT[s]", "IN[p]<x>", "WAIT[s]"):
        config = following("ASSERT[s]", f"E[1] # {plain}", "Delay[1] ; KILL[1]", until=2)
        assert not isinstance(config.root(3), Ended), plain


def test_kill_waits_for_the_bodies_of_a_spawning_reaction_all_of_them() -> None:
    reactor = "E[1] # (SIT[s]<k, x> :: (Delay[x] ; SUCCEED[s, k]))"
    for until, ended in ((3, False), (5, False), (7, True)):
        config = following(reactor, "ASSERT[s, 4] | ASSERT[s, 6]", "Delay[1] ; KILL[1]", until=until)
        assert isinstance(config.root(3), Ended) == ended


def test_an_e_that_guards_nothing_and_one_of_two_with_one_label_are_refused() -> None:
    assert causes("E[1]") == {"error"}
    assert causes("E[1] | NIL") == {"runs"}
    config = following("E[1] | NIL", until=1)
    assert [t.cause for t in inside(config.root(1)) if isinstance(t, Ended)] == ["error"]
    config = following("(E[1] # NIL) | (E[1] # IN[p]<x>)", until=1)
    assert any(isinstance(t, Ended) for t in inside(config.root(1)))
    config = following("(E[1] # NIL) | (E[2] # NIL)", until=1)
    assert not any(isinstance(t, Ended) for t in inside(config.root(1)))


def test_testing_keeps_its_scope_for_every_round() -> None:
    text = "yes<y> ; ((IN[p]<x> : GTR[x, 0]) :; OUT[q, y + x])"
    assert run(f"({text}) | (OUT[p, 1] ; OUT[p, 2] ; OUT[p, 0])", "IN[q]<v> ; IN[q]<w>") == {
        (True, (("v", 2), ("w", 3)))
    }
    spawned = text.replace(":;", "::")
    assert run(f"({spawned}) | (OUT[p, 1] ; Delay[1] ; OUT[p, 2] ; OUT[p, 0])", "IN[q]<v> ; IN[q]<w>") == {
        (True, (("v", 2), ("w", 3)))
    }
    (testing,) = [t for t in inside(following("IN[w]<v> :; b", until=0).root(1)) if hasattr(t, "condition")]
    assert testing.scope == ()


# ------------------------------------------------------------------------------------------ roots, and the store alone


def test_a_root_has_the_number_that_it_is_given_or_the_next() -> None:
    w = world()
    config = started(parse_process("NIL"), w, number=4)
    assert [n for n, _ in config.roots] == [4]
    config = started(parse_process("NIL"), w, config=config, number=2)
    assert [n for n, _ in started(parse_process("NIL"), w, config=config).roots] == [4, 2, 5]


def test_n9_a_root_that_is_aborted_from_outside_ends_alone_and_lets_go_of_what_it_held() -> None:
    w = world()
    config = following("INHIBIT[t] ; ASSERT[s]", "ASSERT[s]", "WAIT[s]", until=1)
    after = killed(config, 1, w)
    assert after.root(1) == Ended(False)
    assert isinstance(after.root(1), Ended)
    assert after.root(1).cause == "cancelled"  # type: ignore[union-attr]
    assert isinstance(after.root(2), Await)
    assert not isinstance(after.root(3), Ended)
    assert after.store.inhibitions == ()
    assert [i.number for i in after.store.instances] == [2]
    assert killed(after, 2, w).root(3) == Ended(True)


def test_assert_does_not_return_before_its_descendants_have_ended() -> None:
    reactor = "(SIT[s]<k> :; ((ASSERT[t] # Delay[1]) ; SUCCEED[s, k])) | (SIT[t]<j> :; Delay[5])"
    for until, returned in ((2, False), (4, False), (6, True)):
        assert isinstance(following(reactor, "ASSERT[s]", until=until).root(2), Ended) == returned


def test_sit_what_another_reaction_has_served_does_not_count() -> None:
    store = Store()
    store, first = store.asserted("s", (), None)
    store, second = store.asserted("s", (), None)
    mine, other = Reaction(1, None), Reaction(2, None)
    store = store.stamped(first, other)
    assert [i.number for i in (store.available("s", mine), store.available("s", other)) if i] == [first, second]
    store = store.stamped(second, other)
    assert [i.number for i in (store.available("s", other),) if i] == [first]
    again = store.stamped(first, other)
    assert again.served == ((other, second), (other, first))
    assert again.without(second).served == ((other, first),)


def test_an_instance_is_new_unless_it_is_said_otherwise() -> None:
    new = Instance(InstanceNumber(3), "s")
    assert (new.arguments, new.owner, new.status, new.values, new.version) == ((), None, "on", (), 0)


def test_sit_does_not_deliver_what_has_ended_or_is_withdrawn_to_a_second_reaction() -> None:
    late = "(Delay[2] ; (SIT[s]<j> :; NIL))"
    assert len(following(f"(SIT[s]<k> :; NIL) | {late}", "ASSERT[s]", until=3).store.run) == 2
    assert len(following(f"(SIT[s]<k> :; (SUCCEED[s, k] ; NIL)) | {late}", "ASSERT[s]", until=3).store.run) == 1
    above = "(SIT[r]<i> :; (ASSERT[s] ; NIL))"
    reactor = f"{above} | (SIT[s]<k> :; NIL) | {late}"
    assert len(following(reactor, "ASSERT[r]", until=3).store.run) == 3
    assert len(following(reactor, "ASSERT[r]", "Delay[1] ; DRAIN[r]", until=3).store.run) == 2


def test_time_the_windows_of_the_leaves_that_time_ends() -> None:
    w = world()
    for name, seconds, found in (("Delay", 2, (2.0, 2.0)), ("SUSPEND", 500, (0.5, 0.5)), ("Term", 2, (0.0, 2.0))):
        assert window(Leaf(name, (seconds,)), w) == found
    for arguments, found in (((0.5,), 0.5), ((-3,), 0.0), (("p",), 0.0), ((), 0.0)):
        assert window(Leaf("Delay", arguments), w) == (found, found)
    assert window(Leaf("timed"), w) == (1.0, 3.0)
    assert window(Leaf("unknown"), w) == (0.0, 0.0)
    for name in ("IN", "OUT", "SIT", "KILL", "NIL", "ASSERT", "E", "ADD", "POST"):
        assert window(Leaf(name), w) == (float("inf"), float("inf"))
    assert run("SUSPEND[500]") == STOPS
    assert not list(steps(elapsed(begun("SUSPEND[500]", w=w), 0.4999, w), w))


def test_drain_two_of_one_situation_end_in_one_step() -> None:
    config = following("DRAIN[s] & DRAIN[s] & NIL", until=1)
    assert [t for t in inside(config.root(1)) if isinstance(t, Ended)] == [Ended(True), Ended(True)]
    assert [h.kind for h in config.store.inhibitions] == ["drain", "drain"]
    assert config.store.drains == ()
    busy = following(
        "(SIT[s]<k> :; Delay[2]) | (ASSERT[s] # Delay[1])", "Delay[0.5] ; (DRAIN[s] & DRAIN[s] & NIL)", until=9
    )
    assert [h.kind for h in busy.store.inhibitions] == ["drain", "drain"]


def test_time_a_basic_process_with_a_wrong_argument_aborts_at_once_and_says_why() -> None:
    signatures = {
        "act": Signature("act", ("number", "symbol", "any"), window=(1.0, 2.0)),
        "soon": Signature("soon", ("number",)),
    }
    w = World(signatures={**BUILT_IN, **signatures}, endings=lambda name, arguments: [(True, ())])
    for arguments, found in (((1, "p", 7), (1.0, 2.0)), (("p", "p", 7), (0.0, 0.0)), ((1, 2, 7), (0.0, 0.0)),
                             (("p", 2, 7), (0.0, 0.0)), ((), (1.0, 2.0)), ((1,), (1.0, 2.0))):  # fmt: skip
        assert window(Leaf("act", arguments), w) == found
    assert window(Leaf("soon", (1,)), w) == (0.0, 0.0)
    (wrong,) = steps(begun("act[p, p, 7]", w=w), w)
    assert (wrong.label, wrong.urgent) == (("act", ("p", "p", 7), "ab", ()), True)
    end = wrong.after.root(1)
    assert isinstance(end, Ended)
    assert end.cause == "error"
    assert not list(steps(begun("act[1, p, 7]", w=w), w))
    (right,) = steps(elapsed(begun("act[1, p, 7]", w=w), 1.0, w), w)
    assert (right.label[2], right.urgent) == ("ok", False)


def test_renew_a_reaction_that_was_posted_later_serves_situations_that_were_never_renewed() -> None:
    program = "P[4] = SIT[s]<k> :; SUCCEED[s, k]"
    reactor = "ADD<m> :: (E[m] # P[m])"
    assert run(reactor, "RENEW[t] ; POST[4]", "Delay[1] ; ASSERT[s]", program=program) == STOPS
    assert run(reactor, "Delay[1] ; RENEW[s] ; POST[4]", "ASSERT[s]", program=program) == {"runs"}
    assert run(reactor, "RENEW[s] ; POST[4]", "Delay[1] ; ASSERT[s]", program=program) == STOPS
    assert run(reactor, "POST[4] ; RETIRE[4] ; RENEW[s]", "Delay[1] ; ASSERT[s]", program=program) == {"runs"}
    assert run(reactor, "POST[4] ; RETIRE[4] ; RENEW[t]", "Delay[1] ; ASSERT[s]", program=program) == STOPS
    assert run(reactor, "POST[4] ; RETIRE[4] ; RENEW[s]", "ASSERT[s]", program=program) >= STOPS


def test_renew_what_the_store_knows_of_versions() -> None:
    store = Store().renewed("t").renewed("s").renewed("s")
    assert store.versions == (("s", 2), ("t", 1))
    assert (store.version("s"), store.version("t"), store.version("r")) == (2, 1, 0)
    store = store.posted(4).posted(5).posted(4)
    assert store.born == ((5, store.versions), (4, store.versions))
    assert Store().posted(4).born == ()
    retired = store.retire(4).renewed("s").retire(4).retire(5)
    assert retired.retired[0] == (4, (("s", 2), ("t", 1)))
    assert [entry[0] for entry in retired.retired] == [4, 5]
    kept = retired.guarded_by([5])
    assert ([e[0] for e in kept.born], [e[0] for e in kept.retired]) == ([5], [5])


def test_waitold_waits_for_older_instances_of_its_situation() -> None:
    store, _ = Store().asserted("s", (), None)
    assert not store.older("s", 0)
    assert store.older("s", 1)
    assert not store.older("t", 1)
    assert store.renewed("s").asserted("s", (), None)[0].instances[1].version == 1


def test_renew_of_a_disabled_situation_gives_up_what_is_on() -> None:
    serving = "(SIT[s]<k> :; NIL) | (SIT[t]<j> :; NIL) | ASSERT[s] | ASSERT[t]"
    config = following(serving, "Delay[1] ; DISABLE[s, A] ; RENEW[s] ; RENEW[t]", until=2)
    assert [(i.situation, i.withdrawn) for i in config.store.instances] == [("s", True), ("t", False)]


def test_queued_asserts_never_share_a_ticket() -> None:
    store, first = Store().queued("s", (1,), None)
    store, second = store.queued("s", (2,), None)
    store, third = store.queued("s", (3,), None)
    assert (first, second, third) == (-1, -2, -3)
    assert store.left_queue(second).queued("s", (), None)[1] == -4
    assert [q.arguments for q in store.left_queue(second).queue] == [(1,), (3,)]


def test_sit_with_nothing_after_it_is_no_body() -> None:
    config = following("SIT[s]<k>", "ASSERT[s]", until=1)
    assert config.root(1) == Ended(True, (("k", 1),))
    assert config.store.run == ()


def test_a_queued_assert_goes_on_when_its_own_situation_is_released() -> None:
    script = "DRAIN[s] ; DRAIN[t] ; Delay[2] ; UNINHIBIT[t] ; NIL"
    config = following(script, "Delay[1] ; (ASSERT[s] | ASSERT[t])", until=3)
    assert [q.situation for q in config.store.queue] == ["s"]
    assert [i.situation for i in config.store.instances] == ["t"]
    assert sum(isinstance(t, Await) for t in inside(config.root(2))) == 1


def test_time_is_held_by_one_urgent_step_among_others() -> None:
    w = world()
    assert urgent(begun("GTR[2, 1] | yes", w=w), w)
    assert not urgent(begun("yes | no", w=w), w)
    assert not urgent(begun("NIL", w=w), w)


def test_a_delay_without_a_duration_aborts_at_once() -> None:
    for text in ("Delay", "Term", "SUSPEND", "Delay[port]"):
        assert run(text) == ABORTS


def test_results_of_a_leaf_are_sorted_by_name() -> None:
    w = world()
    config = begun("SIT[s]<z, y>", "ASSERT[s, 5]", w=w)
    config = next(steps(config, w)).after
    config = next(steps(config, w)).after
    end = config.root(1)
    assert isinstance(end, Ended)
    assert end.bindings == (("y", 5), ("z", 1))


def test_reassert_gives_up_within_the_step_that_ends_its_child() -> None:
    reactor = "(SIT[s]<k> :; (REASSERT[t] & NIL)) | (SIT[t]<j> :; (Delay[2] ; FAIL[t, j]))"
    found = explored(reactor, "ASSERT[s]", "Delay[1] ; DRAIN[s]")
    labels = {label for moves in found.moves for label, _ in moves}
    assert ("REASSERT", ("t",), "wait", ()) in labels
    assert ("REASSERT", ("t",), "ab", ()) not in labels


def test_reassert_that_was_queued_repeats_and_an_assert_does_not() -> None:
    reactor = "SIT[s]<k> :; (~(IN[p]<x> : GTR[x, 0] : SUCCEED[s, k]) : FAIL[s, k])"
    script = "DRAIN[s] ; Delay[2] ; UNINHIBIT[s] ; NIL"
    for call, outcome, left in (("REASSERT", Ended(True), 0), ("ASSERT", Ended(False), 1)):
        config = following(reactor, script, f"Delay[1] ; {call}[s]", "OUT[p, 0] ; OUT[p, 1]", until=4)
        assert config.root(3) == outcome
        assert sum(isinstance(t, Leaf) for t in inside(config.root(4))) == left


def test_what_waits_for_the_store_stops() -> None:
    for text in ("WAIT[s]", "WAITINHIBIT[s]", "DRAIN[s]", "WAITOLD[s]"):
        assert run(text) == STOPS


def test_inhibitions_keep_their_order_when_one_is_taken_back() -> None:
    config = following("INHIBIT[s] ; INHIBIT[t] ; DRAIN[s] ; INHIBIT[u] ; UNINHIBIT[t] ; NIL", until=1)
    assert [(h.situation, h.kind) for h in config.store.inhibitions] == [
        ("s", "inhibit"), ("s", "drain"), ("u", "inhibit")]  # fmt: skip
