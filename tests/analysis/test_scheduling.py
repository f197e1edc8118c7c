"""Do reactions fit on an executer whose steps cost so much? (X §7)"""

from __future__ import annotations

import pytest

from planner_reactor.analysis.denseness import opened
from planner_reactor.analysis.rounds import Irreducible
from planner_reactor.analysis.scheduling import Demand, schedule, steps_of
from planner_reactor.rs.parser import parse_process, parse_program

FAST = Demand("Fast", steps=4, period=0.01, slack=0.002)
SLOW = Demand("Slow", steps=40, period=1.0, slack=0.5)


def test_what_fits_says_by_how_much() -> None:
    found = schedule([FAST, SLOW], 10e-6)
    assert found.fits
    assert found.load == pytest.approx(4 * 10e-6 / 0.01 + 40 * 10e-6)
    assert found.response == pytest.approx(44 * 10e-6)
    assert found.margin == pytest.approx(0.002 / 44e-5)


def test_a_reaction_waits_for_one_round_of_all_others() -> None:
    assert not schedule([FAST, SLOW], 50e-6).fits
    assert schedule([FAST], 50e-6).fits
    assert "Fast may be late by 0.002 s" in str(schedule([FAST, SLOW], 50e-6))


def test_more_than_all_the_time_never_fits() -> None:
    greedy = Demand("Greedy", steps=1_000, period=0.01, slack=10.0)
    found = schedule([greedy], 20e-6)
    assert (found.fits, found.load) == (False, pytest.approx(2.0))
    assert found.offender == "Greedy takes 200.00% of the time"


def test_steps_are_counted_on_the_text() -> None:
    world = opened(parse_program("TRACK = IN[s1]<v> :; OUT[m1, v]\nLong = (IN[s1]<v> : Delay[t]) :; OUT[m1, v]\n"))
    assert (steps_of(parse_process("TRACK"), world), steps_of(parse_process("Long"), world)) == (3, 4)
    with pytest.raises(Irreducible, match="does nothing at any port"):
        steps_of(parse_process("NIL"), world)
