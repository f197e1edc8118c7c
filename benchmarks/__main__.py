"""The executer and the planner beside their peers: `python benchmarks [--peers] [--only PART] [--json]`.

One run, medians of five taken in turns, ratios to the peers that are installed (`pip install -e '.[bench]'`). A goal to
be exceeded is marked `≥`, one not to be exceeded `≤`; they were set for an idle machine, the ratios hold on a busy one.
"""

from __future__ import annotations

import argparse
import importlib
import json
import os
import platform
import sys
from collections.abc import Callable
from types import ModuleType
from typing import Any

import bench_executer as ours
import bench_network
import bench_swap
import planner_rows
import transition_rows
from measuring import Work, rates

PEERS = ("simpy", "asyncio", "trio", "gtpyhop", "unified", "pytrees")
COUNTS = (10, 1_000, 100_000)
Row = dict[str, Any]


def main() -> int:
    """Run everything and print it."""
    parser = argparse.ArgumentParser(prog="benchmarks", description=__doc__)
    parser.add_argument("--peers", action="store_true", help="also measure SimPy, asyncio and trio")
    only = ("executer", "planner", "transitions", "network", "swaps")
    parser.add_argument("--only", choices=only, help="measure one part")
    parser.add_argument("--json", action="store_true", help="print one JSON object")
    given = parser.parse_args()
    peers = installed() if given.peers else {}
    parts = {
        "executer": (throughput, reactions, costs),
        "planner": (planner_rows.planning,),
        "transitions": (transition_rows.systems,),
        "network": (bench_network.rows,),
        "swaps": (swapping,),
    }
    rows = [row for name, part in parts.items() if given.only in (None, name) for do in part for row in do(peers)]
    found = {
        "python": platform.python_version(),
        "load": round(os.getloadavg()[0], 2),
        "peers": {name: getattr(module, "VERSION", "") for name, module in peers.items()},
        "measures": rows,
    }
    print(json.dumps(found) if given.json else readable(rows))
    return 0


def installed() -> dict[str, ModuleType]:
    """The peers that can be imported."""
    found = {}
    for name in PEERS:
        try:
            found[name] = importlib.import_module(f"peers.{name}_peer")
        except ImportError:
            print(f"{name} is not installed, it is left out", file=sys.stderr)
    return found


def throughput(peers: dict[str, ModuleType]) -> list[Row]:
    """Rates per second."""
    return [
        rate("process steps", ours.steps, peers, "steps", goal=2.5e6),
        rate("process steps in turns, observed", ours.steps_in_turns_observed, peers, "steps", goal=1e6),
        rate("rendezvous", ours.rendezvous, {}, "", goal=0.8e6),
        rate("rendezvous round trips", ours.round_trips, peers, "round_trips"),
        *(
            rate(f"delays of {n} processes", lambda n=n, k=k: ours.delays(n, k), peers, "delays", (n, k), factor=2.0)
            for n, k in ((1, 40_000), (100, 400), (5_000, 10))
        ),
        rate("processes aborted of 10,000", ours.cancelling, {}, ""),
    ]


def rate(
    name: str,
    work: Work,
    peers: dict[str, ModuleType],
    of_peer: str,
    arguments: tuple[int, ...] = (),
    *,
    goal: float | None = None,
    factor: float | None = None,
) -> Row:
    """One row: ours and that of every peer that can do it. `factor`: the goal is so many times SimPy's."""
    progress(name)
    subjects: dict[str, Work] = {"ours": work}
    for peer, module in peers.items():
        if (does := getattr(module, of_peer, None)) is not None:
            subjects[peer] = lambda does=does: does(*arguments)
    found = rates(subjects)
    mine = found.pop("ours")
    if factor is not None and "simpy" in found:
        goal = factor * found["simpy"].median
    return {
        "name": name,
        "unit": "1/s",
        "ours": round(mine.median),
        "spread": [round(mine.least), round(mine.greatest)],
        "goal": None if goal is None else round(goal),
        "of_goal": None if goal is None else round(mine.median / goal, 2),
        "peers": {peer: round(theirs.median) for peer, theirs in found.items()},
        "ratio": {peer: round(mine.median / theirs.median, 2) for peer, theirs in found.items()},
    }


def reactions(peers: dict[str, ModuleType]) -> list[Row]:
    """Microseconds from an event to its reaction, among many that wait."""
    rows = []
    for at, what in (("AtSensors", "signal → reaction"), ("AtPorts", "signal → port → reaction")):
        for count in COUNTS:
            name = f"{what}, {count:,} wait"
            progress(name)
            others = {
                peer: module.reaction_latency
                for peer, module in peers.items()
                if hasattr(module, "reaction_latency") and count <= 1_000 and at == "AtSensors"
            }
            rows += latency_rows(name, lambda at=at, n=count: ours.reaction_latency(n, at=at), others, count)
    return rows


def latency_rows(
    name: str, measure: Callable[[], tuple[float, float]], peers: dict[str, Callable[..., Any]], count: int
) -> list[Row]:
    mine = sorted(measure() for _ in range(5))[2]
    theirs = {peer: sorted(ask(count) for _ in range(5))[2] for peer, ask in peers.items()}
    return [
        limited(f"{name}, {percentile}", "µs", mine[i], goal, {peer: found[i] for peer, found in theirs.items()})
        for i, (percentile, goal) in enumerate((("p50", 6.0), ("p99", 30.0)))
    ]


def swapping(peers: dict[str, ModuleType]) -> list[Row]:
    """Replacing a segment of a running reactor; a peer replaces a subtree of a running tree of as many nodes."""
    progress("swaps")
    theirs = {peer: module.swaps() for peer, module in peers.items() if hasattr(module, "swaps")}
    found = bench_swap.summed([bench_swap.swaps(2_000)])
    lost = sum(value for name, value in found.items() if name in bench_swap.COUNTED)
    return [
        limited(f"swap of a segment, {found['processes']:,} processes, {percentile}", "µs",
                found["us"]["swap"][percentile], goal, {peer: latencies[i] for peer, latencies in theirs.items()})
        for i, (percentile, goal) in enumerate((("p50", None), ("p99", 1000.0)))
    ] + [limited("lost, restarted or left over in 2,000 swaps", "", lost, 0.0, {})]  # fmt: skip


def costs(peers: dict[str, ModuleType]) -> list[Row]:
    """What waiting takes."""
    progress("what waits")
    return [
        limited("memory of a reaction that waits at a port", "B", ours.bytes_waiting(at="AtPorts"), 1000.0, {}),
        limited("memory of one that waits in a host's process", "B", ours.bytes_waiting(at="AtSensors"), None, {}),
        limited("CPU of 10,000 that wait", "%", ours.idle_cpu(), 1.0, {}),
    ]


def limited(name: str, unit: str, value: float, goal: float | None, peers: dict[str, float]) -> Row:
    """A row in which less is better."""
    return {
        "name": name,
        "unit": unit,
        "ours": round(value, 2),
        "goal": goal,
        "of_goal": None if goal is None else round(goal / max(value, 1e-9), 2),
        "peers": {peer: round(theirs, 2) for peer, theirs in peers.items()},
        "ratio": {peer: round(theirs / max(value, 1e-9), 2) for peer, theirs in peers.items()},
    }


def readable(rows: list[Row]) -> str:
    """A table; behind each peer's figure how many times better ours is."""
    lines = []
    columns: tuple[str, ...] = ()
    for row in rows:
        missing = [peer for peer in row["peers"] if peer not in columns]
        if missing or not lines:  # another part of the table, with other peers
            columns = tuple(row["peers"])
            lines.append(f"{'':46} {'ours':>12} {'goal':>12}  " + "  ".join(f"{peer:>20}" for peer in columns))
        sign = "≥" if row["unit"] == "1/s" else "≤"
        goal = "" if row["goal"] is None else f"{sign} {row['goal']:,}"
        others = [f"{row['peers'][p]:,} (×{row['ratio'][p]})" if p in row["peers"] else "" for p in columns]
        head = f"{row['name']:46} {row['ours']:>12,} {goal:>12}  "
        lines.append(head + "  ".join(f"{text:>20}" for text in others) + f"  {row['unit']}")
    return "\n".join(lines)


def progress(name: str) -> None:
    print(f"… {name}", file=sys.stderr, flush=True)


if __name__ == "__main__":
    raise SystemExit(main())
