"""Steps: their labels, when they are urgent, how long leaves last, and when a reaction may be killed.

The fine print of the rules: `test_evolves` asks what each says; here is what a rule with a small mistake would still
get right there (docs/analysis.md, Mutants).
"""

from __future__ import annotations

import pytest

from planner_reactor.rs.configurations import World
from planner_reactor.rs.evolves import started
from planner_reactor.rs.leaves import elapsed, offers, slack, steps, urgent, window
from planner_reactor.rs.parser import parse_process
from planner_reactor.rs.states import (
    Ended,
    Leaf,
)
from planner_reactor.rs.vocabulary import BUILT_IN, Signature
from tests.rs.driving import begun, causes, explored, following, inside
from tests.rs.test_evolves import ABORTS, STOPS, run, world


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


def test_a_root_has_the_number_that_it_is_given_or_the_next() -> None:
    w = world()
    config = started(parse_process("NIL"), w, number=4)
    assert [n for n, _ in config.roots] == [4]
    config = started(parse_process("NIL"), w, config=config, number=2)
    assert [n for n, _ in started(parse_process("NIL"), w, config=config).roots] == [4, 2, 5]


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


def test_time_is_held_by_one_urgent_step_among_others() -> None:
    w = world()
    assert urgent(begun("GTR[2, 1] | yes", w=w), w)
    assert not urgent(begun("yes | no", w=w), w)
    assert not urgent(begun("NIL", w=w), w)


def test_a_delay_without_a_duration_aborts_at_once() -> None:
    for text in ("Delay", "Term", "SUSPEND", "Delay[port]"):
        assert run(text) == ABORTS


def test_time_an_endless_window_opens_at_its_beginning() -> None:
    w = World(signatures={"late": Signature("late", window=(2.0, float("inf")))})
    config = begun("late", w=w)
    assert not list(steps(config, w))
    assert not list(steps(elapsed(config, 1.0, w), w))
    assert [s.urgent for s in steps(elapsed(config, 2.0, w), w)] == [False, False]
    assert elapsed(config, 9.0, w) == elapsed(config, 2.0, w)


def test_kill_asks_the_whole_reaction_of_its_guard_and_nothing_beside_it() -> None:
    cases = {
        "E[1] # NIL # Delay[9]": False, "E[1] # Delay[9] # NIL": False, "NIL # E[1] # NIL": True,
        "(E[1] # NIL) | Delay[9]": True, "Delay[9] | (E[1] # NIL)": True, "NIL | ((E[1] # NIL) | Delay[9])": True,
        "NIL | ((E[1] # Delay[9]) | NIL)": False, "(NIL # E[1]) & Delay[9]": True, "Delay[9] # E[1]": False,
    }  # fmt: skip
    for reactor, killable in cases.items():
        config = following(reactor, "KILL[1]", until=1)
        assert isinstance(config.root(2), Ended) == killable, reactor
    assert following("E[1] # NIL", "KILL[1]", until=1).root(1) == Ended(True)


def test_the_labels_of_the_guards_steps() -> None:
    w = world()

    def labels(text: str) -> set[tuple[object, ...]]:
        return {offer.label for offer in offers(begun(text, w=w), w)}

    assert labels("KILL[1] | (E[1] # NIL)") == {("KILL", (1,), "ok", ())}
    assert labels("RETIRE[1] | (E[1] # NIL)") == {("RETIRE", (1,), "ok", ())}
    assert labels("RETIRE[2] | (E[1] # NIL)") == {("RETIRE", (2,), "ab", ())}
    (refused,) = steps(begun("RETIRE[2]", w=w), w)
    end = refused.after.root(1)
    assert isinstance(end, Ended)
    assert (end.ok, end.cause) == (False, "error")
    assert labels("E[1]") == {("E", (1,), "ab", ())}


def test_the_labels_of_what_acts_on_situations() -> None:
    def after(*texts: str) -> set[tuple[object, ...]]:
        found = explored(*texts)
        return {label for moves in found.moves for label, _ in moves if label[0] != "TIME"}

    for call in ("SUCCEED[s, 1]", "FAIL[s, 1]", "UPDATE[s, 1, 2]", "INHIBIT[s]", "UNINHIBIT[s]", "DISABLE[s, A]",
                 "ENABLE[s, A]", "STUB[s]", "REPORT[s]", "RENEW[s]", "ENABLED[s]"):  # fmt: skip
        assert {label[2:] for label in after(call)} == {("ok", ())}, call
    for call in ("ASSERT[s]", "REASSERT[s]", "WAIT[s]", "WAITINHIBIT[s]", "DRAIN[s]", "WAITOLD[s]"):
        assert {label[2:] for label in after(call)} == {("wait", ())}, call
    assert after("ASSERT[7]") == {("ASSERT", (7,), "ab", ())}
    assert after("DRAIN[s] ; ASSERT[s]") == {("DRAIN", ("s",), "wait", ()), ("ASSERT", ("s",), "wait", ())}
    served = after("SIT[s]<k, x> :; (SUCCEED[s, k] ; ASSERT[t])", "ASSERT[s, 5]")
    assert {("SIT", ("s",), "ok", (1, 5)), ("ASSERT", ("t",), "ab", ())} <= served
    assert ("SIT", ("s",), "ok", (1,)) in after("SIT[s]<k>", "ASSERT[s]")
    assert ("ASSERT", ("s",), "ab", ()) in after("SIT[s]<k> :; ASSERT[s]", "ASSERT[s]")
    assert after("ASSUMONITOR[a, 0]") == {("ASSUMONITOR", ("a", 0), "ab", ())}
    (refused,) = steps(begun("POST[1] & (E[1] # NIL)", w=world()), world())
    assert [(t.ok, t.cause) for t in inside(refused.after.root(1)) if isinstance(t, Ended)] == [(False, "error")]
    (alone,) = steps(begun("E[1] & NIL", w=world()), world())
    assert [t.ok for t in inside(alone.after.root(1)) if isinstance(t, Ended)] == [False]


def test_what_acts_on_situations_at_once_stops() -> None:
    for call in ("SUCCEED[s, 1]", "FAIL[s, 1]", "UPDATE[s, 1, 2]", "INHIBIT[s]", "UNINHIBIT[s]", "DISABLE[s, A]",
                 "DISABLE[s, A] : DISABLE[s, A]", "ENABLE[s, A]", "STUB[s]", "REPORT[s]", "RENEW[s]",
                 "FREEZE[s]"):  # fmt: skip
        assert run(call) == STOPS, call
    assert run("ASSERT[7]") == run("ASSUMONITOR[a, 0]") == run("HOLDMONITOR[a, 0 - 1]") == ABORTS
    assert run("ASSUMONITOR[a, 0.5]") == {"runs"}


def test_freeze_of_what_it_stands_in_itself_is_an_error_and_of_anything_else_it_is_not() -> None:
    within = "(SIT[s]<k> :; (FREEZE[{}] ; NIL)) | (SIT[t]<j> :; NIL)"
    for situation, ok in (("s", False), ("t", True)):
        found = explored(within.format(situation), "ASSERT[s] & ASSERT[t]")
        labels = {label for moves in found.moves for label, _ in moves if label[0] == "FREEZE"}
        assert labels == {("FREEZE", (situation,), "ok" if ok else "ab", ())}
    config = following("(SIT[s]<k> :; (FREEZE[s] & NIL))", "ASSERT[s]", until=1)
    assert [(t.ok, t.cause) for t in inside(config.root(1)) if isinstance(t, Ended)] == [(False, "error")]
