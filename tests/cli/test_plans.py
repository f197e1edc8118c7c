"""`plan` and `network`."""

from __future__ import annotations

from pathlib import Path

import pytest

from planner_reactor.rs.parser import parse_program
from planner_reactor.workcell.domains import shipped_domain
from tests.cli.conftest import Call


@pytest.fixture
def domain(place: Path) -> str:
    (place / "kitting.itl").write_text(shipped_domain())
    return "kitting.itl"


def test_plan_shows_each_segment_with_what_it_rests_on(call: Call, domain: str) -> None:
    ran = call("plan", domain, "--json")
    found = ran.object
    assert ran.status == 0
    first = found["segments"][0]
    assert first["situation"] == "Kitting"
    assert first["text"].startswith("P[0] = STOP :; ASSERT[Kitting]\n")
    assert sorted(first["adds"]) == list(range(len(first["adds"])))
    assert (first["kills"], set(first["stubs"])) == ([], {"FillTray", "FinishTray"})
    assert {f"ASSUMONITOR[{a}]" for a in ("AQ", "AS")} <= set(first["monitors"])
    assert {"AQ", "AM"} <= set(first["assumptions"])
    assert 0 < found["issued_s"] <= found["segments"][-1]["issued_s"]
    assert (found["ideal"], found["impossible"]) == (True, {})


def test_every_stub_is_refined_by_a_later_segment(call: Call, domain: str) -> None:
    segments = call("plan", domain, "--json").object["segments"]
    assert {stub for s in segments for stub in s["stubs"]} == {s["situation"] for s in segments[1:]}


def test_plan_does_without_assumptions(call: Call, domain: str) -> None:
    found = call("plan", domain, "--without", "AQ, AM", "--json").object
    assert not {"AQ", "AM"} & {a for s in found["segments"] for a in s["assumptions"]}
    assert any("Test" in s["text"] for s in found["segments"])


def test_plan_stops_after_so_many_segments(call: Call, domain: str) -> None:
    found = call("plan", domain, "--steps", "2", "--json").object
    assert (len(found["segments"]), found["ideal"]) == (2, False)


def test_what_plan_prints_for_people_is_a_program(call: Call, domain: str) -> None:
    out = call("plan", domain).out
    assert len(parse_program(out)) > 15
    assert "// stubs: FillTray, FinishTray" in out


def test_a_goal_without_a_plan_is_told_with_exit_1(call: Call, place: Path) -> None:
    (place / "vain.itl").write_text(
        "atp_goal Vain forall x, i1: Guest(x) @ i1 => Exists i2: Served(x) @ i2 and ITL(i2, finishes, time);\n"
        "atp_fact Guest(one);\natp_fact Open(door);\n"
        "atp_rule forall x, i: Open(x) @ i => Served(x) @ i;\n"
    )
    ran = call("plan", "vain.itl", "--json")
    assert (ran.status, ran.object["segments"]) == (1, [])
    assert "no plan for Vain" in ran.err


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (("--without", "AX"), "unknown assumption AX, expected one of: AQ, "),
        (("--without", "ADDD"), "unknown assumption ADDD, did you mean ADD?"),
        (("--without", "AQ,"), "unknown assumption '', expected one of: AQ, "),
        (("--steps", "0"), "steps is 0, expected a whole number, 1 or more"),
        (("--goal", "Kiting"), "no goal Kiting, did you mean Kitting?"),
    ],
)
def test_plan_refuses_what_the_domain_does_not_have(
    call: Call, domain: str, options: tuple[str, ...], said: str
) -> None:
    assert call("plan", domain, *options).refused(said)


def test_plan_refuses_a_wrong_domain_with_its_place(call: Call, place: Path) -> None:
    (place / "wrong.itl").write_text(shipped_domain().replace("atp_goal", "atp_gaol"))
    ran = call("plan", "wrong.itl")
    assert ran.refused("unexpected atp_gaol", "did you mean atp_goal?", "    ^")
    assert call("check", "wrong.itl").status == 2
    assert call("check", "wrong.itl", "--host", "planner_reactor.workcell.host").status == 2


def test_a_domain_is_checked_against_its_host(call: Call, place: Path, domain: str) -> None:
    assert call("check", domain, "--host", "planner_reactor.workcell.host").status == 0
    (place / "slip.itl").write_text(shipped_domain().replace("FindGetInsert", "FindGetInsrt"))
    assert call("check", "slip.itl").status == 0
    ran = call("check", "slip.itl", "--host", "planner_reactor.workcell.host")
    assert ran.status == 2
    assert "unknown process FindGetInsrt, did you mean FindGetInsert?" in ran.err


def test_network_gives_closure_scenario_and_timeline(call: Call) -> None:
    assert call("network", "times.txt", "--json").object == {
        "consistent": True,
        "intervals": ["i1", "i2", "i3"],
        "closure": [
            {"first": "i1", "relations": ["b", "m", "o"], "second": "i2"},
            {"first": "i1", "relations": ["b"], "second": "i3"},
            {"first": "i2", "relations": ["b", "m"], "second": "i3"},
        ],
        "scenario": [
            {"first": "i1", "relation": "b", "second": "i2"},
            {"first": "i1", "relation": "b", "second": "i3"},
            {"first": "i2", "relation": "b", "second": "i3"},
        ],
        "timeline": {"i1": [0, 1], "i2": [2, 3], "i3": [4, 5]},
        "metric": False,
        "explanation": None,
    }


def test_network_prints_the_closure_in_its_own_notation(call: Call, place: Path) -> None:
    out = call("network", "times.txt").out
    assert "  i1 (b m o) i2\n  i1 (b) i3\n" in out
    (place / "again.txt").write_text(out.partition("closure:\n")[2].partition("scenario:")[0])
    assert call("network", "again.txt", "--json").object == call("network", "times.txt", "--json").object


def test_an_inconsistent_network_exits_with_1(call: Call, place: Path) -> None:
    (place / "circle.txt").write_text("a b b1\nb1 b c\nc b a\n")
    ran = call("network", "circle.txt", "--json")
    assert (ran.status, ran.object["consistent"], ran.object["scenario"]) == (1, False, None)
    assert ran.object["explanation"] == [
        {"line": 1, "text": "a b b1"}, {"line": 2, "text": "b1 b c"}, {"line": 3, "text": "c b a"},
    ]  # fmt: skip
    out = call("network", "circle.txt").out
    assert out.startswith("not consistent")
    assert "  line 2: b1 b c\n" in out


def test_network_knows_durations_and_resources(call: Call, place: Path) -> None:
    (place / "day.txt").write_text("a lasts 4000\nb lasts 4000\na d day\nb (s f d) day\na uses arm\nb uses arm\n")
    (place / "short.txt").write_text((place / "day.txt").read_text() + "day lasts 0 .. 7000\n")
    found = call("network", "day.txt", "--json").object
    assert found["metric"]
    assert found["timeline"]["a"][1] - found["timeline"]["a"][0] == 4000
    ran = call("network", "short.txt")
    assert ran.status == 1
    assert "line 5: there is one arm, for nothing says otherwise" in ran.out
    assert "line 7: day lasts 0 .. 7000" in ran.out


def test_network_refuses_what_is_no_constraint_with_its_place(call: Call, place: Path) -> None:
    (place / "odd.txt").write_text("i1 (b m) i2\ni1 (b mx) i2\n")
    assert call("network", "odd.txt").refused("odd.txt:2:7: mx is not a relation", "    i1 (b mx) i2\n          ^")
