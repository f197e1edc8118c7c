"""Steps that go round at one instant: found where they are, with the loop named, and not where they are not."""

from __future__ import annotations

from planner_reactor.analysis.zeno import zeno
from planner_reactor.rs.given import with_values
from planner_reactor.rs.parser import parse_program
from planner_reactor.runtime import Budgets, Executer, Scheduler, VirtualClock
from planner_reactor.workcell.environments import dynamics
from tests.analysis.models import DURATIONS, Model, read

AS_PRINTED = dynamics.model("tracking").replace("STREAM", "Printed") + "Printed[y, v] = OUT[y, v] :; STOP\n"
"""X §4.1.2 prints STREAM without a pause."""

AGENT = "\nMoving = ThisWorld[0, 0] | STREAM[m1, 0.5] | (IN[s1]<x> :; STOP)\n"


def test_the_tracking_world_as_printed_is_zeno_and_its_loop_is_named() -> None:
    report = zeno(*read(AS_PRINTED, "ThisWorld[p, a]"))
    assert report.loop is not None
    assert "Camera" in report.loop.calls
    assert {label[:1] + label[1][:1] for label in report.loop.labels} == {("COM", "angle")}
    assert report.states < 200  # in place of a clock: far less than a second


def test_with_the_pause_of_stream_no_loop_is_found() -> None:
    """Bodies of `::` in any number make its states infinitely many, so that only so many are looked at."""
    report = zeno(*read(dynamics.model("tracking"), "ThisWorld[p, a]"), limit=60)
    assert report.loop is None
    assert not report.complete


def test_a_small_network_without_a_loop_is_looked_at_whole() -> None:
    report = zeno(*read("Pair = (STREAM[q, 1] # Delay[t0]) | (IN[q]<x> :; Delay[ts0])", "Pair"))
    assert report.loop is None
    assert report.complete


def test_a_loop_that_takes_time_somewhere_is_no_zeno_loop() -> None:
    never: Model = read("Pair = (OUT[q, 1] :; STOP) | (IN[q]<x> :; Delay[1])", "Pair")
    assert zeno(*never).loop is None
    always: Model = read("Pair = (OUT[q, 1] :; STOP) | (IN[q]<x> :; STOP)", "Pair")
    assert zeno(*always).loop is not None


def test_with_the_pause_of_stream_the_tracking_world_runs_to_300_seconds() -> None:
    executer = run(dynamics.model("tracking"), until=300.0)
    assert executer.statistics().time == 300.0
    assert executer.statistics().zeno is None


def test_as_printed_the_tracking_world_is_held_up_in_a_run_too() -> None:
    assert run(AS_PRINTED, until=2.0).statistics().zeno is not None


def run(text: str, *, until: float) -> Executer:
    constants = dict.fromkeys(DURATIONS, 0.5) | {"eps": 0.25, "gm": 0.75}
    program = with_values(parse_program(text + AGENT), constants)
    scheduler = Scheduler(VirtualClock(), seed=1)
    executer = Executer(program, scheduler=scheduler, host=dynamics.host, budgets=Budgets(turns=2_000))
    executer.start("Moving", [])
    executer.run(until=until)
    return executer
