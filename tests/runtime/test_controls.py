"""Controls: processes that the executer runs without knowing what they mean. Bodies, guards, rest."""

from __future__ import annotations

import pytest

from planner_reactor.runtime import Outcome
from tests.runtime.driving import begin, run
from tests.runtime.toys import Guardian, Latch, Opener


def test_a_waiting_control_is_ended_within_the_present_step() -> None:
    latch = Latch()
    begun = begin("LATCH<k> : GTR[k,1]", controls=[latch])
    begun.executer.run()
    begun.executer.end(latch.waiting[0], Outcome(True, (5,)))
    begun.executer.run()
    assert (begun.outcome, begun.results, begun.names) == ("stop", {"k": 5}, ["GTR"])


def test_a_woken_control_is_started_again_as_a_step_of_its_own() -> None:
    latch = Latch()
    begun = begin("LATCH[3]<k>", controls=[latch])
    begun.executer.run()
    latch.ready = Outcome(False, cause="stub")
    begun.executer.wake(latch.waiting[0])
    begun.executer.wake(latch.waiting[0])
    begun.executer.run()
    assert (latch.started, begun.seen) == (2, [("LATCH", (3,), "ab", ())])
    assert begun.root.cause == "stub"


def test_a_control_may_end_itself_while_it_starts() -> None:
    class Instant(Latch):
        def start(self, strand, arguments):  # type: ignore[no-untyped-def]
            begun.executer.end(strand, Outcome(True, (9,)))

    begun = begin("LATCH<k> : GTR[k,1]", controls=[Instant(announces=True)])
    begun.executer.run()
    assert begun.seen == [("LATCH", (), "wait", ()), ("GTR", (9, 1), "ok", ())]


def test_ending_what_is_over_has_no_effect() -> None:
    latch = Latch()
    begun = begin("LATCH # Delay[1]", controls=[latch])
    begun.executer.run()
    begun.executer.end(latch.waiting[0], Outcome(False))
    begun.executer.wake(latch.waiting[0])
    assert (begun.outcome, len(latch.cancelled)) == ("stop", 1)


def test_a_control_is_cancelled_once_when_it_waits_and_never_when_it_has_not_begun() -> None:
    latch = Latch()
    run("(LATCH | (Delay[5] ; LATCH)) # Delay[1]", controls=[latch])
    assert (latch.started, len(latch.cancelled)) == (1, 1)


@pytest.mark.parametrize(
    ("process", "log"),
    [
        ("OPEN<k> ; Delay[1]", ["opened 1", "stop 1"]),
        ("OPEN<k> : ABORT", ["opened 1", "abort 1"]),
        ("OPEN<k>", []),
        ("~OPEN<k> ; STOP", []),
        ("(OPEN<k> # NIL) ; STOP", []),
        ("(OPEN<k> : STOP) ; Delay[1]", ["opened 1", "stop 1"]),
        ("Delay[1] ; OPEN<k> ; Delay[1] ; ABORT", ["opened 1", "abort 1"]),
        ("OPEN<k> :; Delay[1]", [f"{what} {n}" for n in (1, 2, 3) for what in ("opened", "stop")]),
        ("OPEN<k> :: Delay[1]", ["opened 1", "opened 2", "opened 3", "stop 1", "stop 2", "stop 3"]),
        ("OPEN<k> ; (OPEN<m> ; STOP)", ["opened 1", "opened 2", "stop 2", "stop 1"]),
        ("(OPEN<k> ; (OPEN<m> :: Delay[9])) # Delay[1]", ["opened 1", "opened 2", "opened 3", "killed 2", "killed 3",
                                                          "killed 1"]),
    ],
)  # fmt: skip
def test_what_follows_to_the_end_of_the_operand_is_the_body(process: str, log: list[str]) -> None:
    opener = Opener()
    run(process, controls=[opener])
    assert [f"{what} {context}" for what, context in opener.log] == log


def test_a_body_is_closed_after_its_content() -> None:
    opener, latch = Opener(most=1), Latch()
    log: list[str] = []
    opener.closed = lambda body: log.append("closed")  # type: ignore[method-assign]
    latch.cancel = lambda strand: log.append("cancelled")  # type: ignore[method-assign]
    run("(OPEN<k> : (LATCH | NIL)) # Delay[1]", controls=[opener, latch])
    assert log == ["cancelled", "closed"]


def test_each_strand_knows_the_body_that_encloses_it() -> None:
    opener, latch = Opener(most=2), Latch()
    run("LATCH[a] | (OPEN<k> : (LATCH[b] | (OPEN<m> : LATCH[c]))) | NIL", controls=[opener, latch])
    contexts = {latch_strand.body.context if latch_strand.body else None for latch_strand in latch.waiting}
    assert contexts == {None, 1, 2}
    (inner,) = [s.body for s in latch.waiting if s.body and s.body.context == 2]
    assert [body.context for body in inner.enclosing()] == [2, 1]


def test_without_a_delivery_what_follows_runs_without_a_body() -> None:
    opener = Opener()
    ran = run("OPEN[1/0] ; Delay[1]", controls=[opener])
    assert (opener.log, ran.outcome, ran.now) == ([], "stop", 1.0)


def test_a_guard_labels_its_siblings_and_all_below_as_soon_as_they_live() -> None:
    guardian, latch = Guardian(), Latch()
    begun = begin("P[4] | P[5]", "P[n] = GUARD[n] # (LATCH | (Delay[1] ; LATCH))", controls=[guardian, latch])
    begun.executer.run()
    assert [label for label, _, _ in guardian.set_for] == [4, 5]
    assert sorted(str(strand.guard) for strand in latch.waiting) == ["4", "4", "5", "5"]


def test_a_guard_that_is_over_before_its_turn_is_cancelled() -> None:
    guardian = Guardian()
    ran = run("GUARD[1] # STOP", controls=[guardian])
    assert (ran.outcome, guardian.started) == ("stop", 0)
    assert guardian.cancelled == [strand for _, strand, _ in guardian.set_for]


@pytest.mark.parametrize(
    ("reaction", "rests"),
    [
        ("OPEN<k> :; Delay[9]", False),  # serves
        ("LATCH :; Delay[9]", True),  # senses
        ("Delay[0.5] :; Delay[9]", False),  # a round
        ("Delay[0.5] :: Delay[9]", False),
        ("(Delay[1] | LATCH) :; Delay[9]", True),
        ("LATCH", False),  # in no loop, and LATCH does not rest
        ("NIL", True),
        ("Q :; STOP", True),
        ("Delay[0.1] :; Q", False),
        ("(Delay[0.1] ; Q)", True),  # Q itself is a loop that senses
        ("(Delay[0.1] :; (LATCH :; STOP))", False),  # the condition of an inner loop
    ],
)
def test_a_reaction_rests_unless_something_of_it_is_in_service(reaction: str, rests: bool) -> None:
    guardian = Guardian()
    begun = begin(f"GUARD[1] # ({reaction})", "Q = LATCH :; Delay[9]", controls=[guardian, Opener(most=1), Latch()])
    begun.executer.run(2.0)
    ((_, _, (sibling,)),) = guardian.set_for
    assert begun.executer.resting(sibling) is rests


def test_what_waits_for_rest_is_told_when_it_may_have_come() -> None:
    guardian = Guardian()
    begun = begin("(GUARD[1] # (Delay[1] :; Delay[5])) | (Delay[2] :; STOP)", controls=[guardian])
    told: list[tuple[float, bool]] = []
    begun.executer.run(1.5)
    ((_, _, (sibling,)),) = guardian.set_for
    scheduler = begun.executer.scheduler
    begun.executer.watch(1, lambda: told.append((scheduler.now, begun.executer.resting(sibling))))
    begun.executer.run(6.5)
    begun.executer.unwatch(1)
    begun.executer.run(20.0)
    assert told == [(6.0, True)]


def test_the_site_of_a_leaf_is_its_place_in_the_text() -> None:
    latch = Latch()
    begin("LATCH | LATCH", controls=[latch]).executer.run()
    first, second = (strand.site for strand in latch.waiting)
    assert first != second
