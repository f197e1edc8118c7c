"""The reactor acts from its first reaction on, and is changed only by safe adaptation (R §5)."""

from __future__ import annotations

import msgspec
import pytest

from planner_reactor.link.messages import Adaptation
from planner_reactor.reactor.adaptation import script
from planner_reactor.rs.parser import parse_program
from planner_reactor.rs.printer import show
from tests.reactor.driving import FIRST, SECOND, Bench, change

replace = msgspec.structs.replace


@pytest.fixture
def bench() -> Bench:
    return Bench()


def reason(bench: Bench) -> str:
    return next(p.cause for p in bench.perceptions() if p.kind == "adaptation_refused")


def test_the_null_reactor_does_nothing_and_breaks_no_law(bench: Bench) -> None:
    bench.run(10.0)
    assert not bench.trace.events
    assert not bench.reactor.laws.violations


def test_it_acts_as_soon_as_it_has_reactions_without_any_planner(bench: Bench) -> None:
    bench.at(1.0, FIRST)
    bench.run(10.0)
    assert bench.times("ended", situation="part", ok=True) == [3.0, 5.0, 7.0, 9.0]
    assert bench.reactor.assumptions_in_use == ("A",)
    assert not bench.reactor.laws.violations


def test_a_change_waits_for_the_body_in_service_and_interrupts_nothing(bench: Bench) -> None:
    bench.at(0.0, FIRST)
    bench.at(3.0, SECOND)
    bench.run(10.0)
    assert bench.times("removed", label=2) == [4.0]
    assert bench.times("added", label=4) == [4.0]
    assert bench.times("ended", situation="part", ok=True) == [2.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0]
    assert not bench.times("left", cut=True)
    assert not bench.reactor.laws.violations


def test_completion_is_told_with_guard_kills_and_the_outcome(bench: Bench) -> None:
    bench.at(0.0, FIRST)
    bench.at(3.0, SECOND)
    bench.run(10.0)
    told = [(p.kind, p.subject) for p in bench.perceptions()]
    assert told == [
        ("adaptation_applied", "1"), ("guard_kill", "2"), ("guard_kill", "3"), ("adaptation_applied", "2"),
    ]  # fmt: skip


def test_a_live_reactor_prints_as_a_program_that_can_be_run(bench: Bench) -> None:
    bench.at(0.0, FIRST)
    bench.run(1.0)
    program = parse_program(bench.reactor.text())
    assert {s.head[0].value for s in program.clauses("P")} == {0, 1, 2, 3}  # type: ignore[union-attr]
    assert show(program.clauses("REACTOR")[0]).count("E[") == 5


def test_the_script_of_an_adaptation_is_itself_rs() -> None:
    assert show(script(SECOND, ())) == "DRAIN[part] : COMMIT[2] : KILL[2] : KILL[3] : POST[4] : UNINHIBIT[part]"
    assert show(script(FIRST, ())) == "COMMIT[1] : POST[3] : POST[2] : POST[1] : POST[0]"


def test_an_adaptation_that_exceeds_its_deadline_changes_nothing(bench: Bench) -> None:
    slow = FIRST.definitions.replace("Do[old, 2]", "Long")
    bench.at(0.0, replace(FIRST, definitions=slow))
    bench.at(1.0, replace(SECOND, deadline=5.0))
    bench.run(20.0)
    assert [p.kind for p in bench.perceptions()][-1] == "adaptation_timed_out"
    assert sorted(bench.reactor.reactions) == [0, 1, 2, 3]
    assert not bench.reactor.situations.held
    assert bench.reactor.counts["timed_out"] == 1
    assert not bench.reactor.laws.violations


def test_the_bound_is_a_number_computed_from_declared_windows(bench: Bench) -> None:
    bench.at(0.0, FIRST)
    bench.run(1.0)
    assert 5.0 <= bench.reactor.bound(SECOND) <= 7.0


REFUSALS: dict[str, tuple[str, Adaptation]] = {
    "an id twice": ("repeated", replace(SECOND, id=1)),
    "another version": ("stale", replace(SECOND, changes=(change("part", 7),))),
    "an older epoch": ("epoch", replace(SECOND, epoch=-1)),
    "another mode": ("mode", replace(SECOND, mode="at once")),
    "a text that does not parse": ("text", replace(SECOND, definitions="P[4] = SIT[part]<k> :; (")),
    "an unknown process": ("text", replace(SECOND, definitions="P[4] = SIT[part]<k> :; Doo[new, 1]")),
    "a body whose tail would be cut": (
        "text",
        replace(SECOND, definitions="P[4] = (SIT[part]<k> : Do[new, 1]) :; SUCCEED[part, k]"),
    ),
    "labels other than its definitions": ("labels", replace(SECOND, adds=(5,))),
    "a label that is in use": ("labels", replace(SECOND, definitions="P[2] = NIL", adds=(2,))),
    "a kill of what is not there": ("labels", replace(SECOND, kills=(2, 9))),
    "a situation that it does not name": ("structure", replace(SECOND, changes=())),
    "an assertion that nothing serves": (
        "structure",
        replace(SECOND, definitions="P[4] = SIT[part]<k> :; (REASSERT[nobody] ; FAIL[part, k])"),
    ),
    "a situation asserted from below itself": (
        "structure",
        replace(SECOND, definitions="P[4] = SIT[part]<k> :; (REASSERT[work] ; FAIL[part, k])"),
    ),
    "a root that may be at work": ("structure", replace(SECOND, kills=(0, 2))),
}


@pytest.mark.parametrize(("expected", "adaptation"), REFUSALS.values(), ids=list(REFUSALS))
def test_what_cannot_be_applied_whole_is_refused_whole(
    bench: Bench, expected: str, adaptation: Adaptation
) -> None:
    bench.at(0.0, FIRST)
    bench.run(1.0)
    before = bench.reactor.text()
    bench.reactor.receive(adaptation)
    assert reason(bench) == expected
    bench.run(9.0)
    assert bench.reactor.text() == before
    assert not bench.reactor.laws.violations


def test_a_second_change_of_a_situation_is_refused_while_the_first_is_under_way(bench: Bench) -> None:
    bench.at(0.0, FIRST)
    bench.at(0.5, SECOND)
    bench.at(1.0, replace(SECOND, id=3, definitions=SECOND.definitions.replace("P[4]", "P[5]"), adds=(5,)))
    bench.run(1.5)
    assert reason(bench) == "pending"


def test_a_root_is_removed_by_draining_what_it_asserts(bench: Bench) -> None:
    bench.at(0.0, FIRST)
    stop = Adaptation(id=2, removed=("work", "part"), kills=(0, 1, 2, 3), adds=())
    bench.at(1.0, stop)
    bench.run(10.0)
    assert not bench.reactor.reactions
    assert not bench.reactor.situations.instances
    assert not bench.reactor.laws.violations


def test_other_situations_see_no_blocked_step(bench: Bench) -> None:
    """Local: while `part` is drained, `other` keeps its rhythm."""
    more = """
    P[10] = STOP :; ASSERT[other]
    P[11] = SIT[other]<k> :; (Do[side, 1] ; SUCCEED[other, k])
    """
    bench.at(0.0, replace(FIRST, definitions=FIRST.definitions + more, changes=(*FIRST.changes, change("other")),
                          adds=(*FIRST.adds, 11, 10)))  # fmt: skip
    bench.at(2.5, SECOND)
    bench.run(8.0)
    assert bench.times("ended", situation="other") == [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0]


# ------------------------------------------------------------------------------------------- assumptions, stubs


def test_a_failed_assumption_disables_what_rests_on_it_within_one_period(bench: Bench) -> None:
    bench.at(0.0, FIRST)
    bench.scheduler.call_at(4.2, lambda: bench.flags.update(A=False))
    bench.run(20.0)
    assert bench.times("inhibited", because="assumption") == [5.0]
    assert bench.times("ended", situation="part", ok=True) == [2.0, 4.0, 6.0]  # what was in service finished
    assert not bench.reactor.laws.violations
    (failure,) = [p for p in bench.perceptions() if p.kind == "assumption_failure"]
    assert (failure.subject, failure.count) == ("A", 16)


def test_an_adaptation_that_does_not_rest_on_it_enables_the_situation_again(bench: Bench) -> None:
    bench.at(0.0, FIRST)
    bench.scheduler.call_at(4.2, lambda: bench.flags.update(A=False))
    bench.at(10.0, SECOND)
    bench.run(13.5)
    assert bench.times("ended", situation="part", ok=True) == [2.0, 4.0, 6.0, 11.0, 12.0, 13.0]
    assert not bench.reactor.situations.held
    assert not bench.reactor.laws.violations


def test_unknown_is_not_false(bench: Bench) -> None:
    bench.flags["A"] = None
    bench.at(0.0, FIRST)
    bench.run(5.0)
    assert not bench.reactor.failed


def test_a_process_itself_may_report_that_an_assumption_fails(bench: Bench) -> None:
    bench.at(0.0, FIRST)
    bench.scheduler.call_at(3.0, lambda: bench.host.report("A", False, "it slipped"))
    bench.run(4.0)
    assert bench.reactor.failed == {"A": 3.0}


def test_what_a_process_reported_is_sent_again_until_nothing_rests_on_it(bench: Bench) -> None:
    """R §9.2.3: "repeatedly sent to the planner until the planner disables that portion of the reactor"."""
    bench.at(0.0, FIRST)
    bench.scheduler.call_at(3.0, lambda: bench.host.report("A", False, "it slipped"))
    bench.at(8.5, SECOND)
    bench.run(30.0)
    assert bench.times("assumption_failure", assumption="A") == [3.0, 5.0, 7.0]


def test_an_assumption_that_holds_again_is_told_and_enables(bench: Bench) -> None:
    hold = "P[9] = HOLDMONITOR[A, 1000]"
    bench.at(0.0, replace(FIRST, definitions=FIRST.definitions + hold, adds=(*FIRST.adds, 9)))
    bench.scheduler.call_at(4.2, lambda: bench.flags.update(A=False))
    bench.scheduler.call_at(8.2, lambda: bench.flags.update(A=True))
    bench.run(12.0)
    assert bench.times("assumption_holds") == [9.0]
    assert bench.times("ended", situation="part", ok=True) == [2.0, 4.0, 6.0, 11.0]


def test_a_stub_tells_the_planner_and_its_failure_is_no_situation_failure(bench: Bench) -> None:
    stub = FIRST.definitions.replace(
        "(~(Do[old, 2] : SUCCEED[part, k]) : FAIL[part, k])", "((STUB[part] : SUSPEND[2000]) ; FAIL[part, k])"
    )
    bench.at(0.0, replace(FIRST, definitions=stub))
    bench.run(5.0)
    kinds = [(p.kind, p.subject, p.count) for p in bench.perceptions()]
    assert ("stub_trigger", "part", 3) in kinds
    assert not [k for k in kinds if k[0] == "situation_failure"]


def test_a_situation_that_fails_is_told_and_repeats_are_counted(bench: Bench) -> None:
    bench.failing.add("old")
    bench.at(0.0, FIRST)
    bench.run(9.0)
    (failure,) = [p for p in bench.perceptions() if p.kind == "situation_failure"]
    assert (failure.subject, failure.cause, failure.count) == ("part", "failed", 4)


def test_information_that_was_asked_for_is_reported(bench: Bench) -> None:
    asking = "P[9] = Do[look, 1] : REPORT[seen, 42]"
    bench.at(0.0, replace(FIRST, definitions=FIRST.definitions + asking, adds=(*FIRST.adds, 9)))
    bench.run(3.0)
    (told,) = [p for p in bench.perceptions() if p.kind == "information"]
    assert (told.subject, told.values) == ("seen", (42,))
    assert 9 not in bench.reactor.reactions  # it has ended by itself


@pytest.mark.parametrize("root", ["STOP :; (Do[think, 3] ; ASSERT[work])", "STOP :; (ASSERT[work] | Do[think, 1])"])
def test_a_root_that_does_more_than_assert_is_not_killed_for_it_might_be_at_work(bench: Bench, root: str) -> None:
    text = FIRST.definitions.replace("STOP :; ASSERT[work]", root)
    bench.reactor.receive(replace(FIRST, definitions=text))
    serving = "P[8] = SIT[work]<k> :; (Do[new, 1] ; SUCCEED[work, k])"
    work = (change("work", 1),)
    other = Adaptation(id=2, definitions=serving, changes=work, removed=("part",), kills=(0, 1, 2), adds=(8,))
    bench.at(5.5, other)
    bench.run(20.0)
    (refused,) = [p for p in bench.perceptions() if p.kind == "adaptation_refused"]
    assert refused.cause == "structure"
    assert "does more in its body than assert" in str(refused.values[0])
    assert bench.reactor.laws.violations == []
