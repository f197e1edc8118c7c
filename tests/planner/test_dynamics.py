"""Actions follow from the model of an environment: those of the paper from the paper's models, others from others."""

from __future__ import annotations

import pytest

from planner_reactor.analysis.conditions import text
from planner_reactor.errors import InputError
from planner_reactor.logic.allen import NAMED, relations
from planner_reactor.logic.formulas import Atom
from planner_reactor.planner.dynamics import derive, schemas
from planner_reactor.rs.checks import check
from planner_reactor.rs.parser import parse_process, parse_program
from planner_reactor.workcell.environments.dynamics import host
from tests.planner.environments import BACKWARDS, BEM, GEM, TEM, TWO_AXES, TWO_CAMERAS, action, derived, names

CAMERA_55 = """
atp_actionschema camera-55 Input: [m1] Output: []
Intervals: [int-camera-55, int-54]
Executability:
objectposition(m1) @ int-54 and ITL(int-54, [si,e,di,fi], int-camera-55)
Effects:
cameraposition(m1) @ int-camera-55 and objectinview(m1) @ int-camera-55
endactionschema camera-55
"""
REPORTPOS_57 = """
atp_actionschema reportpos-57 Input: [] Output: [s1]
Intervals: [int-reportpos-57, int-56]
Executability:
objectinview(op) @ int-56 and ITL(int-56, [si,e,di,fi], int-reportpos-57)
Effects:
objectposition(s1) @ int-reportpos-57
endactionschema reportpos-57
"""
"""X §6.3, word for word; `Effects:` stands before the last but one line of the second in the other schema only."""


def test_the_schemas_of_the_tracking_environment_are_printed_as_in_the_paper() -> None:
    printed = [a.printed.split() for a in derived(TEM, "TEM").actions]
    assert printed == [CAMERA_55.split(), REPORTPOS_57.split()]


def test_look_and_movecamera_are_those_of_section_4_2() -> None:
    """One output port with the position, while the object is in view; one input port with it, and it is in view."""
    found = derived(TEM, "TEM")
    assert names(found) == ["MOVECAMERA", "LOOK"]
    encompasses, equal = relations(["si", "e", "di", "fi"]), NAMED["equal"]
    look = action(found, "LOOK").schema
    assert (look.variables, look.inputs, look.outputs) == (("outport",), (), (0,))
    assert [(c.atom, c.relation) for c in look.executability] == [(Atom("InView", ("Object",)), encompasses)]
    assert [(e.atom, e.relation) for e in look.effects] == [(Atom("ObjectPosition", (0,)), equal)]
    move = action(found, "MOVECAMERA").schema
    assert (move.variables, move.inputs, move.outputs) == (("inport",), (0,), ())
    assert [(c.atom, c.relation) for c in move.executability] == [(Atom("ObjectPosition", (0,)), encompasses)]
    assert Atom("InView", ("Object",)) in [e.atom for e in move.effects]


def test_the_objects_own_motion_is_rejected_as_in_the_paper() -> None:
    (rejected,) = derived(TEM, "TEM").rejected
    assert rejected.term == "TEM[p + g, a]"
    assert "neither senses nor affects it" in rejected.why


def test_the_guarded_move_environment_gives_up_down_towards_away_and_contact() -> None:
    found = derived(GEM, "GEM")
    assert names(found) == [
        "MOVECAMERA", "LOOK", "MOVEUP", "MOVEDOWN", "MOVETOWARDS", "MOVEAWAY", "CONTACT",
    ]  # fmt: skip
    assert [r.why for r in found.rejected] == ["p may change either way"]
    towards = action(found, "MOVETOWARDS")
    assert towards.schema.effects[0].atom == Atom("Approaching", ("Object",))
    assert towards.ports == ("r",)
    contact = action(found, "CONTACT").schema
    assert [(e.atom, e.relation) for e in contact.effects] == [(Atom("Contact", ("Object",)), NAMED["meets"])]


def test_the_belt_environment_gives_one_more_waitforobject() -> None:
    found = derived(BEM, "BEM")
    assert set(names(found)) == {*names(derived(GEM, "GEM")), "WAITFOROBJECT"}
    wait = action(found, "WAITFOROBJECT")
    assert [f.holds for f in wait.needed] == ["p < nu", "p < pr"]
    assert (wait.rs_text, wait.presumes) == ("WAITFOROBJECT = NIL", ("mu > 0",))


def test_towards_sends_what_the_distance_lacks_and_away_its_opposite() -> None:
    found = derived(GEM, "GEM")
    assert "OUT[r, v - q] : OUT[at, v]" in action(found, "MOVETOWARDS").rs_text
    assert "OUT[r, q - v] : OUT[at, 2 * q - v]" in action(found, "MOVEAWAY").rs_text


def test_a_robot_that_senses_itself_needs_no_dead_reckoning() -> None:
    found = derived(GEM + "joint = (IN[rp]<v> ; Delay[gj]) :; (STREAM[j, v] # Delay[tj])\n", "GEM")
    assert action(found, "MOVETOWARDS").rs_text == (
        "MOVETOWARDS[inport] = (IN[j]<q1> : IN[inport]<v>) :; OUT[r, v - q1]"
    )
    assert action(found, "READROBOT").schema.executability == ()


# ------------------------------------------------------------------------------------ another text, another answer


def test_renamed_ports_are_named_in_the_schemas() -> None:
    found = derived(TEM.replace("angle", "pan").replace("m1", "steer").replace("s1", "seen"), "TEM")
    assert (action(found, "MOVECAMERA").ports, action(found, "LOOK").ports) == (("steer",), ("seen",))
    assert "Input: [steer]" in action(found, "MOVECAMERA").printed
    assert action(found, "LOOK").rs_text == "LOOK[outport] = IN[seen]<v> :; OUT[outport, v]"


def test_renamed_definitions_rename_what_is_said_of_them() -> None:
    found = derived(TEM.replace("Camera", "Turret").replace("Object", "Fly"), "TEM")
    assert names(found) == ["MOVETURRET", "LOOK"]
    assert action(found, "LOOK").schema.effects[0].atom == Atom("FlyPosition", (0,))


def test_another_delay_is_another_timing() -> None:
    slower = derived(TEM.replace("IN[op]<p> ; Delay[ts1]", "IN[op]<p> ; Delay[ts1] ; Delay[blur]"), "TEM")
    assert repr(action(slower, "LOOK").delay) == "blur + gl + ts1"
    numbers = derived(TEM, "TEM", t0=1, ts0=0.1, ts1=0.05, gl=0.01, tl=0.02, gm=0.03, tm=0.04)
    look, move = action(numbers, "LOOK"), action(numbers, "MOVECAMERA")
    assert (round(look.delay, 9), look.resolution) == (0.06, 1)
    assert (move.delay, move.resolution) == (0.03, 0.04)


def test_delays_that_are_known_may_leave_nothing_to_see() -> None:
    """An object that moves before the camera ever looks: exact time decides, not the form."""
    found = derived(TEM, "TEM", t0=1, ts0=2, ts1=0.1)
    assert names(found) == ["MOVECAMERA"]
    assert action(found, "MOVECAMERA").schema.executability == ()


def test_a_second_camera_is_told_from_the_first() -> None:
    found = derived(TWO_CAMERAS, "TwoEyes")
    assert names(found) == ["MOVEEYE_m1", "LOOK_s1", "MOVEEYE_m2", "LOOK_s2"]
    (sees,) = action(found, "LOOK_s2").schema.executability
    shows = [e.atom for e in action(found, "MOVEEYE_m2").schema.effects]
    assert sees.atom == Atom("InView", ("p", "b"))
    assert sees.atom in shows
    assert sees.atom not in [e.atom for e in action(found, "MOVEEYE_m1").schema.effects]


def test_a_camera_with_two_axes_needs_both_positions() -> None:
    found = derived(TWO_AXES, "TEM2")
    move = action(found, "MOVECAMERA")
    assert (move.inputs, move.ports) == (("inport1", "inport2"), ("mp", "mt"))
    assert [c.atom for c in move.schema.executability] == [Atom("ObjectXPosition", (0,)), Atom("ObjectYPosition", (1,))]
    assert {Atom("InView", ("x", "a")), Atom("InView", ("y", "b"))} <= {e.atom for e in move.schema.effects}
    assert move.rs_text.endswith(":; (OUT[mp, v1] & OUT[mt, v2])")
    assert [a.schema.effects[0].atom.predicate for a in found.actions[1:]] == ["ObjectXPosition", "ObjectYPosition"]


def test_a_belt_that_runs_backwards_brings_what_lies_beyond_the_robot() -> None:
    by_text = action(derived(BACKWARDS, "BEM"), "WAITFOROBJECT")
    assert [f.holds for f in by_text.needed] == ["p > nu", "p > pr"]
    by_number = action(derived(BEM, "BEM", mu=-0.5), "WAITFOROBJECT")
    assert [f.holds for f in by_number.needed] == ["p < nu", "p > pr"]
    assert by_number.presumes == ()


def test_a_belt_that_stands_brings_nothing() -> None:
    assert "WAITFOROBJECT" not in names(derived(BEM, "BEM", mu=0))


def test_a_belt_that_jerks_brings_it_if_it_never_goes_back() -> None:
    jerking = BEM.replace("BeltObject[p + mu]", "Ran[least, most]<g> : BeltObject[p + g]")
    assert "WAITFOROBJECT" in names(derived(jerking, "BEM", least=0.1, most=0.4))
    assert "WAITFOROBJECT" not in names(derived(jerking, "BEM", least=-0.1, most=0.4))


def test_a_camera_that_turns_by_steps_is_sent_the_difference() -> None:
    found = derived(TEM.replace("Camera[na]", "Camera[a + na]"), "TEM")
    move = action(found, "MOVECAMERA")
    assert "OUT[m1, v - q] : OUT[at, v]" in move.rs_text
    assert Atom("InView", ("Object",)) in [e.atom for e in move.schema.effects]


def test_a_camera_that_looks_the_other_way_is_sent_the_opposite() -> None:
    found = derived(TEM.replace("Camera[na]", "Camera[0 - na]"), "TEM")
    assert action(found, "MOVECAMERA").rs_text == "MOVECAMERA[inport] = IN[inport]<v> :; OUT[m1, -v]"


def test_a_motor_that_acts_once_makes_no_action() -> None:
    once = TEM.replace("motor1 = (IN[m1]<v> ; Delay[gm]) :; (STREAM[angle, v] # Delay[tm])",
                       "motor1 = IN[m1]<v> : Delay[gm] : OUT[angle, v]")  # fmt: skip
    found = derived(once, "TEM")
    assert names(found) == ["LOOK"]
    assert any("angle is not dense: motor1" in r.why for r in found.rejected)


def test_a_test_of_which_nothing_is_known_assures_nothing() -> None:
    unknown = {**host.signatures}
    from dataclasses import replace

    unknown["InView"] = replace(unknown["InView"], means="")
    found = derive(parse_program(TEM), "TEM", signatures=unknown)
    assert [e.atom.predicate for e in action(found, "MOVECAMERA").schema.effects] == ["CameraPosition"]


def test_a_test_that_the_text_defines_says_what_it_means() -> None:
    found = derive(parse_program(TEM + "InView[p, a] = LST[p - a, w] : LST[a - p, w]\n"), "TEM")
    assert names(found) == ["MOVECAMERA", "LOOK"]
    assert action(found, "MOVECAMERA").schema.executability[0].atom == Atom("ObjectPosition", (0,))
    assert any(text(limit.condition) == "-w < -a + p < w" or "w" in text(limit.condition) for limit in found.limits)


# ------------------------------------------------------------------------------------------------------- the rest


@pytest.mark.parametrize(("source", "process"), [(TEM, "TEM"), (GEM, "GEM"), (BEM, "BEM"), (TWO_AXES, "TEM2")])
def test_every_definition_in_rs_loads_and_calls_nothing_but_built_in_processes(source: str, process: str) -> None:
    for a in derived(source, process, pr=0).actions:
        program = parse_program(a.rs_text + "\n")
        assert [f for f in check(program) if f.severity == "error"] == [], a.rs_text
        assert program.schemas[0].results == ()
        assert a.schema.process == a.rs_text


def test_the_subnet_of_a_goal_is_all_that_is_looked_at() -> None:
    found = derive(parse_program(GEM), "GEM", signatures=host.signatures, goal=("s1",))
    assert names(found) == ["MOVECAMERA", "LOOK"]
    assert {c.process.name for c in found.interface} == {"sense1", "motor1"}


def test_an_interface_that_is_named_is_all_there_is() -> None:
    found = schemas(parse_program(GEM), "GEM", ("sense1", "motor1"), signatures=host.signatures)
    assert [a.name for a in found] == ["MOVECAMERA", "LOOK"]


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        ({"environment": "TEMM"}, r"no process TEMM, did you mean TEM\?"),
        ({"environment": "TEM", "interface_processes": ["sens1"]}, r"no process sens1 .* did you mean sense1\?"),
        ({"environment": "TEM", "interface_processes": ["Monitor[1]"]}, "Monitor connects no port"),
        ({"environment": "TEM", "goal": ["s2"]}, "no port s2 of the interface, there are: m1, s1"),
    ],
)
def test_wrong_names_are_refused_with_the_nearest(arguments: dict[str, object], said: str) -> None:
    with pytest.raises(InputError, match=said):
        derive(parse_program(TEM), signatures=host.signatures, **arguments)  # type: ignore[arg-type]


def test_a_process_may_be_given_with_its_arguments() -> None:
    assert names(derive(parse_program(TEM), parse_process("TEM[p, a]"), signatures=host.signatures)) == [
        "MOVECAMERA", "LOOK",
    ]  # fmt: skip


def test_where_the_world_stands_now_makes_no_difference() -> None:
    by_name, by_number = derived(BEM, "BEM"), derived(BEM, "BEM[0.0, 1, 7]")
    assert [a.printed for a in by_name.actions] == [a.printed for a in by_number.actions]
    fixed = TEM.replace("TEM[p, a] = Object[p] | Camera[a]", "TEM = Object[3] | Camera[0]")
    assert names(derived(fixed, "TEM")) == ["MOVECAMERA", "LOOK"]


def test_a_tank_and_its_valve() -> None:
    """A domain nobody here has seen: the level is told under no condition, the valve is set, the leak drifts."""
    found = derived(
        "Tank[l, v] = Water[l] | Valve[v]\n"
        "Water[l] = (STREAM[level, l] # Delay[t0]) ; (IN[flow]<f> : Water[l + f - leak])\n"
        "Valve[v] = (STREAM[flow, v] # IN[set]<nv>) : Valve[nv]\n"
        "gauge = (IN[level]<v> ; Delay[gl]) :; (STREAM[reading, v] # Delay[tl])\n"
        "handle = (IN[turn]<v> ; Delay[gm]) :; (STREAM[set, v] # Delay[tm])\n",
        "Tank",
    )
    assert names(found) == ["MOVEVALVE", "READWATER"]
    assert action(found, "READWATER").schema.executability == ()
    assert action(found, "READWATER").schema.effects[0].atom == Atom("WaterPosition", (0,))


def test_two_objects_at_one_port_are_refused_with_the_rule() -> None:
    """X §4.2: only one process may transmit to a port. Whose position would LOOK tell?"""
    found = derived(TEM.replace("TEM[p, a] = Object[p]", "TEM[p, q, a] = Object[p] | Object[q]"), "TEM")
    assert "LOOK" not in names(found)
    assert any("Object, Object all write it, expected one writer" in r.why for r in found.rejected)


# ------------------------------------------------------------------------------------------------- wrong as printed


def test_14_as_printed_becomes_an_object_that_moves_at_random_after_one_step() -> None:
    """`BeltObject = … : Object[p + mu]`: nothing is carried to the robot, so nothing is worth waiting for."""
    printed = BEM.replace("BeltObject[p + mu])", "Object[p + mu])") + (
        "Object[p] = (STREAM[op, p] # Delay[t0]) ; (Ran[-eps, eps]<g> : Object[p + g])\n"
    )
    assert "WAITFOROBJECT" in names(derived(BEM, "BEM"))
    assert "WAITFOROBJECT" not in names(derived(printed, "BEM"))


def test_moveaway_as_printed_would_move_towards() -> None:
    """X §5.2 sends p − pr for both; what leads away is its opposite."""
    found = derived(GEM, "GEM")
    robot, thing = 2.0, 5.0
    sent = thing - robot
    assert abs(thing - (robot + sent)) < abs(thing - robot) < abs(thing - (robot - sent))
    assert "OUT[r, v - q]" in action(found, "MOVETOWARDS").rs_text
    assert "OUT[r, q - v]" in action(found, "MOVEAWAY").rs_text


def test_waiting_as_printed_would_wait_for_what_has_passed() -> None:
    """X §5.3 asks for p < ν alone; beyond the robot the distance grows with every step."""
    wait = action(derived(BEM, "BEM", mu=0.5, nu=10), "WAITFOROBJECT")
    assert [f.holds for f in wait.needed] == ["p < 10", "p < pr"]
    assert abs(6.0 + 0.5 - 4.0) > abs(6.0 - 4.0)  # p = 6 < ν, pr = 4
