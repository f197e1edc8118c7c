"""Situations: what the store holds after each rule, who is served, released, withdrawn, and in which order.

The fine print of the rules: `test_evolves` asks what each says; here is what a rule with a small mistake would still
get right there (docs/analysis.md, Mutants).
"""

from __future__ import annotations

import pytest

from planner_reactor.rs.states import (
    Await,
    Ended,
    InstanceNumber,
    Leaf,
    Reaction,
)
from planner_reactor.rs.store import Instance, Store
from tests.rs.driving import SERVED, causes, explored, following, inside
from tests.rs.test_evolves import STOPS, run


def test_assert_tells_why_its_instance_failed() -> None:
    assert causes("SIT[s]<k> :; FAIL[s, k]", "ASSERT[s]") == {"failed"}
    assert causes("SIT[s]<k> :; (STUB[s] ; FAIL[s, k])", "ASSERT[s]") == {"stub"}
    assert causes("SIT[s]<k> :; (STUB[s] ; SUCCEED[s, k])", "ASSERT[s]") == {""}
    assert causes(SERVED, "Delay[1] ; DRAIN[s]", "ASSERT[s]") == {"withdrawn"}
    assert causes("STOP", "Delay[1] ; DRAIN[s]", "ASSERT[s]") == {"withdrawn"}
    assert causes("STOP", "Delay[1] ; DISABLE[s, A]", "ASSERT[s]") == {"assumption"}
    assert causes("SIT[s]<k> :; (STUB[s] ; Delay[3])", "Delay[1] ; DISABLE[s, A]", "ASSERT[s]") == {"assumption"}
    assert causes("ASSERT[7]") == {"error"}


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


def test_drain_two_of_one_situation_end_in_one_step() -> None:
    config = following("DRAIN[s] & DRAIN[s] & NIL", until=1)
    assert [t for t in inside(config.root(1)) if isinstance(t, Ended)] == [Ended(True), Ended(True)]
    assert [h.kind for h in config.store.inhibitions] == ["drain", "drain"]
    assert config.store.drains == ()
    busy = following(
        "(SIT[s]<k> :; Delay[2]) | (ASSERT[s] # Delay[1])", "Delay[0.5] ; (DRAIN[s] & DRAIN[s] & NIL)", until=9
    )
    assert [h.kind for h in busy.store.inhibitions] == ["drain", "drain"]


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


def test_renew_what_a_reaction_was_posted_with_is_forgotten_with_its_guard() -> None:
    program = "P[4] = SIT[s]<k> :; SUCCEED[s, k]"
    script = "RENEW[s] ; POST[4] ; Delay[1] ; KILL[4] ; NIL"
    for until, known in ((0.5, [4]), (2, [])):
        config = following("ADD<m> :: (E[m] # P[m])", script, program=program, until=until)
        assert [label for label, _ in config.store.born] == known
