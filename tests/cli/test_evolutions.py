"""`evolve` and `limits`: what they print, and what they refuse."""

from __future__ import annotations

from importlib.resources import files

import pytest

from tests.cli.conftest import Call

MODELS = files("planner_reactor.workcell.environments")
TRACKING = str(MODELS / "tracking.rsl")
HOST = ("--host", "planner_reactor.workcell.environments.dynamics")


def test_evolve_gives_steps_with_their_conditions(call: Call) -> None:
    found = call("evolve", TRACKING, "Object[p]", *HOST, "--json").object
    assert found["complete"] is True
    assert found["steps"][0]["condition"] == "OUT[op, p]"
    assert {"condition": "Delay[t0]", "term": "Ran[-eps, eps]<g> : Object[p + g]"} in found["steps"]


def test_evolve_finds_all_that_a_process_can_come_to(call: Call) -> None:
    found = call("evolve", TRACKING, "InView[p, a]", *HOST, "--all", "--json").object
    assert [s["term"] for s in found["steps"]] == ["InView[p, a]", "STOP", "ABORT"]
    cut = call("evolve", TRACKING, "Object[p]", *HOST, "--all", "--limit", "5")
    assert (cut.status, "there is more" in cut.err) == (0, True)


def test_limits_gives_the_limit_set(call: Call) -> None:
    found = call("limits", TRACKING, "TEM[p, a]", "--sensors", "ReportPos", *HOST, "--json").object
    assert found["complete"] is True
    assert {(e["condition"], e["term"], e["kind"], e["component"]) for e in found["limits"]} == {
        ("-eps <= g <= eps", "TEM[p + g, a]", "recursion", "Object[p]"),
        ("IN[angle]<na>", "TEM[p, na]", "recursion", "Camera[a]"),
        ("InView[p, a]", "TEM[p, a] | ReportPos[p]", "bound", "Camera[a]"),
    }


def test_limits_for_people(call: Call) -> None:
    shown = call("limits", TRACKING, "TEM[p, a]", "--sensors", "ReportPos", *HOST).out.splitlines()
    assert shown[1] == "IN[angle]<na>     ->  TEM[p, na]"


def test_open_names_may_be_given_and_ports_closed(call: Call) -> None:
    limits = ("limits", TRACKING, "TEM[p, a]", "--sensors", "ReportPos", *HOST, "--json")
    given = call(*limits, "--set", "eps=0.5", "--set", "p=1").object
    assert given["limits"][0] == {
        "condition": "-0.5 <= g <= 0.5", "term": "TEM[g + 1, a]", "kind": "recursion", "component": "Object[1]",
    }  # fmt: skip
    closed = call(*limits, "--ports", "").object
    assert not any("IN" in entry["condition"] for entry in closed["limits"])


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("limits", TRACKING, "TEM[p, a]", "--sensors", "RepotPos", *HOST), "did you mean ReportPos?"),
        (("limits", TRACKING, "TEMM[p, a]", *HOST), "<process>:1:1: unknown process TEMM, did you mean TEM?"),
        (("limits", TRACKING, "TEM[p]", *HOST), "expected TEM[p, a]"),
        (("limits", TRACKING, "TEM[p, a]"), "unknown process InView"),
        (("evolve", TRACKING, "TEM[p, a]", *HOST, "--set", "tt0=1"), "did you mean t0?"),
        (("evolve", TRACKING, "TEM[p, a]", *HOST, "--set", "t0"), "expected NAME=NUMBER"),
        (("evolve", TRACKING, "TEM[p, a]", *HOST, "--limit", "0"), "limit is 0"),
        (("evolve", TRACKING, "TEM[p, a] | STOP", *HOST), "expected NAME[arguments]"),
        (("evolve", "nothing.rsl", "TEM[p, a]"), "no such file"),
    ],
)
def test_bad_input_is_refused_with_place_and_nearest_name(call: Call, arguments: tuple[str, ...], said: str) -> None:
    for extra in ((), ("--json",)):
        refused = call(*arguments, *extra)
        assert refused.status == 2
        assert said in refused.err


def test_the_line_at_fault_is_shown(call: Call) -> None:
    refused = call("limits", TRACKING, "TEM[p, a]")
    assert "tracking.rsl:7:56" in refused.err
    assert refused.err.rstrip().endswith("^")
