"""Reactions found from environment models: TRACK, GuardedMove and GuardedWait (X §5), by reasoning alone."""

from __future__ import annotations

import re

import pytest

from planner_reactor.errors import DomainError, InputError
from planner_reactor.experiments.servoing import domain_for
from planner_reactor.link.messages import Perception
from planner_reactor.logic.reader import read_domain
from planner_reactor.planner import Planner
from planner_reactor.planner.inlining import Inliner, definition
from planner_reactor.planner.servos import Model, exploiting
from planner_reactor.rs.printer import show
from planner_reactor.rs.terms import Symbol
from planner_reactor.workcell.environments.dynamics import host, model
from planner_reactor.workcell.environments.exploits import wanted
from planner_reactor.workcell.environments.worlds import MEASURES, TIMING
from tests.planner.driving import Book, perception, planner_without, settle, texts

LOOK = r"\(IN\[s1\]<v\d> :; \(OUT\[(\w+), v\d\] # Delay\[0\.05\]\) \| "
FOLLOW = r"IN\[(\w+)\]<v\d> :; OUT\[m1, v\d\]\)"
APPROACH = r"\(\(IN\[j\]<v\d> : IN\[(\w+)\]<v\d>\) : OUT\[r, v\d - v\d\]\) :; Delay\[0\.29\]\)"
ACQUIRE = r"\(\(OUT\[g, 1\] : IN\[h\]<(?P<h>v\d)> : Equal\[(?P=h), 1\] : Delay\[0\.5\]\) # \(Delay\[1\.0\] : ABORT\)\)"


def reaction(kind: str, situation: str, *without: str) -> str:
    """What a planner writes for a situation where these assumptions have failed."""
    planner = planner_without(domain_for(kind), without, verify=False)
    steps = [planner.step() for _ in range(400)]
    assert steps[-1] is None
    assert not planner.impossible
    return texts(planner)[situation]


def connected(pattern: str, text: str) -> None:
    """The two actions stand side by side and share a port."""
    found = re.search(pattern, text)
    assert found, text
    assert found[1] == found[2]


def test_track_is_look_and_movecamera_side_by_side_with_their_ports_connected() -> None:
    connected(LOOK + FOLLOW, reaction("tracking", "Keep", "Still"))


def test_an_object_that_stands_still_needs_no_tracking() -> None:
    assert reaction("tracking", "Keep") == "SIT[Keep]<k> :; (~(Delay[2] : SUCCEED[Keep, k]) : FAIL[Keep, k])"


def test_guarded_move_is_found_where_nothing_brings_the_object() -> None:
    text = reaction("reaching", "Acquire", "Still")
    connected(r"IN\[t\]<v\d> # \(Delay\[30\.0\] : ABORT\) # " + LOOK + APPROACH, text)
    assert re.search(APPROACH + r"\) : " + ACQUIRE, text)


def test_guarded_wait_is_found_where_a_belt_does() -> None:
    text = reaction("line", "Acquire")
    waiting = r"IN\[t\]<v\d> # \(Delay\[30\.0\] : ABORT\) # "
    running = r"\(\(Delay\[0\.1\] : IN\[b\]<(v\d)> : Equal\[\1, 1\]\) :; STOP"
    upstream = r".*\(Delay\[0\.1\] : IN\[s1\]<(v\d)> : IN\[j\]<(v\d)> : ~GTR\[\2 - \3, 0\.25\]\) :; STOP"
    assert re.search(waiting + r"\(*" + running.removeprefix(r"\(") + upstream, text), text
    assert "OUT[r" not in text


@pytest.mark.parametrize("failed", ["Running", "Upstream"])
def test_without_what_the_model_of_the_belt_takes_for_granted_it_is_guarded_move(failed: str) -> None:
    assert "OUT[r" in reaction("line", "Acquire", failed, "Still")


def test_a_model_of_the_belt_that_is_true_again_brings_guarded_wait_back() -> None:
    planner = Planner(domain_for("line"), relax=(), verify=False)
    fails, holds = perception("assumption_failure", "Running"), perception("assumption_holds", "Running")
    settled = texts_after(planner, fails, holds)
    assert ["OUT[r" in text for text in settled] == [False, True, False]


def texts_after(planner: Planner, *told: Perception) -> list[str]:
    book = Book(planner.domain, loads=False)
    settle(planner, book)
    found = [texts(planner)["Acquire"]]
    for perceived in told:
        planner.perceive(perceived)
        settle(planner, book)
        found.append(texts(planner)["Acquire"])
    return found


# ------------------------------------------------------------------------------------------------- the reasoning

RING = """
atp_goal Keep forall i: Lit(x) @ i and ITL(i, encompasses, time);
atp_actionschema Feed <><> intervals i; executability: Lit(x) @ i and ITL(i, encompasses, Feed);
    effects: Fed(x) @ Feed; endactionschema
atp_actionschema Burn <><> intervals i; executability: Fed(x) @ i and ITL(i, encompasses, Burn);
    effects: Lit(x) @ Burn; endactionschema
atp_assumption Calm();
atp_persistence Lit(x) while Calm();
"""


def impossible(text: str, *without: str) -> bool:
    planner = planner_without(read_domain(text), without, verify=False)
    settle(planner)
    return bool(planner.impossible)


def test_actions_that_keep_each_other_going_must_have_something_to_begin_with() -> None:
    assert impossible(RING, "Calm")
    assert impossible(RING + "atp_fact Lit(other);", "Calm")
    assert not impossible(RING + "atp_fact Lit(x);", "Calm")


def test_what_holds_only_for_a_while_does_not_keep_a_goal() -> None:
    text = """
    atp_goal Keep forall i: Lit(x) @ i and ITL(i, encompasses, time);
    atp_actionschema Strike <><> intervals i; effects: Lit(x) @ i and ITL(Strike, meets, i); endactionschema
    """
    assert impossible(text)


def test_a_goal_is_kept_or_achieved_and_not_half_of_each() -> None:
    text = RING.replace("Lit(x) @ i and ITL", "Lit(x) @ i and Fed(x) @ j and ITL", 1).replace(
        "forall i:", "forall i, j:", 1
    )
    with pytest.raises(DomainError, match="kept in part"):
        read_domain(text)


def test_what_one_goal_keeps_another_may_count_on() -> None:
    text = (
        RING
        + """
    atp_fact Lit(x);
    atp_goal Read forall i: Known(x) @ i;
    atp_actionschema Look <><> intervals i, j; executability: Lit(x) @ i and ITL(i, encompasses, Look);
        effects: Known(x) @ j and ITL(Look, meets, j); endactionschema
    """
    )
    planner = Planner(read_domain(text), goal="Read", relax="none", verify=False)
    settle(planner)
    assert planner.goals == ("Read", "Keep")
    assert "Look : SUCCEED" in texts(planner)["Read"]


# ------------------------------------------------------------------------------------------- texts and models


def test_a_definition_is_written_out_with_its_ports_and_with_names_of_its_own() -> None:
    inliner = Inliner()
    text = "LOOK[p] = IN[s1]<v> :; OUT[p, v]"
    assert show(inliner.process(text, (Symbol("a"),))) == "IN[s1]<v1> :; OUT[a, v1]"
    assert show(inliner.process(text, (Symbol("b"),))) == "IN[s1]<v2> :; OUT[b, v2]"


def test_an_action_that_calls_itself_is_refused() -> None:
    with pytest.raises(InputError, match="does not call itself"):
        definition("A[p] = IN[p]<v> : A[p]")


def test_an_assumption_about_a_condition_that_no_model_has_is_refused() -> None:
    given = {**TIMING, **MEASURES}
    tem = Model(text=model("tracking"), environment="TEM", signatures=host.signatures, given=given, assuming={"q": "A"})
    with pytest.raises(InputError, match="TEM has no condition or action q"):
        exploiting(wanted("tracking"), [tem])


def test_timing_that_is_left_open_is_told() -> None:
    tem = Model(text=model("tracking"), environment="TEM", signatures=host.signatures)
    with pytest.raises(InputError, match="the timing of"):
        exploiting(wanted("tracking"), [tem])
