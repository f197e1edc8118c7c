"""A goal that acts instead of what is disabled: the greenhouse whose tap runs dry while no planner answers (R §10)."""

from __future__ import annotations

import importlib.util
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest

from planner_reactor.logic.reader import read_domain
from planner_reactor.planner import Planner
from planner_reactor.reactor.reactor import Reactor
from planner_reactor.runtime import Scheduler, VirtualClock
from planner_reactor.trace import Trace

EXAMPLES = Path(__file__).parents[2] / "examples"
TEXT = (EXAMPLES / "greenhouse.itl").read_text(encoding="utf-8")
(SENTENCE,) = (line + "\n" for line in TEXT.splitlines() if line.startswith("atp_goal Shelter"))
DRY, SILENT, BACK, END = 100.2, 90.0, 300.0, 600.0
"""Seconds: the tap runs dry; the planner falls silent before, and speaks again."""


class House:
    """The world, a reactor in it, and a planner that may be silent."""

    def __init__(self, text: str) -> None:
        found = importlib.util.spec_from_file_location("greenhouse", EXAMPLES / "greenhouse.py")
        assert found is not None
        assert found.loader is not None
        module = importlib.util.module_from_spec(found)
        found.loader.exec_module(module)
        self.scheduler = Scheduler(VirtualClock(), seed=1)
        self.host = host = module.host(self.scheduler)
        self.world: Any = host.world
        self.trace = Trace(lambda: self.scheduler.now)
        self.reactor = Reactor(self.scheduler, host=host, trace=self.trace)
        self.reactor.start()
        self.world.start(self.scheduler)
        self.planner = Planner(read_domain(text), relax=["STILL"])

    def run(self, until: float, *, planned: bool) -> None:
        while self.scheduler.now < until:
            if planned:
                for perception in self.reactor.perceptions.take():
                    self.planner.perceive(perception)
                step = self.planner.step()
                for adaptation in step.adaptations if step else ():
                    self.reactor.receive(adaptation)
            self.reactor.executer.run(until=self.scheduler.now + 0.5)

    def water_left(self) -> int:
        """Millilitres in the pots."""
        return sum(self.world.water[pot] for pot in ("fern", "basil", "fig"))

    def entered(self, situation: str) -> list[float]:
        return [e.time for e in self.trace.of("entered") if e.data["situation"] == situation]


def dried(text: str, *, back: bool = False) -> House:
    house = House(text)
    house.run(SILENT, planned=True)
    house.scheduler.call_at(DRY, lambda: house.world.strike("tap_off", seconds=BACK - DRY if back else 1e6))
    house.run(BACK, planned=False)
    house.run(END, planned=back)
    assert house.reactor.laws.violations == []
    return house


def test_while_watering_is_disabled_the_house_is_shaded_and_the_plants_live_longer() -> None:
    house, bare = dried(TEXT), dried(TEXT.replace(SENTENCE, ""))
    failed = house.trace.of("assumption_failure")
    assert next(failed).data["assumption"] == "TAP"
    shaded = house.entered("Shelter")
    assert DRY < shaded[0] < DRY + 1.0  # within a period of the monitor
    assert max(later - sooner for sooner, later in pairwise(shaded)) < 10.5
    assert house.water_left() > 2 * bare.water_left()


def test_when_the_planner_has_another_way_the_blinds_go_up() -> None:
    house = dried(TEXT, back=True)
    assert house.entered("Shelter")[-1] < BACK + 30.0
    assert not house.world.shaded
    assert [time for time in house.entered("TendFern") if time > BACK + 10.0]


def test_as_long_as_nothing_fails_it_does_nothing() -> None:
    house = House(TEXT)
    house.run(SILENT, planned=True)
    assert house.entered("Shelter") == []
    assert house.entered("TendFern")


@pytest.mark.parametrize(
    ("given", "says"),
    [
        ("Tned(fern)", "Tned is no abstract action"),
        ("Pour(fern)", "Pour is no abstract action"),
        ("Tend(fern, fig)", "Tend with 2 arguments"),
    ],
)
def test_what_it_acts_instead_of_must_be_an_abstract_action(given: str, says: str) -> None:
    with pytest.raises(ValueError, match=says):
        read_domain(TEXT.replace("instead Tend(fern)", f"instead {given}"))
