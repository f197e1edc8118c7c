"""Conditions that hold during an action, and actions that need each other."""

from __future__ import annotations

from planner_reactor.logic.allen import ALL, NAMED, relations
from planner_reactor.logic.network import Network
from planner_reactor.logic.reader import read_domain
from planner_reactor.logic.together import at_once, held_through, may_overlap, must_overlap, mutual

SERVOING = """
atp_goal G Got(part);
atp_actionschema Track <x><> intervals i1;
    executability: Seen(x) @ i1 and ITL(i1, [m o si e di fi], Track);
    effects: Pose(x) @ Track;
endactionschema
atp_actionschema Get <x><> intervals i1, i2;
    executability: Pose(x) @ i1 and ITL(i1, encompasses, Get);
    effects: Got(x) @ i2 and ITL(Get, meets, i2);
endactionschema
atp_fact Seen(part);
"""


def test_a_condition_during_an_action_makes_its_producer_run_as_long() -> None:
    domain = read_domain(SERVOING)
    (pose,) = domain.schemas["Track"].effects
    (needed,) = domain.schemas["Get"].executability
    assert held_through(pose.relation, needed.relation) == relations(["si", "e", "di", "fi"])
    network = Network()
    network.constrain("Track", "Get", held_through(pose.relation, needed.relation))
    assert must_overlap(network, "Track", "Get")


def test_what_lasts_after_its_action_lets_the_user_come_later() -> None:
    assert held_through(NAMED["meets"], relations(["m", "o", "si", "e", "di", "fi"])) == relations(["b", "m"])


def test_actions_that_live_on_each_other_begin_and_end_together() -> None:
    own = NAMED["equal"]
    assert mutual(own, own) == NAMED["equal"]
    assert mutual(own, own, relations(["o", "oi", "d", "di", "s", "si", "f", "fi", "e"])) == ALL & ~NAMED["disjunct"]
    assert mutual(NAMED["meets"], NAMED["meets"], relations(["b", "m"])) == 0


def test_groups_are_what_cannot_be_done_one_after_the_other() -> None:
    network = Network()
    network.constrain("Track", "Get", NAMED["encompasses"])
    network.constrain("Get", "Put", relations(["b", "m"]))
    network.constrain("Light", "Track", relations(["di"]))
    network.constrain("Put", "Sing", ALL & ~NAMED["before"])
    assert at_once(network) == [("Track", "Get", "Light"), ("Put",), ("Sing",)]
    assert may_overlap(network, "Put", "Sing")
    assert not must_overlap(network, "Put", "Sing")
    assert not may_overlap(network, "Get", "Put")
