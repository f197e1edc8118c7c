"""What a derivation that was tried left unsolved: each with what goes wrong otherwise, and that it does not.

Failure while holding, and "finishes time": here. Start facts that a retry spoils: `test_altered_domains`. A failed test
that is tried for ever: `test_refinement`. Resources: `test_sharing`. Orders that are not series-parallel:
`test_structure`. Every reactor of the 2⁹ sets in the cell: `experiments/test_ideal_reactors`.
"""

from __future__ import annotations

from pathlib import Path

import pytest

from planner_reactor.calls.looping import loop as run
from planner_reactor.experiments.loop import Loop
from planner_reactor.logic.reader import read_domain
from planner_reactor.planner import Planner
from planner_reactor.trace import Event
from planner_reactor.workcell.host import host
from tests.planner.driving import TENDING, kitting, settle, texts


@pytest.mark.parametrize("cleans", [False, True])
def test_whoever_fails_while_holding_something_puts_it_down_first(tmp_path: Path, *, cleans: bool) -> None:
    """A door stays shut, and the arm has a blank in its gripper. Without a cleanup it has it for ever."""
    text = TENDING.read_text()
    if not cleans:
        head, rest = text.split("// What a reaction does when it fails")
        text = head + rest[rest.index("// ---- basic actions: sensing") :]
    (tmp_path / "tending.itl").write_text(text)
    (tmp_path / "faults.toml").write_text('[[fault]]\nat = 1\nkind = "door_sticks"\nmachine = "lathe"\n')
    found = run(
        tmp_path / "tending.itl", host=str(TENDING.with_suffix(".py")), until=400.0, relax="DOORS",
        faults=tmp_path / "faults.toml",
    )  # fmt: skip
    assert found["bumps"] >= 1
    assert (found["pieces"]["stored"] > 0) == cleans
    assert (found["pieces"]["gripper"] == 1) >= (not cleans)


DOOR = """
atp_goal Safe forall i1: Room(room) @ i1 => Exists i2: Checked(room) @ i2 and Locked(door) @ i2 TIME;
atp_rule forall d, i, j: Locked(d) @ i and Unlocked(d) @ j => ITL(i, disjunct, j);
atp_fact Room(room);
atp_actionschema Unlock <d><>
    effects: Unlocked(d);
endactionschema
atp_actionschema Check <r><>
    executability: Unlocked(door);
    effects: Checked(r);
endactionschema
atp_actionschema Lock <d><>
    effects: Locked(d);
endactionschema
"""


def test_what_finishes_time_and_is_ended_again_is_told() -> None:
    """It is right when it is reached, and wrong again as soon as the goal is pursued once more."""
    forever = Planner(read_domain(DOOR.replace("TIME", "and ITL(i2, finishes, time)")), relax="none")
    once = Planner(read_domain(DOOR.replace("TIME", "")), relax="none")
    settle(forever), settle(once)
    assert texts(forever)["Safe"] == texts(once)["Safe"]
    assert "(~(Unlock[door] : Check[room] : Lock[door] : SUCCEED" in texts(forever)["Safe"]
    assert forever.warnings == (
        "Locked(door) in Safe is to hold to the end of time, and Unlock ends it whenever the goal is pursued again",
    )
    assert once.warnings == ()


def test_what_finishes_time_for_a_new_thing_each_time_is_not_ended_by_the_next() -> None:
    planner = Planner(kitting(), relax="none")
    settle(planner)
    assert not [warning for warning in planner.warnings if "end of time" in warning]


def test_three_instances_of_one_situation_are_alive_at_once_in_the_cell() -> None:
    """R §5.1: `Lacks` is asserted three times, with other parameters, and served side by side."""
    planner = Planner(kitting(), fold=False, relax="none")
    made = Loop(planner, lambda scheduler, trace: host(scheduler, trace=trace, target=2), seed=1)
    living: set[int] = set()
    most = 0

    def look(event: Event) -> None:
        nonlocal most
        if event.kind in ("entered", "left") and event.data["situation"] == "Lacks":
            (living.add if event.kind == "entered" else living.discard)(event.data["instance"])
            most = max(most, len(living))

    made.trace.sinks.append(look)
    made.run(until=300.0)
    assert most == 3
    assert made.host.world is not None
    assert made.host.world.report()["kits"] == {"completed": 2, "rejected": 0}
    assert made.reactor.laws.violations == []
    assert made.reactor.laws.interruptions == 0
    assert planner.ideal
