"""`tracking`: does TRACK keep a randomly moving object in view, and when does it not? (X §4.4.2, §5.1)

A planner derives LOOK and MOVECAMERA from the text of TEM and finds TRACK; the reactor gets it and runs it in that
world. What is measured is the share of samples in which the object is in view of the camera, by the truth of the world.
The object moves every t0 = 1 s, by up to 0.9 of what the camera sees to either side: one step never leads out of view,
two may. The sensor's period is swept; `analysis.timing` predicts from the texts alone where TRACK begins to fail: where
one time around the loop is as long as the object stands, and where the printed constraint on periods ends.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from statistics import mean
from typing import Any

import msgspec

from planner_reactor.analysis.denseness import opened
from planner_reactor.analysis.timing import Check, stability
from planner_reactor.experiments.servoing import Played, Scene, domain_for, play
from planner_reactor.experiments.trials import run_trials, write_json, write_rows
from planner_reactor.planner.inlining import Inliner
from planner_reactor.rs.given import process_with_values
from planner_reactor.rs.parser import parse_process, parse_program
from planner_reactor.rs.printer import show
from planner_reactor.rs.terms import Symbol
from planner_reactor.rs.unknowns import Unknown
from planner_reactor.workcell.environments.dynamics import host, model
from planner_reactor.workcell.environments.worlds import MEASURES, TIMING

TRIALS = 20
RATIOS = (0.2, 0.4, 0.6, 0.7, 0.8, 0.85, 0.9, 0.95, 1.0, 1.1, 1.2, 1.4, 1.7, 2.0, 2.5, 3.0)
"""Periods of the sensor (gl + tl) in the sweep, in seconds; the object moves once a second."""

LASTS, BEGINS, SAMPLE = 120.0, 0.5, 0.05
"""Seconds: of a run, before the first sample (TRACK is in place by then), between two samples."""


class Trial(msgspec.Struct, frozen=True):
    period: float
    seed: int
    lasts: float = LASTS


def experiment(
    out: Path, *, trials: int | None, workers: int, watch: Callable[[int, int], object]
) -> Mapping[str, Any]:
    """The registry's entry: `tracking.csv`, `tracking.json`, the figures `tracking_error` and `tracking_sweep`."""
    from planner_reactor.experiments.figures_servo import draw_error, draw_sweep

    seeds = range(1, (trials or TRIALS) + 1)
    chosen = [Trial(period, seed) for period in RATIOS for seed in seeds]
    rows = run_trials(one, chosen, workers=workers, watch=watch)
    found = {"trials": len(seeds), "boundary": predicted(), "sweep": [_line(rows, period) for period in RATIOS]}
    write_rows(out / "tracking.csv", rows)
    write_json(out / "tracking.json", found)
    courses = [course(played(Trial(period, 1, 40.0))) for period in (RATIOS[0], 1.4)]
    draw_error(courses, MEASURES["field"], out)
    draw_sweep(found["sweep"], found["boundary"], out)  # type: ignore[arg-type]  # the lines of just now
    return found


def constants_for(period: float) -> dict[str, float]:
    """The world in which the sensor has this period, most of it the time for which it holds a value."""
    return {"tl": round(period - TIMING["gl"], 6)}


def played(trial: Trial) -> Played:
    """One run in which it is known from the start that the object moves."""
    return play(
        Scene(
            kind="tracking",
            starts={"p": 0.0, "a": 0.0},
            constants=constants_for(trial.period),
            seed=trial.seed,
            until=trial.lasts,
            without=("Still",),
        )
    )


def one(trial: Trial) -> dict[str, Any]:
    """The share of samples in view, and when the object first was not."""
    told = course(played(trial))
    seen = [abs(p - a) <= MEASURES["field"] for p, a in zip(told["object"], told["camera"], strict=True)]
    lost = next((t for t, s in zip(told["at"], seen, strict=True) if not s), None)
    return {"period": trial.period, "seed": trial.seed, "in_view": mean(seen), "lost_at_s": lost}


def course(run: Played) -> dict[str, Any]:
    """Where the object was and where the camera looked, sample by sample."""
    count = int((run.scene.until - BEGINS) / SAMPLE)
    instants = [BEGINS + n * SAMPLE for n in range(count)]
    gauge = run.world.gauge
    period = run.scene.constants["tl"] + TIMING["gl"]
    return {"period": period, "at": instants, "object": gauge.samples("p", instants),
            "camera": gauge.samples("a", instants)}  # fmt: skip


def _line(rows: Sequence[Mapping[str, Any]], period: float) -> dict[str, Any]:
    mine = [r for r in rows if r["period"] == period]
    shares = [r["in_view"] for r in mine]
    kept = sum(r["in_view"] >= 0.99 for r in mine)
    return {"period": period, "mean": mean(shares), "least": min(shares), "kept": kept, "runs": len(mine)}


# ------------------------------------------------------------------------------------------------ the prediction


def checks(period: float) -> tuple[Check, ...]:
    """What the analysis says of TRACK in the world where the sensor has this period, from the texts alone."""
    given = {**TIMING, **MEASURES, **constants_for(period)}
    domain = domain_for("tracking", tuple(sorted(constants_for(period).items())))
    inliner = Inliner()
    parts = [show(inliner.process(domain.schemas[name].process, (Symbol("p"),))) for name in ("LOOK", "MOVECAMERA")]
    text = f"{model('tracking')}\nTRACK = {parts[0]} | {parts[1]}\n"
    world = opened(parse_program(text), host.signatures, given=given)
    reaction = [parse_process(name) for name in ("TRACK", "sense1", "motor1")]
    begun = process_with_values(parse_process("TEM[p, a]"), {"p": Unknown("p", -1), "a": Unknown("a", -1)})
    return stability(begun, reaction, world).checks


def predicted() -> dict[str, float]:
    """The least period of the sensor (seconds) at which each of the constraints fails."""
    names = [check.name for check in checks(RATIOS[0])]
    return {name: round(_fails_from(name), 4) for name in dict.fromkeys(names)}


def _fails_from(name: str) -> float:
    low, high = 0.03, 10.0
    for _ in range(24):
        middle = (low + high) / 2
        if all(check.holds for check in checks(middle) if check.name == name):
            low = middle
        else:
            high = middle
    return high
