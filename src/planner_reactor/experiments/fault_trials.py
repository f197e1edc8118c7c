"""`faults`: runs by the hundred, each with faults of its own at random, with relaxing and without.

Several assumptions are broken while the planner relaxes by choice as well: by seed it is quick or slow, and may relax
all or only some without need, so that both kinds of relaxation mix. Every fault has to strike and to be sensed, every
run to complete what it was asked for, and no law may be broken; what was rejected is counted with the fault that cost
it. The run that relaxes nothing is given as long as the one that does took.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path
from random import Random
from typing import Any

import msgspec

from planner_reactor.experiments.runs import Faults, Ran, Relax, Run, perform, the_domain
from planner_reactor.experiments.schedules import at_random
from planner_reactor.experiments.trials import interval, middle, run_trials, write_json, write_rows
from planner_reactor.workcell import telling

TRIALS, PRODUCTS, FAULTS = 50, 15, 6
BEGIN, END = 5.0, 400.0
"""Seconds between which faults are due."""

PATIENCE = 6000.0
"""Seconds after which a run that has not completed what it was asked for is given up."""


PLANNER_S = (0.001, 0.1, 1.0)
"""Seconds that a planner takes for a step, one of which a trial has."""


class Trial(msgspec.Struct, frozen=True):
    """One seed, for the world and for the faults; how long a planner's step takes; what is relaxed by choice."""

    seed: int
    products: int = PRODUCTS
    faults: int = FAULTS
    planner_s: float = PLANNER_S[0]
    by_choice: Relax = "all"


def drawn(seed: int, assumptions: Sequence[str]) -> Trial:
    """The trial of a seed: half of them relax all by choice, the others some."""
    draw = Random(f"trial {seed}")
    some = tuple(name for name in assumptions if draw.random() < 0.5)
    return Trial(seed, planner_s=draw.choice(PLANNER_S), by_choice=draw.choice(("all", some)))


def experiment(
    out: Path, *, trials: int | None, workers: int, watch: Callable[[int, int], object]
) -> Mapping[str, Any]:
    """The registry's entry: `faults.csv` (a row for each seed) and `faults.json` in `out`; returns the latter."""
    names = list(the_domain().assumptions)
    chosen = [drawn(seed, names) for seed in range(1, (trials or TRIALS) + 1)]
    rows = run_trials(one, chosen, workers=workers, watch=watch)
    found = summary(rows)
    write_rows(out / "faults.csv", [row["plain"] for row in rows])
    write_json(out / "faults.json", found)
    return found


def one(trial: Trial) -> dict[str, Any]:
    """One trial: its row, and the faults of its two runs."""
    with_all = _ran(trial, trial.by_choice, until=PATIENCE)
    with_none = _ran(trial, "none", until=with_all.came_to["simulated_s"])
    completed, rejected = telling.counted(with_all.came_to)
    without = telling.counted(with_none.came_to)
    struck = with_all.came_to["faults"]
    unsensed = [fault["kind"] for fault in struck if fault["sensed_s"] is None]
    violations = list(with_all.came_to["violations"])
    plain = {
        "seed": trial.seed,
        "planner_s": trial.planner_s,
        "by_choice": "all" if trial.by_choice == "all" else list(trial.by_choice),
        "faults": [f"{fault['kind']}@{fault['struck_s']:.0f}" for fault in struck],
        "completed": completed,
        "rejected": rejected,
        "lost_to": _lost_to(with_all),
        "unstruck": list(with_all.unstruck),
        "unsensed": unsensed,
        "violations": len(violations),
        **_relaxations(with_all),
        "simulated_s": round(with_all.came_to["simulated_s"], 1),
        "completed_relaxing_none": without[0],
        "rejected_relaxing_none": without[1],
        "lost_to_relaxing_none": _lost_to(with_none),
        "ok": completed == trial.products and not (unsensed or with_all.unstruck or violations),
    }
    return {"plain": plain, "struck": list(struck), "without": list(with_none.came_to["faults"])}


def _relaxations(ran: Ran) -> dict[str, int]:
    causes = Counter(relaxation["cause"] for relaxation in ran.came_to["relaxations"])
    return {cause: causes[cause] for cause in ("normal", "forced", "reinstated")}


def _ran(trial: Trial, relax: Relax, *, until: float) -> Ran:
    faults: Faults = partial(
        at_random,
        seed=trial.seed,
        count=trial.faults,
        begin=BEGIN,
        end=END,
        endless=telling.ENDLESS,
        leave_out=telling.ENDING,
    )
    return perform(
        Run(
            seed=trial.seed,
            relax=relax,
            planner_time=trial.planner_s,
            faults=faults,
            products=trial.products,
            until=until,
        )
    )


def _lost_to(ran: Ran) -> list[str]:
    return [kind for loss in telling.lost(ran.came_to) for kind in loss.faults or ("nobody",)]


def summary(rows: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """What all trials come to: totals, with 95 % confidence intervals, and each kind of fault by itself."""
    plain = [row["plain"] for row in rows]
    return {
        "trials": len(plain),
        "ok": sum(row["ok"] for row in plain),
        "failed_seeds": [row["seed"] for row in plain if not row["ok"]],
        "relaxing": [_totals("as need be", plain, ""), _totals("none", plain, "_relaxing_none")],
        "relaxations": {c: sum(row[c] for row in plain) for c in ("normal", "forced", "reinstated")},
        "kinds": _kinds(rows),
    }


def _totals(relax: str, plain: Sequence[Mapping[str, Any]], suffix: str) -> dict[str, Any]:
    completed = interval([row[f"completed{suffix}"] for row in plain])
    rejected = interval([row[f"rejected{suffix}"] for row in plain])
    return {
        "relaxed": relax,
        "completed": sum(row[f"completed{suffix}"] for row in plain),
        "completed_mean": completed[0],
        "completed_ci95": completed[1],
        "rejected": sum(row[f"rejected{suffix}"] for row in plain),
        "rejected_mean": rejected[0],
        "rejected_ci95": rejected[1],
    }


def _kinds(rows: Sequence[Mapping[str, Any]]) -> list[dict[str, Any]]:
    struck = [fault for row in rows for fault in row["struck"]]
    lost = Counter(kind for row in rows for kind in row["plain"]["lost_to"])
    lost_without = Counter(kind for row in rows for kind in row["plain"]["lost_to_relaxing_none"])
    return [
        {
            "kind": kind,
            "breaks": next((f["breaks"] for f in struck if f["kind"] == kind), ""),
            "struck": sum(f["kind"] == kind for f in struck),
            "sensed": sum(f["kind"] == kind and f["sensed_s"] is not None for f in struck),
            "sensed_after_s": _rounded(
                middle(f["sensed_s"] - f["struck_s"] for f in struck if f["kind"] == kind and f["sensed_s"] is not None)
            ),
            "lost": lost[kind],
            "lost_relaxing_none": lost_without[kind],
        }
        for kind in sorted({fault["kind"] for fault in struck} | set(lost) | set(lost_without))
    ]


def _rounded(value: float | None) -> float | None:
    return None if value is None else round(value, 2)
