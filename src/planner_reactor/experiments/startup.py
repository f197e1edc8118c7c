"""`startup`: how long the planner takes, measured: to the first adaptation, to the first ideal reactor, to relax.

Its real processor time is charged to the clock of the run. Waiting for the reactor is not thinking, so relaxations are
measured by the steps made for them. Times are in milliseconds, medians over the trials.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from planner_reactor.experiments.runs import Run, perform, the_domain
from planner_reactor.experiments.timing import Measured
from planner_reactor.experiments.trials import middle, run_trials, write_json
from planner_reactor.planner.planner import Step

TRIALS = 20
UNTIL = 60.0
"""Seconds after which a run of ours has relaxed whatever there is."""

AIMS_MS = {"first adaptation": 5.0, "first ideal reactor": 50.0}
RELAXATION_AIM_MS = 20.0


class Noted(Measured):
    """The processor time of each step, and for the sake of which assumption it was spent."""

    def __init__(self) -> None:
        self.spent: dict[str, float] = {}

    def seconds(self, step: Step, outstanding: int, cpu: float) -> float:
        if step.assumption:
            self.spent[step.assumption] = self.spent.get(step.assumption, 0.0) + cpu
        return cpu


def experiment(
    out: Path, *, trials: int | None, workers: int, watch: Callable[[int, int], object]
) -> Mapping[str, Any]:
    """The registry's entry: `startup.json` in `out`."""
    seeds = range(1, (trials or TRIALS) + 1)
    rows = run_trials(one, list(seeds), workers=workers, watch=watch)
    names = list(dict.fromkeys(name for row in rows for name in row))
    found = {"trials": len(rows), "times": [_line(name, [row[name] for row in rows if name in row]) for name in names]}
    write_json(out / "startup.json", found)
    return found


def one(seed: int) -> dict[str, float]:
    """Milliseconds by what was reached, of one run."""
    began = time.process_time()
    domain = the_domain()
    read = time.process_time()
    noted = Noted()
    ran = perform(Run(seed=seed, planner_time=noted, until=UNTIL), domain=domain)
    marks = ran.loop.milestones
    found = {"domain read": 1000 * (read - began)}
    reached = {
        "first adaptation": marks.first_adaptation_issued_s,
        "first reactor": marks.first_reactor_s,
        "first ideal reactor": marks.first_ideal_s,
    }
    found |= {name: 1000 * when for name, when in reached.items() if when is not None}
    return found | {f"relax {name}": 1000 * spent for name, spent in noted.spent.items()}


def _line(name: str, values: list[float]) -> dict[str, Any]:
    aim = RELAXATION_AIM_MS if name.startswith("relax ") else AIMS_MS.get(name)
    return {
        "what": name,
        "median_ms": round(middle(values) or 0.0, 2),
        "p90_ms": round(middle(values, 0.9) or 0.0, 2),
        "aim_ms": aim,
    }
