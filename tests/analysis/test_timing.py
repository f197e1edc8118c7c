"""Does a reaction keep up? What the checks say is what runs of the tracking world show (X §4.4.2)."""

from __future__ import annotations

from random import Random

import pytest

from planner_reactor.analysis.denseness import Denseness, Stage, asked, opened
from planner_reactor.analysis.timing import Stability, stability, sufficiently_dense
from planner_reactor.errors import InputError
from planner_reactor.rs.given import with_values
from planner_reactor.rs.parser import parse_program
from planner_reactor.rs.terms import Call
from planner_reactor.runtime import Aborted, Executer, Host, Scheduler, VirtualClock
from planner_reactor.workcell.environments.dynamics import FIELD, host, model

TRACKING = model("tracking") + "TRACK = IN[s1]<v> :; OUT[m1, v]\n"
TIMING = {"t0": 1.0, "ts0": 0.1, "ts1": 0.05, "gl": 0.01, "tl": 0.005, "gm": 0.03, "tm": 0.005, "eps": 0.9}


def judged(source: str = TRACKING, **given: float) -> Stability:
    world = opened(parse_program(source), host.signatures, given=given)
    reaction = [Call(name) for name in ("TRACK", "sense1", "motor1")]
    return stability(asked("TEM[p, a]", world, {}), reaction, world)


def test_a_reaction_that_is_faster_than_its_environment_is_sufficiently_dense() -> None:
    environment = Denseness("pos", "Camera", "", 0.05, 1.0)
    for delay, resolution, holds in ((0.5, 0.5, True), (0.6, 0.5, False), (0.06, 0.1, True)):
        stages = (Stage("motor1", "angle", delay, resolution, ""),)
        reaction = Denseness("angle", "motor1", "", delay, resolution, stages)
        (period,) = sufficiently_dense(environment, reaction)
        assert period.holds is holds
        _, writes = sufficiently_dense(environment, reaction, writes=True)
        assert (writes.holds, writes.offender) == (False, "motor1")


def test_what_fails_is_told_with_its_numbers_and_the_process_to_blame() -> None:
    assert judged(**TIMING).stable is True
    late = judged(**{**TIMING, "gl": 1.2})
    assert late.stable is False
    assert {c.name: c.offender for c in late.checks if c.holds is False} == {
        "reads": "sense1", "writes": "sense1", "corrects": "sense1", "covers": "Object",
    }  # fmt: skip
    assert "writes angle: 1.23 < 0.15 fails: sense1 contributes most" in [str(c) for c in late.checks]


def test_names_that_are_open_leave_the_answer_open() -> None:
    found = judged()
    assert found.stable is None
    assert "writes angle: gl + gm < ts0 + ts1 is open" in [str(c) for c in found.checks]


def test_a_faster_object_needs_a_faster_loop() -> None:
    corrects = {t0: next(c for c in judged(**{**TIMING, "t0": t0}).checks if c.name == "corrects") for t0 in (0.1, 1.0)}
    assert (corrects[1.0].holds, corrects[0.1].holds) == (True, False)


def test_an_object_that_leaps_out_of_the_field_is_not_covered_however_fast_the_loop() -> None:
    (covers,) = (c for c in judged(**{**TIMING, "eps": 1.1}).checks if c.name == "covers")
    assert (covers.left, covers.right, covers.holds) == (1.1, FIELD, False)


def test_a_reaction_with_no_port_of_the_environment_is_refused() -> None:
    world = opened(parse_program(TRACKING + "Idle = NIL\n"), host.signatures)
    with pytest.raises(InputError, match="reads no port that the environment writes"):
        stability(asked("TEM[p, a]", world, {}), [Call("Idle")], world)


def looks(given: dict[str, float], seed: int, seconds: float = 60.0) -> tuple[int, int]:
    """How often the camera saw the object, and how often it did not, in the executer."""
    seen = [0, 0]
    station = Host("tracking")

    @station.process(window=(0.0, 0.0), name="InView")
    def in_view(p: float, a: float) -> None:
        seen[abs(p - a) > FIELD] += 1
        if abs(p - a) > FIELD:
            raise Aborted("not in view")

    scheduler = Scheduler(VirtualClock(), seed=seed)
    program = with_values(parse_program(TRACKING), given)
    executer = Executer(program, scheduler=scheduler, host=station)
    executer.start("TEM", (0.0, 0.0))
    for name in ("sense1", "motor1", "TRACK"):
        executer.start(name)
    executer.run(until=seconds)
    return seen[0], seen[1]


def random_timing(random: Random) -> dict[str, float]:
    spans = {"t0": (0.3, 1.5), "ts0": (0.02, 0.2), "ts1": (0.01, 0.1), "gl": (0.01, 0.2), "tl": (0.004, 0.1)}
    spans |= {"gm": (0.01, 0.2), "tm": (0.004, 0.05), "eps": (0.3, 0.99)}
    return {name: round(random.uniform(*span), 3) for name, span in spans.items()}


def test_where_every_check_holds_no_run_loses_the_object() -> None:
    random = Random(1)
    timings = [t for t in (random_timing(random) for _ in range(60)) if judged(**t).stable]
    assert len(timings) > 10
    for n, timing in enumerate(timings[:12]):
        seen, lost = looks(timing, n, 30.0)
        assert (seen > 20, lost) == (True, 0), timing


def test_where_the_loop_is_much_too_slow_runs_lose_it() -> None:
    slow = {**TIMING, "gm": 2.5}
    assert judged(**slow).stable is False
    assert sum(looks(slow, seed)[1] > 0 for seed in range(5)) >= 4
