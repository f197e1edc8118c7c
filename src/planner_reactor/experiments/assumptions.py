"""`assumptions`: are the nine assumptions real? Each, in a world where it holds and in one where it does not.

Two reactors are built: one that rests on all nine, one without the assumption in question (R (8), (12)). Each runs in
both worlds, *unobservant*: nothing is told of any assumption, so that what is seen is what its reactions do, and not
that the reactor disables them. The first must fail where the assumption is false; the second must work in both worlds:
relaxing is monotone. A third column is the product as it is: it begins with all nine, and notices.

A reactor *works* if it costs no kit, and completes at least `ENOUGH` of what the reactor that rests on nothing does in
the same world with the same seed. All runs see the world through its sensors.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import cache, partial
from pathlib import Path
from statistics import NormalDist
from typing import Any, Literal, TypeAlias

import msgspec

from planner_reactor.experiments.loop import Loop, summary
from planner_reactor.experiments.runs import the_domain
from planner_reactor.experiments.trials import interval, run_trials, write_json, write_rows
from planner_reactor.link.messages import Perception
from planner_reactor.planner import Planner
from planner_reactor.runtime import Host, Scheduler
from planner_reactor.trace import Trace
from planner_reactor.workcell import telling
from planner_reactor.workcell.host import host
from planner_reactor.workcell.regimes import SHORT_BELT, Regime
from planner_reactor.workcell.world import World

TRIALS, LASTS = 20, 900.0
"""Seeds; simulated seconds of a run."""

ENOUGH = 2 / 3
"""Of the kits that the careful reactor completes."""

NINE = tuple(telling.MEANING)
NOTHING: tuple[str, ...] = ()

Built: TypeAlias = Literal["trusting", "relaxed", "observant", "careful"]
BUILT: tuple[Built, ...] = ("trusting", "relaxed", "observant", "careful")


class Trial(msgspec.Struct, frozen=True):
    """One run: the reactor without the assumptions `given_up`, where those in `false` are false."""

    built: str
    given_up: tuple[str, ...]
    false: tuple[str, ...]
    seed: int
    lasts: float = LASTS
    apart: float = 1.0

    @property
    def observes(self) -> bool:
        return self.built == "observant"


def experiment(
    out: Path, *, trials: int | None, workers: int, watch: Callable[[int, int], object]
) -> Mapping[str, Any]:
    """The registry's entry: `assumptions.csv` (a row for each run), `assumptions.json` and the figure in `out`."""
    from planner_reactor.experiments.figures_assumptions import draw

    chosen = list(all_trials(range(1, (trials or TRIALS) + 1)))
    rows = run_trials(one, chosen, workers=workers, watch=watch)
    found = {"trials": trials or TRIALS, "seconds": LASTS, "table": table(rows), "verdicts": verdicts(rows)}
    write_rows(out / "assumptions.csv", rows)
    write_json(out / "assumptions.json", found)
    draw(found["table"], out)  # type: ignore[arg-type]  # the lines of just now
    return found


def all_trials(seeds: Sequence[int]) -> Iterator[Trial]:
    """Every reactor in every world that it is asked about; the world in which all hold is the same for all nine."""
    for seed in seeds:
        yield Trial("trusting", NOTHING, NOTHING, seed)
        yield Trial("careful", NINE, NOTHING, seed)
        for name in NINE:
            yield Trial("relaxed", (name,), NOTHING, seed)
            yield Trial("trusting", NOTHING, (name,), seed)
            yield Trial("relaxed", (name,), (name,), seed)
            yield Trial("observant", NOTHING, (name,), seed)
            yield Trial("careful", NINE, (name,), seed)


def one(trial: Trial) -> dict[str, Any]:
    """One run as a row."""
    loop = running(trial)
    loop.run(until=trial.lasts)
    found = summary(loop)
    completed, lost = telling.counted(found)
    return {
        "built": trial.built, "given_up": list(trial.given_up), "false": list(trial.false), "seed": trial.seed,
        "completed": completed, "lost": lost, "spoiled": found["parts"]["rejected"], "struck": len(found["faults"]),
        "rests_on": list(found["assumptions"]["reactor"]), "violations": len(found["violations"]),
        "interruptions": found["interruptions"],
    }  # fmt: skip


def running(trial: Trial) -> Loop:
    """The run, about to begin."""
    planner = Planner(_domain(), relax=(), verify=False)
    for number, name in enumerate(trial.given_up):
        planner.perceive(Perception(number=number + 1, time=0.0, kind="assumption_failure", subject=name))
    loop = Loop(planner, partial(cell, observes=trial.observes), seed=trial.seed, keep_trace=False)
    world = loop.host.world
    assert isinstance(world, World)
    Regime(trial.false, apart=trial.apart).begin(world, loop.scheduler)
    return loop


def cell(scheduler: Scheduler, trace: Trace, *, observes: bool) -> Host:
    """The cell; unless the reactor `observes`, nobody senses anything of assumptions. Processes see what they see."""
    made = host(scheduler, kit=SHORT_BELT, trace=trace)
    if not observes:
        made.assumptions.clear()
        made.report = _unheard  # type: ignore[method-assign]
    return made


def _unheard(assumption: str, holds: bool, evidence: str = "") -> None:
    """What a process notices of an assumption is told nobody."""


@cache
def _domain() -> Any:
    return the_domain()


# -------------------------------------------------------------------------------------------------- the table


def table(rows: Sequence[Mapping[str, Any]]) -> list[dict[str, Any]]:
    """For each assumption, world and reactor: means over seeds with 95 % intervals, and how often it worked."""
    return [
        _line(rows, name, built, holds)
        for name in NINE
        for built in BUILT
        for holds in (True, False)
        if not (built == "observant" and holds)
    ]


def _line(rows: Sequence[Mapping[str, Any]], name: str, built: Built, holds: bool) -> dict[str, Any]:
    mine = sorted(_runs(rows, name, built, holds), key=lambda row: row["seed"])
    careful = {row["seed"]: row for row in _runs(rows, name, "careful", holds)}
    worked = sum(works(row, careful[row["seed"]]) for row in mine)
    low, high = share_interval(worked, len(mine))
    completed, lost, spoiled = (interval([row[key] for row in mine]) for key in ("completed", "lost", "spoiled"))
    return {
        "assumption": name, "reactor": built, "world": "holds" if holds else "fails", "runs": len(mine),
        "completed": completed[0], "completed_ci95": completed[1], "lost": lost[0], "lost_ci95": lost[1],
        "spoiled": spoiled[0], "works": round(worked / len(mine), 3), "works_low": low, "works_high": high,
        "violations": sum(row["violations"] for row in mine),
    }  # fmt: skip


def _runs(rows: Sequence[Mapping[str, Any]], name: str, built: str, holds: bool) -> list[Mapping[str, Any]]:
    false = [] if holds else [name]
    given_up = [name] if built == "relaxed" else list(NINE) if built == "careful" else []
    return [r for r in rows if (r["built"], r["false"], r["given_up"]) == (built, false, given_up)]


def works(row: Mapping[str, Any], careful: Mapping[str, Any]) -> bool:
    """Did it cost no kit, and complete enough?"""
    return bool(row["lost"] == 0 and row["completed"] >= max(1.0, ENOUGH * careful["completed"]))


def verdicts(rows: Sequence[Mapping[str, Any]]) -> list[dict[str, Any]]:
    """Is each assumption real? (8), (12): the first reactor works where it holds alone, the second everywhere."""
    lines = {(row["assumption"], row["reactor"], row["world"]): row for row in table(rows)}
    return [
        {
            "assumption": name,
            "trusting_where_it_holds": lines[name, "trusting", "holds"]["works"],
            "trusting_where_it_fails": lines[name, "trusting", "fails"]["works"],
            "relaxed_where_it_holds": lines[name, "relaxed", "holds"]["works"],
            "relaxed_where_it_fails": lines[name, "relaxed", "fails"]["works"],
            "real": [lines[name, b, w]["works"] for b in ("trusting", "relaxed") for w in ("holds", "fails")]
            == [1.0, 0.0, 1.0, 1.0],
        }
        for name in NINE
    ]


def share_interval(successes: int, of: int) -> tuple[float, float]:
    """Wilson's 95 % interval of a share; it has a width even when all or none succeed."""
    if not of:
        return 0.0, 1.0
    z = NormalDist().inv_cdf(0.975)
    share, square = successes / of, z * z / of
    middle = (share + square / 2) / (1 + square)
    half = z / (1 + square) * ((share * (1 - share) + square / 4) / of) ** 0.5
    return round(max(0.0, middle - half), 3), round(min(1.0, middle + half), 3)
