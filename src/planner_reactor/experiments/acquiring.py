"""`acquiring`: are objects acquired by reactions that were found from models of the environment? (X §5.2, §5.3)

    move     GEM: the object moves at random, nothing brings it; GuardedMove has to reach it
    wait     BEM: a belt brings it; GuardedWait has to wait, and needs no motion
    switch   a belt that others stop and start, for 300 s: the reaction changes by adaptation each time

In each the planner derives the actions, finds the reaction and sends it; nothing is written by hand. Where object
and robot begin, how the object moves and when the belt stops differ from seed to seed. A run of `move` or `wait`
succeeds if the object is in the hand within 60 s. `contact_s` is when the hand closed on it.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from random import Random
from statistics import mean
from typing import Any, Literal, TypeAlias

import msgspec

from planner_reactor.experiments.servoing import Played, Scene, play
from planner_reactor.experiments.trials import middle, run_trials, write_json, write_rows

Way: TypeAlias = Literal["move", "wait", "switch"]

TRIALS = 1000
SWITCHING = 25
"""So many times fewer runs of `switch` than of the others: each is a long one."""

SHOWN = 13
"""The seed of the run of `switch` that is drawn."""

WITHIN, LONG = 60.0, 300.0
"""Seconds: in which an object must be acquired; that a run of `switch` lasts."""

OVERHEAD = {"field": 30.0}
"""A camera over the belt sees all of it."""


class Trial(msgspec.Struct, frozen=True):
    way: Way
    seed: int
    lasts: float = LONG


def experiment(
    out: Path, *, trials: int | None, workers: int, watch: Callable[[int, int], object]
) -> Mapping[str, Any]:
    """The registry's entry: `acquiring.csv`, `switching.csv`, `acquiring.json`, figures `contact` and `switching`."""
    from planner_reactor.experiments.figures_servo import draw_contact, draw_switching

    count = trials or TRIALS
    chosen = [Trial(way, seed) for way in ("move", "wait") for seed in range(1, count + 1)]
    changing = [Trial("switch", seed) for seed in range(1, max(1, count // SWITCHING) + 1)]
    rows = run_trials(one, [*chosen, *changing], workers=workers, watch=watch)
    single, long = rows[: len(chosen)], rows[len(chosen) :]
    found = {"ways": [_line(single, way) for way in ("move", "wait")], "switch": _switched(long)}
    write_rows(out / "acquiring.csv", single)
    write_rows(out / "switching.csv", long)
    write_json(out / "acquiring.json", found)
    draw_contact(single, out)
    draw_switching(story(play(scene(Trial("switch", SHOWN)))), out)
    return found


def scene(trial: Trial) -> Scene:
    """What begins where, from the seed."""
    chance = Random(f"acquiring/{trial.way}/{trial.seed}")
    if trial.way == "move":
        p = chance.uniform(-5.0, 5.0)
        starts = {"p": p, "a": p, "pr": p + chance.choice((-1, 1)) * chance.uniform(1.0, 8.0)}
        return Scene(kind="reaching", starts=starts, constants={"eps": 0.3}, seed=trial.seed, target=1, until=WITHIN)
    starts = {"p": 0.0, "a": 0.0, "pr": 0.5 * chance.randint(3, 22), "s": 1.0}
    if trial.way == "wait":
        return Scene(kind="line", starts=starts, constants=OVERHEAD, seed=trial.seed, target=1, until=WITHIN)
    strikes, now, runs = [], 0.0, True
    while (now := now + chance.uniform(8.0, 40.0)) < trial.lasts - 40.0:
        runs = not runs
        strikes.append((now, runs))
    return Scene(kind="line", starts=starts, constants=OVERHEAD, seed=trial.seed, strikes=strikes, until=trial.lasts)


def one(trial: Trial) -> dict[str, Any]:
    """A row: what became of the objects, with how many grips and motions."""
    run = play(scene(trial))
    gauge, reactor = run.world.gauge, run.loop.reactor
    row: dict[str, Any] = {
        "way": trial.way, "seed": trial.seed, "taken": gauge.taken, "lost": gauge.lost, "there": gauge.there,
        "grips": len(gauge.grips), "moves": gauge.moves, "violations": [str(v) for v in reactor.laws.violations],
        "interruptions": reactor.laws.interruptions,
    }  # fmt: skip
    if trial.way != "switch":
        return row | {"contact_s": gauge.acquired[0] if gauge.acquired else None}
    changes = _changes(run)
    return row | {"strikes": len(run.scene.strikes), "changes": len(changes),
                  "latency_s": [round(c["latency_s"], 3) for c in changes]}  # fmt: skip


def _changes(run: Played) -> list[dict[str, Any]]:
    """The adaptations that exchanged the reaction for Acquire, each with its delay after the belt's last strike."""
    found = []
    for event in run.loop.trace.events:
        if event.kind == "adaptation_applied" and "Acquire" in event.data["purpose"]:
            before = [when for when, _ in run.scene.strikes if when <= event.time]
            if before:
                moves = "Running" not in event.data["assumptions"]
                found.append({"at_s": event.time, "moves": moves, "latency_s": event.time - before[-1]})
    return found


def _line(rows: Sequence[Mapping[str, Any]], way: Way) -> dict[str, Any]:
    mine = [r for r in rows if r["way"] == way]
    times = [r["contact_s"] for r in mine if r["contact_s"] is not None]
    return {
        "way": way, "runs": len(mine), "acquired": len(times), "share": len(times) / len(mine),
        "at_first_grip": sum(r["grips"] == 1 and r["taken"] == 1 for r in mine),
        "mean_s": round(mean(times), 3), "p95_s": middle(times, 0.95), "moves": sum(r["moves"] for r in mine),
        "violations": sum(len(r["violations"]) for r in mine), "interruptions": sum(r["interruptions"] for r in mine),
    }  # fmt: skip


def _switched(rows: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    waits = [latency for r in rows for latency in r["latency_s"]]
    return {
        "runs": len(rows), "strikes": sum(r["strikes"] for r in rows), "changes": len(waits),
        "taken": sum(r["taken"] for r in rows), "lost": sum(r["lost"] for r in rows),
        "median_s": middle(waits), "p95_s": middle(waits, 0.95),
        "violations": sum(len(r["violations"]) for r in rows), "interruptions": sum(r["interruptions"] for r in rows),
    }  # fmt: skip


def story(run: Played) -> dict[str, Any]:
    """One run of `switch` for the figure: where object and robot were, when the belt ran, what was in place."""
    gauge = run.world.gauge
    return {"lasts": run.scene.until, "strikes": list(run.scene.strikes), "object": gauge.courses["p"],
            "robot": gauge.courses["pr"], "acquired": gauge.acquired, "changes": _changes(run)}  # fmt: skip
