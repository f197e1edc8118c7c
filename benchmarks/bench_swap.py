"""Random swaps of segments in a reactor of 10,000 processes, asked for by the world, by reactions, and by a thread.

Measured is what one swap takes of the processor: `prepare`, which reads, checks and compiles its text and may be done
anywhere, and `swap`, from `receive` to all of it applied, which is what the loop is held up for. What was lost,
restarted and left behind is counted, and has to be nothing.

    python benchmarks/bench_swap.py [SWAPS] [--out FILE]      a million; goes on where it stopped (make swaps)
"""

from __future__ import annotations

import argparse
import gc
import json
import random
import threading
import time
from collections import Counter
from pathlib import Path
from typing import Any

from swap_cell import SwapCell

from planner_reactor.reactor.preparing import Prepared
from planner_reactor.runtime import VirtualClock, WallClock

SEGMENTS = 1_112
"""Of 9 processes each: 10,008 in all."""

MANY = 1_000_000
SLICE = 5_000
"""Swaps of one reactor; every fifth reactor is swapped from a thread."""

BIN = 10
"""Microseconds that are told apart."""

COUNTED = (
    "swaps that were not applied", "bystanders restarted", "events lost", "perceptions lost", "reactions left over",
    "basic processes left over", "instances left over", "violations",
    "cyclic garbage",
)  # fmt: skip
"""What has to be 0."""


class Spent:
    """How long things took, seconds, in bins: a million of them, and of many runs."""

    def __init__(self, bins: dict[str, int] | None = None) -> None:
        self.bins = Counter({int(bin_): count for bin_, count in (bins or {}).items()})

    def add(self, seconds: float) -> None:
        self.bins[int(seconds * 1e6 / BIN)] += 1

    def microseconds(self, share: float) -> float:
        """The upper end of the bin below which this share lies; 0 if there is nothing."""
        below, wanted = 0, share * self.bins.total()
        for bin_, count in sorted(self.bins.items()):
            below += count
            if below >= wanted:
                return (bin_ + 1.0) * BIN
        return 0.0

    def shown(self) -> dict[str, float]:
        return {name: self.microseconds(p) for name, p in (("p50", 0.5), ("p99", 0.99), ("p999", 0.999), ("max", 1.0))}


def swaps(count: int, *, segments: int = SEGMENTS, seed: int = 0) -> dict[str, Any]:
    """So many on the virtual clock; three events to ten swaps; of ten new segments three swap others as they act."""
    cell, draw = SwapCell(segments, VirtualClock()), random.Random(seed)
    spent = {"prepare": Spent(), "swap": Spent(), "both": Spent()}
    built = cell.number
    settle()
    while cell.number - built < count:
        if draw.random() < 0.3:
            cell.happen(cell.segments[draw.randrange(segments)])
            cell.scheduler.run(cell.scheduler.now)
        adaptation = cell.adaptation(cell.segments[draw.randrange(segments)], swapping=draw.random() < 0.3)
        began = time.thread_time()
        prepared = cell.reactor.prepare(adaptation)
        ready = time.thread_time()
        cell.reactor.receive(prepared)
        cell.scheduler.run(cell.scheduler.now)
        over = time.thread_time()
        spent["prepare"].add(ready - began)
        spent["swap"].add(over - ready)
        spent["both"].add(over - began)
        cell.take()
    return told(cell, built, spent)


def swaps_from_a_thread(count: int, *, segments: int = SEGMENTS, seed: int = 0) -> dict[str, Any]:
    """So many on the wall clock, each prepared and posted by a thread of its own, eight ahead, while events happen."""
    cell, draw = SwapCell(segments, WallClock()), random.Random(seed)
    spent = {"thread prepare": Spent(), "posted to applied, wall": Spent()}
    built, room = cell.number, threading.Semaphore(8)
    standing = threading.Lock()
    settle()

    def apply(prepared: Prepared, posted: float) -> None:
        cell.reactor.receive(prepared)
        if draw.random() < 0.3:
            cell.happen(cell.segments[draw.randrange(segments)])
        cell.scheduler.soon(lambda: (spent["posted to applied, wall"].add(time.perf_counter() - posted), room.release(),
                                     cell.take()))  # fmt: skip

    def ask() -> None:
        asking = random.Random(seed + 1)
        order = [n for _ in range(count // segments + 2) for n in asking.sample(range(segments), segments)]
        for index in order[:count]:  # never one that is under way
            room.acquire()
            with standing:
                adaptation = cell.adaptation(cell.segments[index])
            began = time.thread_time()
            prepared = cell.reactor.prepare(adaptation)
            spent["thread prepare"].add(time.thread_time() - began)
            posted = time.perf_counter()
            cell.scheduler.post(lambda prepared=prepared, posted=posted: apply(prepared, posted))  # type: ignore[misc]
        cell.scheduler.post(lambda: cell.scheduler.call_after(0.2, cell.scheduler.stop))

    thread = threading.Thread(target=ask)
    thread.start()
    cell.scheduler.run()
    thread.join()
    return told(cell, built, spent)


def settle() -> None:
    """What stands is no garbage, and what goes leaves none that is cyclic: no collector runs (docs/hosts.md)."""
    gc.collect()
    gc.freeze()
    gc.disable()


def told(cell: SwapCell, built: int, spent: dict[str, Spent]) -> dict[str, Any]:
    garbage = gc.collect()
    gc.unfreeze()
    gc.enable()
    return {
        "cyclic garbage": garbage,
        "swaps": cell.number - built,
        "by_reactions": cell.inside,
        "processes": cell.reactor.executer.processes_live,
        "spent": {name: dict(found.bins) for name, found in spent.items()},
        **cell.counts(),
    }


def summed(found: list[dict[str, Any]]) -> dict[str, Any]:
    """What several runs come to: counts added up, and how long things took in microseconds."""
    spent: dict[str, Spent] = {}
    for one in found:
        for name, bins in one["spent"].items():
            spent.setdefault(name, Spent()).bins.update(Spent(bins).bins)
    counts = {name: sum(one[name] for one in found) for name in ("swaps", "by_reactions", *COUNTED)}
    processes = max((one["processes"] for one in found), default=0)
    return {**counts, "processes": processes, "us": {name: times.shown() for name, times in sorted(spent.items())}}


def campaign(count: int, out: Path) -> dict[str, Any]:
    """On to `count` swaps in all; each reactor's are a line of `out`."""
    out.parent.mkdir(parents=True, exist_ok=True)
    found = [json.loads(line) for line in out.read_text().splitlines()] if out.exists() else []
    while (done := sum(one["swaps"] for one in found)) < count:
        number = len(found)
        run = swaps_from_a_thread if number % 5 == 4 else swaps
        found.append(run(min(SLICE, count - done), seed=number))
        with out.open("a") as file:
            file.write(json.dumps(found[-1]) + "\n")
        print(f"{done + found[-1]['swaps']:,}", {n: found[-1][n] for n in COUNTED if found[-1][n]}, flush=True)
    return summed(found)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("swaps", nargs="?", type=int, default=MANY)
    parser.add_argument("--out", type=Path, default=Path("out/swaps.jsonl"))
    given = parser.parse_args()
    print(json.dumps(found := campaign(given.swaps, given.out), indent=1))
    return 1 if any(found[name] for name in COUNTED) else 0


if __name__ == "__main__":
    raise SystemExit(main())
