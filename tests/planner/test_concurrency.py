"""What nothing orders goes on at the same time, and what all need is done once."""

from __future__ import annotations

import pytest

from planner_reactor.logic.domain import Domain
from planner_reactor.logic.reader import read_domain
from planner_reactor.planner import Planner
from tests.planner.driving import TENDING, Book, planner_without, settle, texts

TASK = """
atp_assumption AQ() likelihood 0.1 monitor reaction;
atp_goal Kit forall t: Tray(t) => Finished(t);
atp_fact Tray(t0) and Free(arm);
atp_rule forall x, i, j: Held(x) @ i and Free(arm) @ j => ITL(i, disjunct, j);
atp_rule forall x, i, j: AQ() @ j => Good(x) @ i;
atp_rule forall t, NAMES, i: PARTS => Full(t) @ i;

atp_actionschema FindTray <t><>  senses
    effects: Located(t);
endactionschema
atp_actionschema PlaceTray <t><>
    executability: Located(t); Free(arm);
    effects: Ready(t);
endactionschema
atp_actionschema Fill <k, t><>
intervals i1, i2, i3;
    executability: Ready(t) @ i1 and ITL(i1, encompasses, Fill); Free(arm);
    effects: Exists x: Instance(k, x) @ i2 and In(t, x) @ i2 and ITL(Fill, meets, i2);
    expansions: Exists x: Instance(k, x) @ i1 and Good(x) @ i1 and In(t, x) @ i2 and Free(arm) @ i3;
endactionschema
atp_actionschema Find <k><x>
    effects: Instance(k, x) and Seen(x);
endactionschema
atp_actionschema Pick <x><>
    executability: Seen(x); Free(arm); Good(x);
    effects: Held(x);
endactionschema
atp_actionschema Insert <x, t><>
intervals i1, i2, i3;
    executability: Held(x) @ i1 and ITL(i1, [m o si e di fi], Insert); Ready(t);
    effects: In(t, x) @ i3 and Free(arm) @ i3 and ITL(Insert, meets, i3);
endactionschema
atp_actionschema Finish <t><>
    executability: Full(t);
    effects: Finished(t);
endactionschema
"""


def task(kinds: int) -> Domain:
    names = ", ".join(f"x{n}" for n in range(kinds))
    parts = " and ".join(f"Instance(k{n}, x{n}) @ i and In(t, x{n}) @ i" for n in range(kinds))
    return read_domain(TASK.replace("NAMES", names).replace("PARTS", parts))


@pytest.mark.parametrize("kinds", [2, 7, 40])
def test_what_all_need_is_done_once_and_the_rest_goes_on_side_by_side(kinds: int) -> None:
    domain = task(kinds)
    planner = Planner(domain, relax="none")
    settle(planner, Book(domain, loads=kinds < 10))
    calls = " & ".join(f"REASSERT[FillK{n}T0]" for n in range(kinds))
    assert f"(~(FindTray[t0] : PlaceTray[t0] : ({calls}) : Finish[t0] : SUCCEED" in texts(planner)["Kit"]


def test_a_part_of_one_kind_is_looked_for_while_another_is_placed() -> None:
    """Each kind has a reaction of its own that holds the arm for as little as it can."""
    planner = Planner(task(3), relax="none")
    settle(planner)
    assert "Find[k1]<x1> : Pick[x1] : Insert[x1, t0] : SUCCEED" in texts(planner)["FillK1T0"]


SHARED = """
atp_resource arm;
atp_resource bench capacity 2;
atp_goal All Done(a) and Done(b) and Done(c) and Seen(a);
atp_fact Thing(a);
atp_actionschema Work <x><>
    uses: USES;
    effects: Done(x);
endactionschema
atp_actionschema Look <x><>
    effects: Seen(x);
endactionschema
"""


@pytest.mark.parametrize(
    ("uses", "expected"),
    [
        ("arm", "(Work[a] : Work[b] : Work[c] & Look[a])"),
        ("bench", "(Work[a] : Work[c] & Work[b] & Look[a])"),
        ("bench 2", "(Work[a] : Work[b] : Work[c] & Look[a])"),
    ],
)
def test_what_needs_the_same_resource_takes_turns_and_the_rest_does_not(uses: str, expected: str) -> None:
    domain = read_domain(SHARED.replace("USES", uses))
    planner = Planner(domain, relax="none")
    settle(planner, Book(domain))
    assert f"(~({expected} : SUCCEED" in texts(planner)["All"]


def test_without_a_resource_nothing_takes_turns() -> None:
    domain = read_domain(SHARED.replace("    uses: USES;\n", ""))
    planner = Planner(domain, relax="none")
    settle(planner, Book(domain))
    assert "(~((Work[a] & Work[b] & Work[c] & Look[a]) : SUCCEED" in texts(planner)["All"]


def test_goals_that_have_nothing_in_common_are_planned_apart() -> None:
    """Together they were too much for the search: each choice for one was tried with every choice for the others."""
    domain = read_domain(TENDING.read_text())
    planner = planner_without(domain, ["SHARP"], verify=False)
    settle(planner, Book(domain))
    assert planner.ideal, planner.impossible
    assert "(Gauge[lathe, x1] & REASSERT[UnloadMill]<x2>) : (Store[x1] & Gauge[mill, x2])" in texts(planner)["Tending"]
