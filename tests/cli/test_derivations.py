"""`dynamics`: what it prints, and what it refuses."""

from __future__ import annotations

from importlib.resources import files
from pathlib import Path

import pytest

from tests.cli.conftest import Call

MODELS = files("planner_reactor.workcell.environments")
TRACKING, BELT = str(MODELS / "tracking.rsl"), str(MODELS / "belt.rsl")
HOST = ("--host", "planner_reactor.workcell.environments.dynamics")


def test_dynamics_gives_the_limit_set_with_the_actions_that_come_of_it(call: Call) -> None:
    found = call("dynamics", TRACKING, "TEM[p, a]", *HOST, "--json").object
    assert [(e["condition"], e["actions"]) for e in found["dynamics"]] == [
        ("-eps <= g <= eps", []), ("IN[angle]<na>", ["MOVECAMERA"]), ("InView[p, a]", ["LOOK"]),
    ]  # fmt: skip
    assert "neither senses nor affects it" in found["dynamics"][0]["why"]
    assert [(a["name"], a["label"], a["rs"]) for a in found["actions"]] == [
        ("MOVECAMERA", "camera-55", "MOVECAMERA[inport] = IN[inport]<v> :; OUT[m1, v]"),
        ("LOOK", "reportpos-57", "LOOK[outport] = IN[s1]<v> :; OUT[outport, v]"),
    ]
    for start in ("atp_actionschema camera-55\n", "atp_actionschema MOVECAMERA\n", "atp_actionschema LOOK\n"):
        assert start in found["schemas"]
    pos = next(p for p in found["denseness"] if p["port"] == "pos")
    assert (pos["dense"], pos["delay"], pos["resolution"], pos["form"]) == (True, "ts1", "max(t0, ts0)", "Theorem 6")


def test_the_papers_models_need_no_host(call: Call, tmp_path: Path) -> None:
    bare, hosted = (call("dynamics", TRACKING, "TEM", *given, "--json").object for given in ((), HOST))
    assert bare == hosted
    own = Path(TRACKING).read_text(encoding="utf-8") + "InView[p, a] = LST[p - a, w] : LST[a - p, w]\n"
    (tmp_path / "own.rsl").write_text(own, encoding="utf-8")
    found = call("dynamics", str(tmp_path / "own.rsl"), "TEM", "--json").object
    assert [a["name"] for a in found["actions"]] == ["MOVECAMERA", "LOOK"]


def test_the_arguments_may_be_left_out(call: Call) -> None:
    assert call("dynamics", BELT, "BEM", *HOST, "--json").object["dynamics"][0]["actions"] == ["WAITFOROBJECT"]


def test_dynamics_for_people(call: Call) -> None:
    shown = call("dynamics", TRACKING, "TEM", *HOST).out
    assert "IN[angle]<na>     ->  TEM[p, na]\n                      MOVECAMERA\n" in shown
    assert "    InView(Object) @ i1 and ITL(i1, [si e di fi], LOOK)\n" in shown


def test_a_reaction_that_does_not_keep_up_is_told_with_numbers_and_the_process_to_blame(
    call: Call, tmp_path: Path
) -> None:
    text = Path(TRACKING).read_text(encoding="utf-8") + "TRACK = IN[s1]<v> :; OUT[m1, v]\n"
    (tmp_path / "track.rsl").write_text(text, encoding="utf-8")
    settings = ("t0=1", "ts0=0.1", "ts1=0.05", "gl=0.01", "tl=0.005", "gm=0.03", "tm=0.02", "eps=0.9")
    asked = ["dynamics", str(tmp_path / "track.rsl"), "TEM", *HOST, "--reaction", "TRACK", "--json"]
    timely = call(*asked, *(part for s in settings for part in ("--set", s)))
    assert (timely.status, timely.object["timing"]["stable"]) == (0, True)
    late = call(*asked, *(part for s in (*settings, "gm=1.5") for part in ("--set", s)))
    assert (late.status, late.object["timing"]["stable"]) == (1, False)
    failed = {c["name"]: c for c in late.object["timing"]["checks"] if not c["holds"]}
    assert set(failed) == {"reads", "writes", "corrects", "covers"}
    assert (failed["writes"]["left"], failed["writes"]["offender"]) == (1.51, "motor1")


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("dynamics", TRACKING, "TEMM[p, a]", *HOST), "unknown process TEMM, did you mean TEM?"),
        (("dynamics", TRACKING, "TEM[p, a]", "--host", "tests.cli.conftest"), "host"),
        (("dynamics", TRACKING, "TEM[p]", *HOST), "expected TEM[p, a]"),
        (("dynamics", TRACKING, "TEM", *HOST, "--interface", "sens1"), "no process sens1 for the interface, did"),
        (("dynamics", TRACKING, "TEM", *HOST, "--interface", "InView"), "expected a definition of the text"),
        (("dynamics", TRACKING, "TEM", *HOST, "--goal", "angle"), "no port angle of the interface, there are: m1, s1"),
        (("dynamics", TRACKING, "TEM", *HOST, "--reaction", "Track"), "unknown process Track"),
        (("dynamics", TRACKING, "TEM", *HOST, "--set", "t0"), "expected NAME=NUMBER"),
        (("dynamics", "nowhere.rsl", "TEM", *HOST), "nowhere.rsl:1:1: no such file"),
    ],
)  # fmt: skip
def test_wrong_input_is_refused(call: Call, arguments: tuple[str, ...], said: str) -> None:
    result = call(*arguments)
    assert result.status == 2
    assert said in result.err


def test_a_reaction_is_scheduled_on_an_executer_of_known_cost(call: Call, tmp_path: Path) -> None:
    text = Path(TRACKING).read_text(encoding="utf-8") + "TRACK = IN[s1]<v> :; OUT[m1, v]\n"
    (tmp_path / "track.rsl").write_text(text, encoding="utf-8")
    asked = ["dynamics", str(tmp_path / "track.rsl"), "TEM", *HOST, "--reaction", "TRACK", "--json"]
    known = ("t0=1", "ts0=0.1", "ts1=0.05", "gl=0.01", "tl=0.005", "gm=0.03", "tm=0.02", "eps=0.9")
    settings = [part for s in known for part in ("--set", s)]
    quick = call(*asked, *settings, "--cost", "0.00001")
    assert (quick.status, quick.object["schedule"]["fits"]) == (0, True)
    assert quick.object["schedule"]["load"] == pytest.approx(3 * 1e-5 / 0.05)
    slow = call(*asked, *settings, "--cost", "0.02")
    assert (slow.status, slow.object["schedule"]["offender"]) == (1, "TRACK takes 120.00% of the time")
    refused = call(*asked, "--cost", "0.02")
    assert (refused.status, "give them with --set" in refused.err) == (2, True)
    assert call(*asked, "--cost", "cheap").status == 2
