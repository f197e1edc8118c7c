"""When the readings of a sensor change the reactor's mind (docs/reactor.md, Failed assumptions)."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import pytest

from planner_reactor.errors import InputError
from planner_reactor.link.messages import Adaptation
from planner_reactor.reactor.readings import Readings
from planner_reactor.runtime import Caution, Host, Reading
from tests.reactor.driving import FIRST, Bench

WATCHED = Adaptation(id=2, definitions="P[5] = HOLDMONITOR[A, 1000]", adds=(5,))


def cautious(**caution: Any) -> Bench:
    """A bench whose work rests on A; A is watched both ways, and its readings are taken with caution."""
    bench = Bench()
    bench.host.cautions["A"] = Caution(**caution)
    bench.reactor.receive(FIRST)
    bench.at(0.1, WATCHED)
    return bench


def flag(bench: Bench, *changes: tuple[float, bool | None]) -> None:
    for time, holds in changes:
        bench.scheduler.call_at(time, lambda holds=holds: bench.flags.update(A=holds))  # type: ignore[misc]


def told(bench: Bench) -> list[tuple[str, float]]:
    kinds = ("assumption_failure", "assumption_holds", "assumption_unknown")
    found = [(e.kind, e.time) for e in bench.trace.events if e.kind in kinds]
    return [event for n, event in enumerate(found) if n == 0 or found[n - 1][0] != event[0]]


def disabled(bench: Bench) -> list[float]:
    return bench.times("inhibited", because="assumption")


# -------------------------------------------------------------------------------------------- slips, hold-on, hold-off


def test_without_caution_the_last_reading_counts_at_once() -> None:
    bench = cautious()
    flag(bench, (4.5, False), (6.5, True))
    bench.run(10.0)
    assert told(bench) == [("assumption_failure", 5.0), ("assumption_holds", 7.1)]


def test_a_slip_is_no_failure_and_n_of_m_readings_are() -> None:
    bench = cautious(fails=2, window=3)
    flag(bench, (4.5, False), (5.05, True), (8.5, False), (9.05, True), (9.5, False))
    bench.run(12.0)
    assert disabled(bench) == [10.0]  # at 5 s it was one of three
    assert told(bench) == [("assumption_failure", 10.0)]


def test_it_returns_only_after_it_has_held_for_the_hold_on() -> None:
    bench = cautious(hold_on=3.0)
    flag(bench, (2.5, False), (4.5, True), (6.5, False), (8.5, True))
    bench.run(20.0)
    assert told(bench) == [("assumption_failure", 3.0), ("assumption_holds", 12.1)]  # held from 9.1 s on
    assert bench.reactor.laws.violations == []


def test_a_return_is_read_for_after_a_period_at_the_earliest() -> None:
    """Or whatever flaps would come back as soon as it was given up, however long its monitor is to wait."""
    bench = cautious()
    flag(bench, (2.5, False), (3.2, True))
    bench.at(3.3, Adaptation(id=3, definitions="P[6] = HOLDMONITOR[A, 8000]", kills=(5,), adds=(6,)))
    bench.run(20.0)
    assert told(bench) == [("assumption_failure", 3.0), ("assumption_holds", pytest.approx(11.3, abs=0.1))]


def test_unknown_is_no_holding_on() -> None:
    bench = cautious(hold_on=3.0)
    flag(bench, (2.5, False), (4.5, True), (6.5, None), (7.5, True))
    bench.run(20.0)
    assert told(bench) == [("assumption_failure", 3.0), ("assumption_holds", 11.1)]


def test_within_the_hold_off_it_is_disabled_at_once_and_the_planner_is_told_later() -> None:
    bench = cautious(hold_off=10.0)
    flag(bench, (2.5, False), (3.5, True), (15.5, False))
    bench.run(30.0)
    assert disabled(bench) == [3.0, 16.0]
    assert told(bench) == [("assumption_failure", 3.0), ("assumption_holds", 13.0), ("assumption_failure", 23.0)]


def test_what_was_over_before_the_planner_was_told_it_never_hears_of() -> None:
    bench = cautious(hold_off=10.0)
    flag(bench, (2.5, False), (3.5, True), (15.5, False), (17.5, True))
    bench.run(40.0)
    assert disabled(bench) == [3.0, 16.0]
    assert told(bench) == [("assumption_failure", 3.0), ("assumption_holds", 13.0)]
    assert not bench.reactor.situations.is_disabled("part", "A")


def test_what_failed_before_a_crash_was_told_and_returns_as_it_should() -> None:
    bench = cautious(hold_off=5.0)
    bench.reactor.assumptions.failed["A"] = 0.0  # as a journal has it
    bench.run(3.0)
    assert told(bench)[0] == ("assumption_holds", 1.1)


# ---------------------------------------------------------------------------------------------------------- flapping

HOUR = 3600.0


def test_ten_hertz_for_an_hour_costs_at_most_one_change_of_mind_in_a_hold_off() -> None:
    hold_off = 60.0
    bench = cautious(hold_off=hold_off)
    flap(bench, 0.05)
    bench.run(HOUR)
    changes = [time for _, time in told(bench)]
    assert len(bench.times("inhibited", because="assumption")) > HOUR  # what rests on it is disabled each time
    assert min(later - sooner for sooner, later in pairwise(changes)) >= hold_off - 1e-6
    assert 2 < len(changes) <= HOUR / hold_off + 1
    assert bench.reactor.laws.violations == []


def test_without_a_hold_off_it_costs_a_change_each_time() -> None:
    bench = cautious()
    flap(bench, 0.05)
    bench.run(60.0)
    assert len(told(bench)) > 1000


def flap(bench: Bench, half: float) -> None:
    """A process reports in turn that A fails and that it holds."""

    def turn(holds: bool) -> None:
        bench.host.report("A", holds)
        bench.scheduler.call_after(half, lambda: turn(not holds))

    bench.flags["A"] = None
    bench.scheduler.call_at(1.0, lambda: turn(False))


# --------------------------------------------------------------------------------------------------- stale and stuck


class Camera:
    """A sensor with frames: takes a picture each 0.5 s, unless it hangs (no pictures) or freezes (the same one)."""

    def __init__(self, bench: Bench, **caution: Any) -> None:
        self.bench, self.hangs, self.frozen = bench, False, False
        self.taken, self.frame, self.sees = 0.0, 0, True
        bench.host.assumptions["A"] = lambda: Reading(self.sees, self.taken, self.frame)
        bench.host.cautions["A"] = Caution(**caution)
        bench.scheduler.call_at(0.0, self.picture)

    def picture(self) -> None:
        if not self.hangs:
            self.taken = self.bench.scheduler.now
            self.frame += not self.frozen
        self.bench.scheduler.call_after(0.5, self.picture)


def filmed(**caution: Any) -> tuple[Bench, Camera]:
    bench = Bench()
    camera = Camera(bench, **caution)
    bench.reactor.receive(FIRST)
    return bench, camera


@pytest.mark.parametrize(("defect", "cause"), [("hangs", "stale"), ("frozen", "stuck")])
def test_a_reading_that_is_stale_or_stuck_is_unknown_and_that_is_told_once_and_counted(defect: str, cause: str) -> None:
    bench, camera = filmed(stale=2.0, stuck=2.0)

    def strike() -> None:
        setattr(camera, defect, True)
        camera.sees = False  # what it shows is wrong

    bench.scheduler.call_at(4.7, strike)
    bench.scheduler.call_at(4.8, lambda: setattr(camera, "sees", True))
    bench.scheduler.call_at(7.6, lambda: setattr(camera, "sees", False))
    bench.run(12.0)
    assert bench.reactor.failed == {}  # unknown is not false
    assert bench.times("assumption_unknown", assumption="A", cause=cause) == [7.0]
    assert bench.reactor.readings.doubts == 6  # 7 to 12 s, once a second
    (doubt,) = [p for p in bench.perceptions() if p.kind == "assumption_unknown"]
    assert (doubt.subject, doubt.cause, doubt.count) == ("A", cause, 1)


def test_with_news_it_is_believed_again() -> None:
    bench, camera = filmed(stale=2.0, stuck=2.0)
    bench.scheduler.call_at(4.7, lambda: setattr(camera, "frozen", True))
    bench.scheduler.call_at(9.2, lambda: setattr(camera, "frozen", False))
    bench.scheduler.call_at(9.3, lambda: setattr(camera, "sees", False))
    bench.run(12.0)
    assert told(bench) == [("assumption_unknown", 7.0), ("assumption_failure", 10.0)]


def test_a_sensor_without_a_signal_is_never_stuck() -> None:
    bench = cautious(stuck=1.0)
    bench.host.assumptions["A"] = lambda: Reading(True, bench.scheduler.now)
    bench.run(20.0)
    assert bench.reactor.readings.doubts == 0


# ------------------------------------------------------------------------------------------- the checks can be broken


def test_law_14_sees_a_failure_that_was_read_and_not_believed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Readings, "_fails", lambda self, assumption, mind: None)
    bench = cautious(fails=2, window=2)
    flag(bench, (4.5, False))
    bench.run(9.0)
    assert {v.law for v in bench.reactor.laws.violations} == {14}


@pytest.mark.parametrize(
    "wrong", [{"fails": 0}, {"fails": 3, "window": 2}, {"hold_on": -1.0}, {"stale": float("nan")}]
)
def test_a_caution_that_makes_no_sense_is_refused(wrong: dict[str, Any]) -> None:
    with pytest.raises(InputError, match="expected"):
        Caution(**wrong)


def test_a_host_says_how_its_readings_are_taken() -> None:
    host = Host("careful")
    host.assumption("A", Caution(hold_off=60.0))(lambda: True)
    host.assumption("B")(lambda: True)
    assert host.cautions == {"A": Caution(hold_off=60.0)}
