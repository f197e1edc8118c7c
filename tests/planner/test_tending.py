"""Machine tending: a domain of which the machinery knows nothing, run in its own world by its own text and host."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from planner_reactor.calls.looping import loop
from planner_reactor.logic.domain import Domain
from planner_reactor.logic.reader import check_domain
from planner_reactor.planner import Planner
from tests.planner.driving import TENDING, Book, kitting, planner_without, settle, texts

HOST = str(TENDING.with_suffix(".py"))


@pytest.fixture(scope="module")
def domain() -> Domain:
    return kitting(TENDING)


def test_the_domain_is_without_fault() -> None:
    assert check_domain(TENDING.read_text()) == ()


def test_what_each_assumption_spares_follows_from_the_text(domain: Domain) -> None:
    added = {"PLACED": "LookAtRack", "SHARP": "Gauge", "DOORS": "AwaitDoor", "INTIME": "AwaitLamp"}
    trusting = Planner(domain, relax="none", verify=False)
    settle(trusting)
    for name, action in added.items():
        planner = planner_without(domain, [name], verify=False)
        settle(planner)
        assert action not in "".join(texts(trusting).values())
        assert action in "".join(texts(planner).values())


def test_every_set_of_its_assumptions_can_be_planned_for(domain: Domain) -> None:
    for chosen in range(16):
        names = [name for n, name in enumerate(domain.assumptions) if chosen >> n & 1]
        planner = planner_without(domain, names, verify=chosen in (0, 15))
        settle(planner, Book(domain, loads=chosen in (0, 15)))
        assert planner.ideal, names
        assert not planner.withheld
        assert not planner.warnings


def test_one_machine_is_loaded_while_the_other_runs(domain: Domain) -> None:
    planner = Planner(domain, relax="none")
    settle(planner)
    assert "REASSERT[LoadLathe] : (Run[lathe] & REASSERT[LoadMill] : Run[mill])" in texts(planner)["Tending"]


@pytest.mark.parametrize("seed", range(2))
def test_a_shift_with_all_that_goes_wrong_and_all_that_is_asked_for(tmp_path: Path, seed: int) -> None:
    """Every assumption fails, one comes back, a second goal comes and goes, a machine is down for a while."""
    events: list[Any] = []
    found = loop(
        TENDING, host=HOST, until=3600.0, seed=seed, relax="PLACED",
        faults=TENDING.with_name("tending.toml"), goals=TENDING.with_name("tending.goals.toml"),
        watch=lambda made: made.trace.sinks.append(events.append),
    )  # fmt: skip
    assert found["violations"] == found["refused_advice"] == found["unstruck"] == []
    assert found["interruptions"] == found["adaptations"]["refused"] == found["adaptations"]["timed_out"] == 0
    assert found["first_reactor_s"] < 0.1
    changes = [(r["assumption"], r["cause"]) for r in found["relaxations"]]
    assert changes[0] == ("PLACED", "normal")
    assert {("INTIME", "forced"), ("INTIME", "reinstated"), ("DOORS", "forced"), ("SHARP", "forced")} <= set(changes)
    pieces, swept = found["pieces"], found["swept"]
    assert pieces["delivered"] == sum(count for name, count in pieces.items() if name != "delivered")
    assert pieces["stored"] >= 45
    assert pieces["scrapped"] >= 2  # of the worn tool
    assert found["out_of_tolerance"] == 0  # what was made while nobody gauged was told in time by the spindle's load
    assert swept >= 4
    down = [e for e in events if e.kind == "asserted" and e.data["situation"] == "LoadMill" and 3040 < e.time < 3300]
    assert down == []
    assert any(e.kind == "asserted" and e.data["situation"] == "LoadMill" and e.time > 3300 for e in events)
