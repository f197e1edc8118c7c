"""No adaptation leaves the planner unverified: what does not hold is withheld, and counts as refused."""

from __future__ import annotations

from itertools import groupby

import pytest
from msgspec.structs import replace

from planner_reactor.analysis.adaptations import Environment
from planner_reactor.link.messages import Adaptation, Change, Perception
from planner_reactor.planner import Planner
from planner_reactor.planner.issuing import Issuer
from planner_reactor.planner.steps import Step
from planner_reactor.planner.verifying import PARTS, Gate
from planner_reactor.rs.vocabulary import Signature
from tests.planner.driving import kitting

FIRST = Adaptation(
    id=1,
    definitions="""
    P[0] = STOP :; ASSERT[work]
    P[1] = SIT[work]<k> :; (~(REASSERT[part] : SUCCEED[work, k]) : FAIL[work, k])
    P[2] = SIT[part]<k> :; (~(Do : SUCCEED[part, k]) : FAIL[part, k])
    """,
    changes=(Change(situation="work", base=0, fresh=True), Change(situation="part", base=0, fresh=True)),
    adds=(2, 1, 0),
)
SECOND = Adaptation(
    id=2,
    definitions="P[3] = SIT[part]<k> :; (~(Do : Do : SUCCEED[part, k]) : FAIL[part, k])",
    changes=(Change(situation="part", base=1),),
    kills=(2,),
    adds=(3,),
)
EXPLORED = replace(
    SECOND, definitions="P[3] = SIT[part]<k> :; (~(if Do then SUCCEED[part, k] else (Do ; ABORT)) : FAIL[part, k])"
)
"""An exchange of one reaction for another that ends in two ways, which no rule knows to be right."""
THIRD = replace(SECOND, id=3, definitions=SECOND.definitions.replace("P[3]", "P[4]"), kills=(3,), adds=(4,))


def perception(kind: str, subject: int) -> Perception:
    return Perception(number=1, time=0.0, kind=kind, subject=str(subject))  # type: ignore[arg-type]


def gate(*sent: Adaptation) -> Gate:
    made = Gate()
    for adaptation in sent:
        assert made.examine(adaptation).holds
        made.perceive(perception("adaptation_applied", adaptation.id))
    return made


def test_what_adds_to_nothing_needs_no_look_and_is_remembered() -> None:
    made = gate(FIRST)
    assert not made.verifier.seen
    assert made.examine(EXPLORED).states > 0


def test_one_reaction_exchanged_for_another_is_known_to_be_right() -> None:
    made = gate(FIRST)
    assert made.examine(SECOND).holds
    assert not made.verifier.seen


def test_what_claims_to_be_new_and_is_not_is_looked_at() -> None:
    again = replace(SECOND, changes=(Change(situation="part", base=0, fresh=True),), kills=())
    made = gate(FIRST)
    assert made.examine(again).holds  # a second reaction beside the first: nobody is cut off
    assert made.verifier.seen


def test_a_kill_without_a_drain_is_withheld_with_the_steps_that_show_it() -> None:
    made = gate(FIRST)
    undrained = replace(SECOND, changes=(Change(situation="part", base=1, fresh=True),))
    found = made.examine(undrained)
    assert not found.safe
    assert made.withheld[2] == found
    assert found.counterexample


def test_in_mode_wait_what_may_be_overtaken_is_sent_and_what_waits_for_itself_is_not() -> None:
    both = replace(
        SECOND,
        definitions=SECOND.definitions
        + "\nP[4] = SIT[work]<k> :; (~(REASSERT[part] : SUCCEED[work, k]) : FAIL[work, k])",
        changes=(Change(situation="work", base=1), Change(situation="part", base=1)),
        kills=(1, 2),
        adds=(3, 4),
        mode="wait",
    )
    for changes, sent in ((both.changes, True), (both.changes[::-1], False)):
        made = Gate(mode="wait")
        made.examine(FIRST)
        found = made.examine(replace(both, changes=changes))
        assert found.holds == sent, found
    assert found.why == "from here on the script cannot end"


def test_what_was_not_applied_is_forgotten() -> None:
    made = gate(FIRST)
    made.examine(SECOND)
    made.perceive(perception("adaptation_timed_out", 2))
    assert not made.examine(THIRD).holds  # it kills what has never come
    assert gate(FIRST, SECOND).examine(THIRD).holds


def test_without_a_bound_nothing_is_sent_once_windows_are_known() -> None:
    made = gate(FIRST)
    made.meet(Environment({"Do": Signature("Do", window=(0.0, 3.0))}))
    assert made.examine(SECOND).bound_s == 3.0
    made = gate(FIRST)
    made.meet(Environment({"Do": Signature("Do", window=(0.0, float("inf")))}))
    assert not made.examine(SECOND).bounded


def test_a_text_that_cannot_be_read_is_withheld() -> None:
    assert "expected" in gate(FIRST).examine(replace(SECOND, definitions="P[3] = SIT[part")).why


# -------------------------------------------------------------------------------------------------- inside a planner


def steps(planner: Planner, most: int = 400) -> list[Step]:
    """Everything that the planner does, with a reactor that applies what it is sent at once."""
    done = []
    while (step := planner.step()) is not None and len(done) < most:
        done.append(step)
        for adaptation in step.adaptations:
            planner.perceive(perception("adaptation_applied", adaptation.id))
    return done


def test_verification_changes_nothing_of_what_holds() -> None:
    verified, trusted = (steps(Planner(kitting(), verify=verify)) for verify in (True, False))
    assert [step for step in verified if step.kind != "verify"] == trusted
    assert not any(step.withheld for step in verified)


def test_a_new_shape_is_looked_at_in_several_steps_and_a_known_one_at_once() -> None:
    done = steps(Planner(kitting()))
    assert done[0].kind == "refine"
    first, *later = [len(list(group)) for kind, group in groupby(done, key=lambda s: s.kind) if kind == "verify"]
    assert len(PARTS) < first <= 15  # a part of what looking needs is loaded in each, then it is looked
    assert later
    assert max(later) <= 5
    assert all(step.adaptations == () for step in done if step.kind == "verify")
    assert sum(step.kind == "verify" for step in done[len(done) // 2 :]) < sum(step.kind == "verify" for step in done)


def test_what_is_held_goes_on_when_something_is_perceived_and_is_looked_at_anew_if_the_reactor_changes() -> None:
    made = gate(FIRST)
    stub = "P[9] = SIT[work]<k> :; (Do ; FAIL[work, k])"
    beside = replace(SECOND, id=9, kills=(1,), adds=(9,), changes=(Change(situation="work", base=1),), definitions=stub)
    assert made.examine(beside).holds
    assert made.look(Step("refine", adaptations=(EXPLORED,))) is None
    made.perceive(perception("adaptation_refused", 9))
    looked = None
    while looked is None:
        assert made.held is not None
        looked = made.look_on()
    ((adaptation, verdict),) = looked[1]
    assert (adaptation, verdict.holds, made.held) == (EXPLORED, True, None)


def test_a_planner_that_forgets_to_drain_is_stopped(monkeypatch: pytest.MonkeyPatch) -> None:
    """Every change says that its situation is new, so nothing of it would be waited for."""
    issue = Issuer._send

    def careless(self: Issuer, *given: object) -> Adaptation | None:
        made = issue(self, *given)  # type: ignore[arg-type]
        if made is None:
            return None
        return replace(made, changes=tuple(replace(change, fresh=True) for change in made.changes))

    monkeypatch.setattr(Issuer, "_send", careless)
    planner = Planner(kitting())
    done = steps(planner)
    sent = [adaptation for step in done for adaptation in step.adaptations]
    assert [adaptation.kills for adaptation in sent if adaptation.changes] == [()]  # the first, and no other
    withheld = [step.withheld for step in done if step.withheld]
    assert withheld
    assert withheld[0].startswith("FillTray")
    assert "not safe" in withheld[0]
    assert "is reached while its reaction is at work" in withheld[0]
    assert "SIT[FillTray]" in withheld[0]
    assert set(planner.withheld.values()) == set(withheld)
    assert "withheld" in planner.impossible["FillTray"]
    assert planner.statistics()["withheld"] == len(withheld)
