"""`reactors`: every reactor that the planner may ever build here runs in the cell, with its assumptions true and false.

Nine assumptions, held or not, are 2⁹ sets; many lead to the same reactor, and each distinct one is run in three worlds.
*True*: its own assumptions hold and all others are false, which is the hardest world that (12) of R §6.2 asks it to
cope with; nothing is told to it. *All true*: it must also be right where what it does not count on holds (8). *False*:
nothing holds; it observes, and a planner adapts it. There it need not work, but no law may be broken and nothing
interrupted.

A reactor works if it costs no kit and completes, on average over seeds, at least `ENOUGH` of what the reactor that
rests on nothing does in the worst world, in which all nine are false.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import combinations
from pathlib import Path
from statistics import fmean
from typing import Any

from planner_reactor.experiments.assumptions import ENOUGH, NINE, Trial, one
from planner_reactor.experiments.runs import the_domain
from planner_reactor.experiments.trials import interval, run_trials, write_json, write_rows
from planner_reactor.link.messages import Perception, PerceptionKind
from planner_reactor.logic.domain import Domain
from planner_reactor.planner import Planner

APART = 3.0
"""Where several are false at once, each is broken so many times as rarely."""

SEEDS = 2


def experiment(
    out: Path, *, trials: int | None, workers: int, watch: Callable[[int, int], object]
) -> Mapping[str, Any]:
    """The registry's entry: `reactors.csv` (a row for each run) and `reactors.json` in `out`; `trials`: seeds."""
    found = distinct(subsets())
    chosen = list(trials_of(found, range(1, (trials or SEEDS) + 1)))
    rows = run_trials(one, chosen, workers=workers, watch=watch)
    said = summary(rows, len(found))
    write_rows(out / "reactors.csv", rows)
    write_json(out / "reactors.json", said)
    return said


def subsets() -> Iterator[tuple[str, ...]]:
    """What may be given up: all 2⁹ sets, the smallest first."""
    for many in range(len(NINE) + 1):
        yield from combinations(NINE, many)


def distinct(given_up: Iterator[tuple[str, ...]]) -> dict[tuple[str, ...], frozenset[str]]:
    """For each distinct reactor the first set that leads to it, and the assumptions that it rests on."""
    domain, known, found = the_domain(), set(), {}
    for names in given_up:
        texts, rests_on = planned(domain, names)
        if texts not in known:
            known.add(texts)
            found[names] = rests_on
    return found


def planned(domain: Domain, given_up: Sequence[str]) -> tuple[tuple[tuple[str, str], ...], frozenset[str]]:
    """The reactor without these assumptions, as texts of reactions by situation, and what it rests on."""
    planner, told = Planner(domain, relax=(), verify=False), 0

    def tell(kind: PerceptionKind, subject: str) -> None:
        nonlocal told
        told += 1
        planner.perceive(Perception(number=told, time=0.0, kind=kind, subject=subject))

    for name in given_up:
        tell("assumption_failure", name)
    while (step := planner.step()) is not None:
        for adaptation in step.adaptations:
            tell("adaptation_applied", str(adaptation.id))
    texts = tuple(sorted((segment.name, segment.text) for segment in planner.model))
    return texts, frozenset().union(*(segment.required for segment in planner.model))


def trials_of(found: Mapping[tuple[str, ...], frozenset[str]], seeds: Sequence[int]) -> Iterator[Trial]:
    """The runs of every reactor, in its hardest world with every seed; and of the one to compare with."""
    for seed in seeds:
        yield Trial("careful", NINE, NINE, seed, apart=APART)
        for given_up, rests_on in found.items():
            yield Trial("true", given_up, tuple(name for name in NINE if name not in rests_on), seed, apart=APART)
            if seed == seeds[0]:
                yield Trial("all true", given_up, (), seed, apart=APART)
                yield Trial("observant", given_up, NINE, seed, apart=APART)


WORLDS = {"true": "its own hold, all others fail", "all true": "all hold", "observant": "all fail, it observes"}


def summary(rows: Sequence[Mapping[str, Any]], reactors: int) -> dict[str, Any]:
    """How many reactors work, by world, and what they make."""
    careful = fmean(row["completed"] for row in rows if row["built"] == "careful")
    lines = {world: _by_reactor(rows, world, careful) for world in WORLDS}
    return {
        "reactors": reactors, "careful_where_all_fail": round(careful, 3),
        "worlds": [_world(WORLDS[world], found) for world, found in lines.items()],
        "failed": [line for world in ("true", "all true") for line in lines[world] if not line["works"]],
    }  # fmt: skip


def _by_reactor(rows: Sequence[Mapping[str, Any]], world: str, careful: float) -> list[dict[str, Any]]:
    """A line for each reactor: means over its seeds."""
    runs: dict[tuple[str, ...], list[Mapping[str, Any]]] = {}
    for row in rows:
        if row["built"] == world:
            runs.setdefault(tuple(row["given_up"]), []).append(row)
    return [
        {
            "without": " ".join(given_up), "seeds": len(mine), "completed": fmean(row["completed"] for row in mine),
            "lost": sum(row["lost"] for row in mine), "violations": sum(row["violations"] for row in mine),
            "interruptions": sum(row["interruptions"] for row in mine),
            "works": not any(row["lost"] for row in mine)
            and fmean(row["completed"] for row in mine) >= ENOUGH * careful,
        }
        for given_up, mine in runs.items()
    ]  # fmt: skip


def _world(world: str, lines: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    completed = interval([line["completed"] for line in lines])
    return {
        "world": world, "reactors": len(lines), "work": sum(line["works"] for line in lines),
        "completed": completed[0], "completed_ci95": completed[1],
        "fewest": min((line["completed"] for line in lines), default=0.0), "lost": sum(line["lost"] for line in lines),
        "violations": sum(line["violations"] for line in lines),
        "interruptions": sum(line["interruptions"] for line in lines),
    }  # fmt: skip
