"""DISABLED, ENABLED and FREEZE: what they wait for, what they bring about (docs/language.md, Transitions)."""

from __future__ import annotations

from planner_reactor.rs.states import Ended, Leaf
from tests.rs.driving import SERVED, following, inside
from tests.rs.test_evolves import ABORTS, STOPS, run


def test_disabled_stops_while_an_assumption_disables_the_situation_and_says_which() -> None:
    assert run("DISABLED[s]<a>") == {"runs"}
    assert run("DISABLE[s, A] ; DISABLE[s, B] ; DISABLED[s]<a>") == {(True, (("a", "A"),))}
    assert run("DISABLE[s, A] ; DISABLE[s, B] ; ENABLE[s, A] ; DISABLED[s]<a>") == {(True, (("a", "B"),))}
    assert run("DISABLE[t, A] ; DISABLED[s]") == {"runs"}
    assert run("Delay[1] ; DISABLE[s, A]", "DISABLED[s]") == STOPS


def test_an_inhibition_that_is_no_assumption_does_not_disable() -> None:
    assert run("INHIBIT[s] ; DRAIN[s] ; DISABLED[s]") == {"runs"}
    assert run("INHIBIT[s] ; DRAIN[s] ; ENABLED[s]") == STOPS


def test_enabled_stops_while_none_does() -> None:
    assert run("ENABLED[s]") == STOPS
    assert run("DISABLE[s, A] ; ENABLED[s]") == {"runs"}
    assert run("DISABLE[s, A] ; DISABLE[s, B] ; ENABLE[s, A] ; ENABLED[s]") == {"runs"}
    assert run("DISABLE[s, A] ; Delay[1] ; ENABLE[s, A]", "Delay[0.5] ; ENABLED[s]") == STOPS


def test_a_reaction_that_waits_for_either_is_at_rest() -> None:
    for waiting in ("DISABLED[s] :; STOP", "STOP :; (STOP ; DISABLED[s])"):
        assert run(f"E[1] # ({waiting})", "Delay[1] ; KILL[1]") == STOPS
    assert run("E[1] # (DISABLE[s, A] ; (DISABLED[s] :; ENABLED[s]))", "Delay[1] ; KILL[1]") == STOPS
    busy = following("E[1] # (DISABLE[s, A] ; (DISABLED[s] :; Delay[9]))", "Delay[1] ; KILL[1]", until=5)
    assert not isinstance(busy.root(2), Ended)  # its body has begun: the KILL waits


def test_freeze_cuts_what_is_in_service_and_the_instance_stays_on() -> None:
    config = following(SERVED, "ASSERT[s]", "Delay[1] ; FREEZE[s] ; NIL", until=5)
    (instance,) = config.store.instances
    assert (instance.status, instance.withdrawn) == ("on", False)
    assert not config.store.run
    assert config.store.cut == 0
    assert [h.kind for h in config.store.inhibitions] == ["inhibit"]


def test_freeze_what_was_frozen_is_served_anew_when_it_is_released() -> None:
    reactor = "SIT[s]<k> :; (OUT[p, k] ; Delay[2] ; SUCCEED[s, k])"
    counting = "IN[p]<x> ; IN[p]<y> ; NIL"
    untouched = following(reactor, counting, "ASSERT[s]", until=7)
    assert not any(isinstance(t, Leaf) and t.name == "NIL" for t in inside(untouched.root(2)))
    config = following(reactor, counting, "ASSERT[s]", "Delay[1] ; FREEZE[s] ; Delay[3] ; UNINHIBIT[s]", until=7)
    assert any(isinstance(t, Leaf) and t.name == "NIL" for t in inside(config.root(2)))  # two numbers came
    assert config.root(3) == Ended(True)


def test_freeze_cuts_the_descendants_too_and_they_end() -> None:
    reactor = "(SIT[s]<k> :; (ASSERT[t] ; SUCCEED[s, k])) | (SIT[t]<j> :; (Delay[9] ; SUCCEED[t, j]))"
    config = following(reactor, "ASSERT[s]", "Delay[1] ; FREEZE[s] ; NIL", until=2)
    assert [(i.situation, i.status) for i in config.store.instances] == [("s", "on")]
    assert not config.store.run


def test_freeze_leaves_others_alone() -> None:
    reactor = "(SIT[s]<k> :; (Delay[9] ; SUCCEED[s, k])) | (SIT[t]<j> :; (Delay[3] ; SUCCEED[t, j]))"
    config = following(reactor, "ASSERT[s]", "ASSERT[t]", "Delay[1] ; FREEZE[s] ; NIL", until=4)
    assert config.root(3) == Ended(True)


def test_freeze_in_what_it_would_cut_aborts() -> None:
    assert run("SIT[s]<k> :; (if FREEZE[s] then SUCCEED[s, k] else FAIL[s, k])", "ASSERT[s]") == ABORTS
    below = "(SIT[s]<k> :; (ASSERT[t] ; SUCCEED[s, k])) | (SIT[t]<j> :; (if FREEZE[s] then NIL else SUCCEED[t, j]))"
    assert run(below, "ASSERT[s]") == STOPS


def test_freeze_its_inhibition_is_its_root_s_own() -> None:
    config = following(SERVED, "ASSERT[s]", "Delay[1] ; FREEZE[s] ; Delay[1]", until=2.5)
    assert not config.store.inhibitions  # released with its root (law 5)
    assert len(config.store.run) == 1
    assert not any(isinstance(t, Leaf) and t.name == "FREEZE" for t in inside(config.root(3)))
