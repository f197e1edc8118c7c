"""Three ways to change a running reactor: `drain` (the rule), `wait` (the papers'), `versions` (old beside new)."""

from __future__ import annotations

import msgspec
import pytest

from planner_reactor.link.messages import Adaptation
from planner_reactor.reactor.adaptation import script
from planner_reactor.reactor.assumptions import Assumptions
from planner_reactor.rs.printer import show
from tests.reactor.driving import FIRST, SECOND, Bench, change

replace = msgspec.structs.replace
MODES = ("drain", "wait", "versions")

OVERLAPPING = Adaptation(
    id=1,
    definitions="""
    P[0] = STOP :; ASSERT[part, 1]
    P[1] = Delay[0.1] :; ASSERT[part, 2]
    P[2] = SIT[part]<k, n> :: (~(Do[old, 5] : SUCCEED[part, k]) : FAIL[part, k])
    """,
    changes=(change("part"),),
    adds=(2, 1, 0),
)
NEWER = Adaptation(
    id=2,
    definitions="P[3] = SIT[part]<k, n> :: (~(Do[new, 1] : SUCCEED[part, k]) : FAIL[part, k])",
    changes=(change("part", 1),),
    kills=(2,),
    adds=(3,),
)
WITHOUT_PART = Adaptation(
    id=2,
    definitions="P[4] = SIT[work]<k> :; (~(Do[whole, 1] : SUCCEED[work, k]) : FAIL[work, k])",
    changes=(change("work", 1),),
    removed=("part",),
    kills=(1, 2),
    adds=(4,),
)


def in_mode(adaptation: Adaptation, mode: str) -> Adaptation:
    return replace(adaptation, mode=mode)


def test_each_mode_is_a_script() -> None:
    bench = Bench()
    bench.at(0.0, FIRST)
    bench.run(1.0)
    killed = tuple(bench.reactor.reactions[label] for label in SECOND.kills)
    texts = {mode: show(script(in_mode(SECOND, mode), killed)) for mode in MODES}
    assert texts == {
        "drain": "DRAIN[part] : COMMIT[2] : KILL[2] : KILL[3] : POST[4] : UNINHIBIT[part]",
        "wait": "WAITINHIBIT[part] : COMMIT[2] : KILL[2] : KILL[3] : POST[4] : UNINHIBIT[part]",
        "versions": "COMMIT[2] : RETIRE[2] : RETIRE[3] : RENEW[part] : POST[4]",
    }


@pytest.mark.parametrize("mode", MODES)
def test_every_mode_keeps_every_law_and_comes_to_the_same_structure(mode: str) -> None:
    bench = Bench()
    bench.at(0.0, FIRST)
    bench.at(3.0, in_mode(SECOND, mode))
    bench.run(60.0)
    assert bench.reactor.laws.violations == []
    assert bench.reactor.versions == {"work": 1, "part": 2}
    assert sorted(bench.reactor.reactions) == [0, 1, 4]
    assert sorted(bench.reactor.executer.definitions) == sorted({"REACTOR", "P", "STREAM"})


def test_a_drain_waits_for_what_is_in_service_a_version_does_not() -> None:
    applied = {}
    for mode in MODES:
        bench = Bench()
        bench.at(0.0, FIRST)
        bench.at(3.0, in_mode(SECOND, mode))
        bench.run(60.0)
        applied[mode] = bench.times("adaptation_applied", id=2)
    assert applied == {"drain": [4.0], "wait": [4.0], "versions": [3.0]}


def test_where_instances_overlap_the_papers_mode_never_begins() -> None:
    outcomes = {}
    for mode in MODES:
        bench = Bench()
        bench.at(0.0, OVERLAPPING)
        bench.at(9.0, in_mode(NEWER, mode))
        bench.run(100.0)
        outcomes[mode] = bench.times("adaptation_applied", id=2)
        assert bench.reactor.laws.violations == []
    assert outcomes["versions"] == [9.0]
    assert 9.0 < outcomes["drain"][0] <= 14.0
    assert outcomes["wait"] == []


def test_old_instances_keep_the_old_reaction_and_new_ones_get_the_new() -> None:
    bench = Bench()
    bench.at(0.0, OVERLAPPING)
    bench.at(10.0, in_mode(NEWER, "versions"))
    bench.run(40.0)
    asserted = {e.data["instance"]: e.time for e in bench.trace.of("asserted")}
    served = {e.data["instance"]: e.data["guard"] for e in bench.trace.of("entered")}
    assert {served[i] for i, at in asserted.items() if at < 10.0} == {2}
    assert {served[i] for i, at in asserted.items() if 10.0 < at < 39.0} == {3}
    assert bench.times("queued") == []


def test_what_was_retired_goes_when_its_last_instance_has_ended() -> None:
    bench = Bench()
    bench.at(0.0, OVERLAPPING)
    bench.at(10.0, in_mode(NEWER, "versions"))
    bench.run(40.0)
    left = [e.time for e in bench.trace.of("left") if e.data["guard"] == 2]
    assert bench.times("removed", label=2) == [max(left)]
    kills = [p.time for p in bench.perceptions() if p.kind == "guard_kill"]
    assert kills == [max(left)]


def test_what_an_older_parent_may_still_assert_stays_as_long_as_it_does() -> None:
    bench = Bench()
    bench.at(0.0, FIRST)
    bench.at(1.0, in_mode(WITHOUT_PART, "versions"))
    bench.run(30.0)
    assert bench.times("adaptation_applied", id=2) == [1.0]
    old_work = next(e.data["instance"] for e in bench.trace.of("asserted") if e.data["situation"] == "work")
    ended = bench.times("completed", instance=old_work)
    assert bench.times("removed", label=1) == ended
    assert bench.times("removed", label=2) == ended
    assert bench.reactor.laws.violations == []
    assert bench.reactor.laws.interruptions == 0


def test_removals_keep_the_order_of_their_adaptations() -> None:
    bench = Bench()
    bench.at(0.0, OVERLAPPING)
    bench.at(10.0, in_mode(NEWER, "versions"))
    third = replace(
        NEWER, id=3, mode="versions", definitions=NEWER.definitions.replace("P[3]", "P[4]"), adds=(4,), kills=(3,),
        changes=(change("part", 2),),
    )  # fmt: skip
    bench.at(10.5, third)
    bench.run(40.0)
    assert bench.times("adaptation_applied", id=3) == [10.5]
    assert [e.data["label"] for e in bench.trace.of("removed")] == [2, 3]
    assert bench.reactor.laws.violations == []


def test_a_root_has_no_versions() -> None:
    bench = Bench()
    bench.at(0.0, FIRST)
    bench.run(1.0)
    removal = Adaptation(id=2, kills=(0, 1, 2), changes=(), removed=("work", "part"), mode="versions")
    bench.reactor.receive(removal)
    refused = next(p for p in bench.perceptions() if p.kind == "adaptation_refused")
    assert refused.cause == "structure"
    assert "expected mode drain" in str(refused.values[0])


def test_an_instance_of_a_disabled_situation_is_given_up_when_its_version_ends() -> None:
    bench = Bench()
    bench.at(0.0, FIRST)
    bench.scheduler.call_at(2.5, lambda: bench.flags.update(A=False))
    bench.at(3.5, replace(in_mode(SECOND, "versions"), kills=(2,)))
    bench.run(20.0)
    assert bench.reactor.laws.violations == []
    served = [(e.time, e.data["guard"]) for e in bench.trace.of("entered") if e.data["situation"] == "part"]
    assert all(guard == 4 for time, guard in served if time > 3.5)


def test_a_root_that_senses_again_is_at_rest_while_it_does() -> None:
    """Chaos found it: the call of P[m] stands in a loop of equation (3), which must not count."""
    bench = Bench()
    bench.at(0.0, replace(OVERLAPPING, definitions=OVERLAPPING.definitions.replace("Delay[0.1] :;", "Delay[7] ::")))
    bench.run(30.0)
    bench.reactor.receive(Adaptation(id=2, kills=(0, 1, 2), removed=("part",)))
    bench.run(60.0)
    assert bench.reactor.laws.violations == []
    assert bench.reactor.reactions == {}
    assert bench.times("adaptation_applied", id=2)[0] <= 35.0


# ------------------------------------------------------------------- what an old version rests on fails (law 14)


def slowly(adaptation: Adaptation) -> Adaptation:
    return replace(adaptation, definitions=adaptation.definitions.replace("Do[old, 2]", "Do[old, 5]"))


def test_an_old_version_whose_assumption_fails_after_it_was_retired_is_given_up() -> None:
    """Its monitor stays as long as it does; its body in service finishes, and counts as failed."""
    bench = Bench()
    bench.at(0.0, slowly(FIRST))
    bench.at(3.0, in_mode(SECOND, "versions"))
    bench.scheduler.call_at(3.2, lambda: bench.flags.update(A=False))
    bench.run(12.0)
    assert bench.times("assumption_failure", assumption="A") == [4.0]
    (old,) = (e for e in bench.trace.of("ended") if e.data["situation"] == "part" and e.time == 5.0)
    assert (old.data["ok"], old.data["cause"]) == (False, "withdrawn")
    assert [(e.time, e.data["guard"]) for e in bench.trace.of("entered") if e.data["situation"] == "part"][:2] == [
        (0.0, 2), (5.0, 4),
    ]  # fmt: skip
    assert [(e.time, e.data["label"]) for e in bench.trace.of("removed")] == [(5.0, 2), (5.0, 3)]
    assert bench.reactor.laws.interruptions == 0
    assert bench.reactor.laws.violations == []


def test_a_new_version_is_not_concerned_by_what_the_old_one_rested_on() -> None:
    bench = Bench()
    bench.at(0.0, slowly(FIRST))
    bench.at(3.0, in_mode(SECOND, "versions"))
    bench.scheduler.call_at(7.0, lambda: bench.reactor.assumption_sensed("A", False))
    bench.run(12.0)
    assert all(e.data["ok"] for e in bench.trace.of("ended"))
    assert bench.times("inhibited") == []


def test_whoever_may_still_assert_what_is_removed_is_given_up_with_it() -> None:
    """There is no newer version of `part` that its old parent could go on with."""
    bench = Bench()
    bench.at(0.0, slowly(FIRST))
    bench.at(3.0, in_mode(WITHOUT_PART, "versions"))
    bench.scheduler.call_at(3.2, lambda: bench.reactor.assumption_sensed("A", False))
    bench.run(30.0)
    ended = [(e.time, e.data["situation"], e.data["ok"]) for e in bench.trace.of("ended")]
    assert ended[:2] == [(5.0, "part", False), (5.0, "work", False)]
    assert all(situation == "work" and ok for time, situation, ok in ended[2:])
    assert {e.data["label"] for e in bench.trace.of("removed")} >= {1, 2}
    assert bench.reactor.laws.violations == []


def test_an_old_version_that_is_not_given_up_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Assumptions, "_give_up", lambda self: None)
    bench = Bench()
    bench.at(0.0, slowly(FIRST))
    bench.at(3.0, in_mode(SECOND, "versions"))
    bench.scheduler.call_at(3.2, lambda: bench.reactor.assumption_sensed("A", False))
    bench.run(12.0)
    assert {violation.law for violation in bench.reactor.laws.violations} == {14}


def test_what_is_gone_is_forgotten() -> None:
    """A reaction that was retired and has gone leaves nothing behind, however many adaptations a reactor has seen."""
    bench = Bench()
    bench.at(0.0, FIRST)
    bench.at(3.0, in_mode(SECOND, "versions"))
    bench.run(3.5)
    assert bench.reactor.situations.versions._retired.keys() == {2, 3}
    bench.run(20.0)
    versions = bench.reactor.situations.versions
    assert {*versions._born, *versions._retired} <= bench.reactor.reactions.keys()
