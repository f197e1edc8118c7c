"""An assumption that flaps ten times a second, with a planner: what that costs is bounded by the hold-off.

An hour of it without a planner: tests/reactor/test_readings.py.
"""

from __future__ import annotations

from planner_reactor.runtime import Caution
from tests.experiments.test_standing_in import TEXT, House

SECONDS, HOLD_OFF = 240.0, 20.0
A_CHANGE = 2
"""Adaptations that a change of mind costs in the greenhouse at most: of the plants' reactions, and of monitors."""


def test_ten_hertz_cost_adaptations_by_the_hold_off() -> None:
    house = House(TEXT)
    house.run(60.0, planned=True)
    house.host.cautions["TAP"] = Caution(hold_off=HOLD_OFF)
    house.world.pressure = None  # nothing but what is reported
    before = house.reactor.counts["applied"]

    flaps = [0]

    def turn(holds: bool) -> None:
        flaps[0] += 1
        house.host.report("TAP", holds)
        house.scheduler.call_after(0.05, lambda: turn(not holds))

    turn(False)
    house.run(60.0 + SECONDS, planned=True)
    applied = house.reactor.counts["applied"] - before
    assert flaps[0] > 10 * SECONDS
    assert 2 <= applied <= A_CHANGE * (SECONDS / HOLD_OFF + 1)
    assert house.reactor.laws.violations == []
