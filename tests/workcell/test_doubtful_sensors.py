"""Sensors that hang and an assumption that flaps, in runs of the cell: unknown is not false, costs are bounded."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import pytest

from planner_reactor.experiments.loop import Loop
from planner_reactor.logic.reader import read_domain
from planner_reactor.planner import Planner
from planner_reactor.runtime import Caution, Host, Scheduler
from planner_reactor.trace import Trace
from planner_reactor.workcell.domains import shipped_domain
from planner_reactor.workcell.evidence import ASSUMPTIONS
from planner_reactor.workcell.host import host as kitting
from planner_reactor.workcell.monitors import Monitors

DOMAIN = read_domain(shipped_domain(), file="kitting.itl")


def loop(cautions: Mapping[str, Caution] | None = None) -> Loop:
    def make(scheduler: Scheduler, trace: Trace) -> Host:
        return kitting(scheduler, trace=trace, cautions=cautions)

    return Loop(Planner(DOMAIN, relax=()), make, seed=3)


def at(made: Loop, time: float, action: Callable[[], object]) -> None:
    made.scheduler.call_at(time, action)


def test_every_assumption_of_the_cell_has_a_sensor_that_says_something(monkeypatch: pytest.MonkeyPatch) -> None:
    made = loop()
    heard: dict[str, set[bool | None]] = {a: set() for a in ASSUMPTIONS}
    usual = Monitors.holds

    def listening(self: Monitors, assumption: str) -> bool | None:
        heard[assumption].add(holds := usual(self, assumption))
        return holds

    monkeypatch.setattr(Monitors, "holds", listening)
    made.run(until=300.0)
    unpolled = {"AM"}  # whoever misses a part reports it
    assert {a for a in ASSUMPTIONS if True in heard[a]} == set(ASSUMPTIONS) - unpolled
    assert not any(False in said for said in heard.values())


def test_a_line_without_its_life_sign_is_unknown_and_that_is_told_once() -> None:
    made = loop()
    at(made, 100.0, lambda: made.host.world.sensors.hang(line=True))  # type: ignore[union-attr]
    at(made, 200.0, lambda: made.host.world.sensors.hang())  # type: ignore[union-attr]
    at(made, 250.0, lambda: made.host.world.strike("downstream_blocked"))  # type: ignore[union-attr]
    made.run(until=260.0)
    (doubt,) = made.trace.of("assumption_unknown")
    assert (doubt.data["assumption"], doubt.data["cause"]) == ("ADD", "stuck")
    assert 110.0 < doubt.time < 113.0
    failures = [e.time for e in made.trace.of("assumption_failure")]
    assert min(failures) > 250.0  # and then it is believed again
    assert made.reactor.laws.violations == []


def test_a_picture_that_is_not_new_is_unknown() -> None:
    made = loop()
    at(made, 100.0, lambda: made.host.world.sensors.hang(camera=True))  # type: ignore[union-attr]
    made.run(until=140.0)
    doubts = {e.data["assumption"]: e.data["cause"] for e in made.trace.of("assumption_unknown")}
    assert doubts
    assert set(doubts) <= {"AF", "ACT", "ACP", "ADT"}
    assert set(doubts.values()) == {"stale"}


def flapping(hold_off: float, seconds: float) -> int:
    """How often the planner changes its assumptions while downstream's line goes up and down ten times a second."""
    made = loop({"ADD": Caution(hold_off=hold_off)})

    def flap(ready: bool) -> None:
        made.host.report("ADD", ready)
        if made.scheduler.now < 100.0 + seconds:
            made.scheduler.call_after(0.05, lambda: flap(not ready))

    at(made, 100.0, lambda: flap(False))
    made.run(until=100.0 + seconds)
    assert made.reactor.laws.violations == []
    assert {r.cause for r in made.relaxations} == {"forced", "reinstated"}
    return len([r for r in made.relaxations if r.assumption == "ADD"])


def test_flapping_costs_at_most_one_change_of_assumptions_in_a_hold_off() -> None:
    assert flapping(hold_off=60.0, seconds=600.0) <= 600 / 60 + 1
    assert flapping(hold_off=0.0, seconds=2.0) > 8  # it is the hold-off that bounds it
