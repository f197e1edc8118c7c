"""The planner's part of the table: each figure, its goal, and what a peer takes for the same work."""

from __future__ import annotations

import sys
from types import ModuleType
from typing import Any

import bench_planner as ours
import kit_task

MODES: tuple[tuple[str, dict[str, Any]], ...] = (("", {}), (", verified", {"verify": True}))
Row = dict[str, Any]
Peers = dict[str, ModuleType]


def planning(peers: Peers) -> list[Row]:
    """All of them; the collector looks no more at what was loaded, as in every run on the wall clock."""
    ours.leave_alone()
    return [*beginnings(peers), *relaxations(peers), *promptness(), *executions(peers)]


def beginnings(peers: Peers) -> list[Row]:
    progress("first adaptation, first ideal reactor")
    whole = {n: of_peers(peers, n) for n in (3, 100)}
    rows = []
    for told, options in MODES:
        rows += [
            row(f"first adaptation, {n} kinds{told}", "ms", ours.first_adaptation(n, **options), goal, whole[n])
            for n, goal in ((3, 5.0), (100, 10.0))
        ]
        ideal = {n: ours.first_ideal(n, **options) for n in (3, 25, 100)}
        rows += [row(f"first ideal reactor, {n} kinds{told}", "ms", ideal[n], 100.0, whole[n]) for n in (3, 100)]
        growth = ours.exponent(ideal[25], ideal[100])
        rows.append(row(f"growth of first ideal, 25 to 100 kinds{told}", "exponent", growth, 1.1, {}))
    for n in (3, 100):
        theirs = {"gtpyhop": peers["gtpyhop"].from_process_start(n)} if "gtpyhop" in peers else {}
        cold = ours.from_process_start(n)
        rows.append(row(f"process start to first adaptation, {n} kinds", "ms", cold, 100.0, theirs))
    return rows


def of_peers(peers: Peers, kinds: int) -> dict[str, float]:
    """What the peers take to plan the whole kit."""
    found = {}
    if "gtpyhop" in peers:
        found["gtpyhop"] = peers["gtpyhop"].plan_ms(kinds)
    if "unified" in peers:
        for engine in peers["unified"].engines():
            progress(f"{engine}, {kinds} kinds")
            found[engine], _ = peers["unified"].plan_ms(engine, kinds)
    return found


def relaxations(peers: Peers) -> list[Row]:
    """Every assumption by itself. What is read and planned anew is what a planner does that cannot replan."""
    tested = {"gtpyhop": peers["gtpyhop"].plan_ms(100, relaxed=True)} if "gtpyhop" in peers else {}
    rows = []
    for name in ours.NINE:
        progress(f"relaxing {name}")
        goal = 12.0 if name == "AQ" else 50.0
        many = ours.relaxing(100, name)
        rows.append(row(f"relaxing {name}, 100 kinds", "ms", many, goal, tested))
        rows.append(row("  verified", "ms", ours.relaxing(100, name, verify=True), goal, tested))
        alone, read = ours.anew(100, name, reading=False), ours.anew(100, name, reading=True)
        rows.append(row("  in parts of planning anew", "", many / alone, 0.3, {}))
        rows.append(row("  in parts of reading and planning anew", "", many / read, 0.3, {}))
        foreseen = ours.relaxing(100, name, foresight=True)
        rows.append(row("  foreseen", "ms", foreseen, None, {}))
        rows.append(row("  foreseen, in parts of planning anew", "", foreseen / alone, 0.3, {}))
        growth = ours.exponent(ours.relaxing(25, name), many)
        rows.append(row("  growth, 25 to 100 kinds", "exponent", growth, 1.1, {}))
    for told, options in MODES:
        rows.append(row(f"relaxing AQ, 3 kinds{told}", "ms", ours.relaxing(3, "AQ", **options), None, {}))
        rows.append(row(f"all nine, 3 kinds{told}", "ms", ours.all_nine(3, **options), 50.0, {}))
    return rows


def promptness() -> list[Row]:
    progress("failures while at work, and every step")
    rows = []
    for kinds in (3, 100):
        for told, options in MODES:
            answers, steps = ours.reactions_to_failures(kinds, **options), ours.steps_ms(kinds, **options)
            rows += [
                row(f"failure to first adaptation, p99, {kinds} kinds{told}", "ms", quantile(answers, 0.99), 20.0, {}),
                row(f"longest step, p99.9, {kinds} kinds{told}", "ms", quantile(steps, 0.999), 5.0, {}),
                row(f"longest step, {kinds} kinds{told}", "ms", steps[-1], None, {}),
            ]
    return rows


def executions(peers: Peers) -> list[Row]:
    progress("the kit task, executed")
    rows = []
    for kinds in (3, 25, 100):
        theirs = {}
        if "unified" in peers and "kairos" in peers["unified"].engines() and kinds <= 25:
            theirs["kairos"] = peers["unified"].plan_ms("kairos", kinds, rounds=1)[1]
        took, goal = kit_task.executed(kinds), 1.05 * kit_task.best(kinds)
        rows.append(row(f"makespan of the kit task, {kinds} kinds", "s", took, goal, theirs))
        ahead = kit_task.executed(kinds, ahead=True)
        rows.append(row(f"  the camera looking ahead, {kinds} kinds", "s", ahead, goal, theirs))
    return rows


def quantile(ordered: list[float], share: float) -> float:
    return ordered[min(len(ordered) - 1, int(len(ordered) * share))]


def row(name: str, unit: str, value: float, goal: float | None, peers: dict[str, Any]) -> Row:
    """A row in which less is better."""
    return {
        "name": name,
        "unit": unit,
        "ours": round(value, 3),
        "goal": None if goal is None else round(goal, 2),
        "of_goal": None if goal is None else round(goal / max(value, 1e-9), 2),
        "peers": {peer: round(theirs, 2) for peer, theirs in peers.items()},
        "ratio": {peer: round(theirs / max(value, 1e-9), 2) for peer, theirs in peers.items()},
    }


def progress(name: str) -> None:
    print(f"… {name}", file=sys.stderr, flush=True)
