"""Limit sets are found from texts: those of the papers, and rightly different ones for texts that differ."""

from __future__ import annotations

import pytest

from planner_reactor.workcell.environments.dynamics import model
from tests.analysis.models import limits, pairs, read, shipped

TEM = {
    ("-eps <= g <= eps", "TEM[p + g, a]"),
    ("IN[angle]<na>", "TEM[p, na]"),
    ("InView[p, a]", "TEM[p, a] | ReportPos[p]"),
}
GEM = {
    ("-eps <= g <= eps", "GEM[p + g, a, pr]"),
    ("IN[angle]<na>", "GEM[p, na, pr]"),
    ("InView[p, a]", "GEM[p, a, pr] | ReportPos[p]"),
    ("IN[rc]<d>", "GEM[p, a, pr + d]"),
    ("p - pr == 0", "GEM[p, a, pr] | ReportTact[1]"),
}
OBJECT_GONE = ("p >= nu", "Camera[a] | Robot[pr] | Tactile | Dist")
BEM = {(c, t.replace("GEM", "BEM")) for c, t in GEM if "eps" not in c} | {("p < nu", "BEM[p + mu, a, pr]")}


def test_equation_8_the_limit_set_of_the_tracking_environment() -> None:
    assert pairs(limits(shipped("tracking"))) == TEM


def test_equation_12_the_limit_set_of_the_guarded_move_environment() -> None:
    assert pairs(limits(shipped("guarded_move"))) == GEM


def test_equation_15_the_limit_set_of_the_belt_environment_with_the_entry_that_the_paper_omits() -> None:
    assert len(BEM) == 5
    assert pairs(limits(shipped("belt"))) == BEM | {OBJECT_GONE}


@pytest.mark.parametrize(("name", "most"), [("tracking", 10), ("guarded_move", 70), ("belt", 70)])
def test_few_states_are_looked_at(name: str, most: int) -> None:
    """In place of a clock: `benchmarks/bench_limits.py` shows the times, each below 100 ms."""
    assert limits(shipped(name)).states <= most


def test_without_sensors_nothing_is_said_of_the_camera() -> None:
    found = pairs(limits(shipped("tracking"), sensors=()))
    assert found == {entry for entry in TEM if "ReportPos" not in entry[1]}


def test_renamed_ports_are_found_under_their_new_names() -> None:
    source = model("tracking").replace("angle", "pan").replace("op", "where")
    assert ("IN[pan]<na>", "TEM[p, na]") in pairs(limits(read(source, "TEM[p, a]")))


def test_a_port_that_somebody_writes_is_no_port_of_the_world_outside() -> None:
    source = model("tracking") + "Steered[p, a, b] = TEM[p, a] | STREAM[angle, b]\n"
    found = pairs(limits(read(source, "Steered[p, a, b]")))
    assert ("true", "Steered[p, b, b]") in found
    assert not any("IN[angle]" in condition for condition, _ in found)


def test_a_camera_that_reads_another_port_than_the_object_writes_sees_nothing() -> None:
    source = model("tracking").replace("IN[op]<p> ; Delay[ts1]", "IN[nowhere]<p> ; Delay[ts1]")
    found = pairs(limits(read(source, "TEM[p, a]")))
    assert ("InView[p, a]", "TEM[p, a] | ReportPos[p]") not in found
    assert ("IN[nowhere]<p2> and InView[p2, a]", "TEM[p, a] | ReportPos[p2]") in found


SECOND_CAMERA = """
TwoEyes[p, a, b] = Object[p] | Eye[a, angle1, pos1] | Eye[b, angle2, pos2]
Eye[a, angle, pos] = (Look[a, pos] # IN[angle]<na>) : Eye[na, angle, pos]
Look[a, pos] = (Delay[ts0] ; IN[op]<p> ; Delay[ts1]) :: (InView[p, a] : ReportAt[p, pos])
ReportAt[p, pos] = STREAM[pos, p] # Delay[ts0]
"""


def test_a_second_camera_has_limits_of_its_own() -> None:
    found = limits(read(model("tracking") + SECOND_CAMERA, "TwoEyes[p, a, b]"), sensors=("ReportAt",))
    assert pairs(found) == {
        ("-eps <= g <= eps", "TwoEyes[p + g, a, b]"),
        ("IN[angle1]<na>", "TwoEyes[p, na, b]"),
        ("InView[p, a]", "TwoEyes[p, a, b] | ReportAt[p, pos1]"),
        ("IN[angle2]<na>", "TwoEyes[p, a, na]"),
        ("InView[p, b]", "TwoEyes[p, a, b] | ReportAt[p, pos2]"),
    }


def test_an_object_that_moves_before_the_camera_looks_is_never_seen_where_it_was() -> None:
    """Delays that are known are taken exactly."""
    assert pairs(limits(shipped("tracking", {"t0": 1, "ts0": 2, "ts1": 0.1}))) == {
        ("-eps <= g <= eps", "TEM[p + g, a]"),
        ("IN[angle]<na>", "TEM[p, na]"),
    }


def test_an_object_that_waits_longer_than_the_camera_moves_only_unseen() -> None:
    assert pairs(limits(shipped("tracking", {"t0": 1, "ts0": 0.3, "ts1": 0.1}))) == {
        ("~InView[p, a] and -eps <= g <= eps", "TEM[p + g, a]"),
        ("IN[angle]<na>", "TEM[p, na]"),
        ("InView[p, a]", "TEM[p, a] | ReportPos[p]"),
    }


def test_known_numbers_decide_guards() -> None:
    before, beyond = (shipped("belt", {"p": p, "nu": 3, "mu": 1}) for p in (2, 3))
    assert ("true", "BEM[3, a, pr]") in pairs(limits(before))
    assert OBJECT_GONE[1] not in {term for _, term in pairs(limits(before))}
    assert ("true", OBJECT_GONE[1]) in pairs(limits(beyond))


def test_two_equal_components_are_told_apart() -> None:
    found = pairs(limits(read(model("tracking"), "Object[p] | Object[p]")))
    assert found == {
        ("-eps <= g <= eps", "Object[p + g] | Object[p]"),
        ("-eps <= g <= eps", "Object[p] | Object[p + g]"),
    }


def test_a_recursion_with_the_arguments_that_it_had_is_no_limit() -> None:
    source = "Light[s] = Delay[t0] : (IN[press]<n> : GTR[n, 0] ; Light[s])\n"
    found = limits(read(source, "Light[p]"))
    assert found.complete
    assert found.limits == ()


def test_a_network_in_which_nothing_can_happen_any_more_is_a_limit() -> None:
    found = limits(read("Wedged = (IN[a1]<x> : OUT[b1, x]) | (IN[b1]<y> : OUT[a1, y])\n", "Wedged"))
    assert [entry.kind for entry in found.limits] == ["stuck"]


def test_a_budget_that_runs_out_is_said() -> None:
    found = limits(shipped("guarded_move"), limit=5)
    assert not found.complete
