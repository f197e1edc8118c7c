"""`picking`: parts that slide away, picked by a derived reaction and by the hand-written one (X §5.2; AM relaxed).

The kitting cell, with assumption AM given up from the start, makes kits while parts slide away under the closing
gripper. By hand: `Track[x] # Get[x]`, two processes in Python. Derived: the same domain without these two, and with
LOOK, MOVETOWARDS and CONTACT, which follow from guarded_move.rsl, so that the planner finds the paper's GuardedMove
between `Over` and `Close`. Same seeds, same faults, same arm.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import lru_cache, partial
from pathlib import Path
from typing import Any, Literal, TypeAlias

import msgspec

from planner_reactor.experiments.loop import Loop, summary
from planner_reactor.experiments.trials import interval, run_trials, write_json, write_rows
from planner_reactor.link.messages import Perception
from planner_reactor.logic.domain import Domain
from planner_reactor.logic.reader import read_domain
from planner_reactor.planner.planner import Planner
from planner_reactor.planner.servos import Model, exploiting
from planner_reactor.workcell.domains import SHIPPED, shipped_domain, without_tracking
from planner_reactor.workcell.environments.dynamics import host as sight
from planner_reactor.workcell.environments.dynamics import model
from planner_reactor.workcell.environments.exploits import JOINT
from planner_reactor.workcell.faults import Fault, FaultSchedule
from planner_reactor.workcell.host import host
from planner_reactor.workcell.servo import TIMING

By: TypeAlias = Literal["hand", "derived"]

WAYS: tuple[By, ...] = ("hand", "derived")
TRIALS = 20
KITS, LONGEST = 10, 3000.0
"""Kits of a run, and seconds that it may take."""

SLIDES: tuple[int, ...] = (0, 1, 2, 4)
"""How often in a row a part slides away, each time that one does."""

EVERY = 20.0
"""Seconds between two parts that slide away."""


class Trial(msgspec.Struct, frozen=True):
    by: By
    slides: int
    seed: int
    kits: int = KITS


def experiment(
    out: Path, *, trials: int | None, workers: int, watch: Callable[[int, int], object]
) -> Mapping[str, Any]:
    """The registry's entry: `picking.csv`, `picking.json` in `out`."""
    seeds = range(1, (trials or TRIALS) + 1)
    chosen = [Trial(by, slides, seed) for slides in SLIDES for by in WAYS for seed in seeds]
    rows = run_trials(one, chosen, workers=workers, watch=watch)
    ways = [_line(rows, by, n) for n in SLIDES for by in WAYS]
    found = {"runs": len(seeds), "kits": KITS, "ways": ways}
    write_rows(out / "picking.csv", rows)
    write_json(out / "picking.json", found)
    return found


@lru_cache
def domain_for(by: By) -> Domain:
    """The domain of the cell, with the hand-written way to pick what moves or with what a model yields."""
    if by == "hand":
        return read_domain(shipped_domain(), file=SHIPPED)
    reach = Model(
        text=f"{model('guarded_move')}\n{JOINT}",
        environment="GEM",
        signatures=sight.signatures,
        given=TIMING,
        interface=("sense1", "touch", "move", "joint"),
        patience_ms=10_000,
    )
    return exploiting(without_tracking(shipped_domain()), [reach], file=SHIPPED)


def begun(trial: Trial) -> Loop:
    """The loop of a trial: AM is known not to hold."""
    planner = Planner(domain_for(trial.by), relax=())
    planner.perceive(Perception(number=1, time=0.0, kind="assumption_failure", subject="AM"))
    make = partial(host, target=trial.kits, servo=trial.by == "derived")
    return Loop(planner, lambda scheduler, trace: make(scheduler, trace=trace), seed=trial.seed)


def one(trial: Trial) -> dict[str, Any]:
    """A row: how long the kits took, and what went wrong on the way."""
    loop = begun(trial)
    world = loop.host.world
    assert world is not None
    slides = {"count": trial.slides, "closing": True}
    faults = [Fault(at=30.0 + n * EVERY, kind="part_moved", parameters=slides) for n in range(int(LONGEST / EVERY))]
    schedule = FaultSchedule(tuple(faults) if trial.slides else (), world, loop.scheduler)
    loop.run(until=LONGEST)
    came_to = summary(loop)
    struck = len(faults) - len(schedule.unstruck()) if trial.slides else 0
    return {
        "by": trial.by, "slides": trial.slides, "seed": trial.seed, "kits": came_to["kits"]["completed"],
        "rejected": came_to["kits"]["rejected"], "per_kit_s": loop.scheduler.now / max(1, came_to["kits"]["completed"]),
        "struck": struck, "failures": len([e for e in loop.trace.of("ended") if not e.data["ok"]]),
        "violations": len(came_to["violations"]), "interruptions": came_to["interruptions"],
    }  # fmt: skip


def _line(rows: Sequence[Mapping[str, Any]], by: By, slides: int) -> dict[str, Any]:
    mine = [r for r in rows if (r["by"], r["slides"]) == (by, slides)]
    seconds, half = interval([r["per_kit_s"] for r in mine])
    counted = ("kits", "rejected", "struck", "failures", "violations", "interruptions")
    return {"by": by, "slides": slides, "per_kit_s": seconds, "half_s": half,
            **{key: sum(r[key] for r in mine) for key in counted}}  # fmt: skip
