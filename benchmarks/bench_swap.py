"""Random swaps of segments in a reactor of 10,000 processes, asked for by the world, by reactions, and by a thread.

Measured is what one swap takes of the processor: `prepare`, which reads, checks and compiles its text and may be done
anywhere, and then, from `receive` of what is prepared,

    swap      asked for by the world, while nothing else happens: until the loop has nothing left to do
    inside    asked for by a reaction that acts: until the swap is in effect; that reaction goes on meanwhile
    thread    posted by another thread, one after the other: until the swap is in effect; on the wall clock as well
    same      work that is always the same, between swaps: what of the spread is the machine's

After every swap it is asked whether a bystander began again, an event or a perception was lost, or anything was left
behind (`SwapCell.check`), of every segment every `WALK` swaps; it has to be nothing.

    python benchmarks/bench_swap.py [SWAPS] [--out FILE]      a million; goes on where it stopped (make swaps)
    python benchmarks/bench_swap.py [SWAPS] --moments         the swaps by how busy the machine was around each of them
"""

from __future__ import annotations

import argparse
import gc
import json
import random
import threading
import time
from collections import Counter
from math import inf
from pathlib import Path
from typing import Any

from swap_cell import Segment, SwapCell

from planner_reactor.reactor.preparing import Prepared
from planner_reactor.runtime import VirtualClock, WallClock

SEGMENTS = 1_112
"""Of 9 processes each: 10,008 in all."""

MANY = 1_000_000
SLICE = 50_000
"""Swaps of one reactor; every fifth reactor is swapped from a thread."""

WALK = 500
"""Swaps after which every segment is looked at."""

BETWEEN = 0.001
"""Seconds of virtual time between two swaps: 25,000 at one instant use up the turns that a root has at one instant."""

SOMETIMES = 20
"""Swaps between which the machine is looked at."""

QUIET = (1.1, 1.2, 1.4, inf)
"""How many times its least the fixed work may take where the machine is called quiet."""

ROUNDS = 50
"""Rounds of the loop in which everything that follows from a swap and an event has happened."""

BIN = 10
"""Microseconds that are told apart."""

COUNTED = (
    "swaps that were not applied", "bystanders restarted", "events lost", "perceptions lost", "reactions left over",
    "processes left over", "basic processes left over", "instances left over", "segments gone", "violations",
    "cyclic garbage",
)  # fmt: skip
"""What has to be 0."""


TOTALS = ("swaps", "checks", "by_reactions", "from_a_thread", "seconds")


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
        shares = {"p10": 0.1, "p50": 0.5, "p99": 0.99, "p999": 0.999, "max": 1.0}
        return {name: self.microseconds(share) for name, share in shares.items()}


def swaps(count: int, *, segments: int = SEGMENTS, seed: int = 0) -> dict[str, Any]:
    """So many on the virtual clock; three events to ten swaps; of ten new segments three swap others as they act."""
    cell, draw = SwapCell(segments, VirtualClock()), random.Random(seed)
    names = ("prepare", "swap", "both", "inside", "prepare inside", "same")
    prepare, swap, both, inside, prepare_inside, same = spent = [Spent() for _ in names]
    cell.told.took, cell.prepared_inside = inside.add, prepare_inside.add
    built = cell.number
    settle()
    began = time.process_time()
    while cell.number - built < count:
        if draw.random() < 0.3:
            cell.happen(cell.segments[draw.randrange(segments)])
            cell.scheduler.run(cell.scheduler.now)
        cell.scheduler.run(cell.scheduler.now + BETWEEN)
        segment = cell.segments[draw.randrange(segments)]
        adaptation = cell.adaptation(segment, swapping=draw.random() < 0.3)
        asked = time.thread_time()
        prepared = cell.reactor.prepare(adaptation)
        ready = time.thread_time()
        cell.reactor.receive(prepared)
        cell.scheduler.run(cell.scheduler.now)
        over = time.thread_time()
        prepare.add(ready - asked)
        swap.add(over - ready)
        both.add(over - asked)
        cell.check(segment)
        if cell.checks % SOMETIMES == 0:
            same.add(always_the_same())
        if cell.checks % WALK == 0:
            cell.counts()
    return told(cell, built, dict(zip(names, spent, strict=True)), time.process_time() - began)


def always_the_same(size: int = 600) -> float:
    """Seconds of processor time that a fixed piece of work takes; of 600, about as long as a swap."""
    began = time.thread_time()
    made = {number: Segment(number) for number in range(size)}
    for number in range(0, size, 2):
        made.pop(number).labels = (number, number)
    return time.thread_time() - began


def swaps_from_a_thread(count: int, *, segments: int = SEGMENTS, seed: int = 0) -> dict[str, Any]:
    """So many on the wall clock, each prepared and posted by a thread of its own, while events happen."""
    cell, draw = SwapCell(segments, WallClock()), random.Random(seed)
    spent = {"thread prepare": Spent(), "thread": Spent(), "posted to applied, wall": Spent()}
    built, applied = cell.number, threading.Semaphore(0)
    cell.told.took = spent["thread"].add
    settle()
    began = time.process_time()

    def apply(segment: Segment, prepared: Prepared, posted: float) -> None:
        cell.told.asked[str(prepared.adaptation.id)] = time.thread_time()
        cell.reactor.receive(prepared)
        cell.scheduler.soon(lambda: over(segment, posted))

    def over(segment: Segment, posted: float) -> None:
        spent["posted to applied, wall"].add(time.perf_counter() - posted)
        if draw.random() < 0.3:
            cell.happen(cell.segments[draw.randrange(segments)])
        checked(segment, ROUNDS)

    def checked(segment: Segment, rounds: int) -> None:
        if rounds and not cell.quiet:
            cell.scheduler.soon(lambda: checked(segment, rounds - 1))
            return
        cell.check(segment)
        if cell.checks % WALK == 0:
            cell.counts()
        applied.release()

    def ask() -> None:
        asking = random.Random(seed + 1)
        for _ in range(count):
            segment = cell.segments[asking.randrange(segments)]
            adaptation = cell.adaptation(segment)
            began = time.thread_time()
            prepared = cell.reactor.prepare(adaptation)
            spent["thread prepare"].add(time.thread_time() - began)
            posted = time.perf_counter()
            cell.scheduler.post(lambda s=segment, p=prepared, at=posted: apply(s, p, at))  # type: ignore[misc]
            applied.acquire()
        cell.scheduler.post(lambda: cell.scheduler.call_after(0.2, cell.scheduler.stop))

    thread = threading.Thread(target=ask)
    thread.start()
    cell.scheduler.run()
    thread.join()
    return told(cell, built, spent, time.process_time() - began)


def moments(count: int, *, segments: int = SEGMENTS, seed: int = 0) -> dict[str, Any]:
    """So many; apart, those before and behind which fixed work took at most so many times its least."""
    cell, draw = SwapCell(segments, VirtualClock()), random.Random(seed)
    found: list[tuple[float, float, float]] = []  # the work around it, prepare, swap
    settle()
    for _ in range(count):
        cell.scheduler.run(cell.scheduler.now + BETWEEN)
        adaptation = cell.adaptation(cell.segments[draw.randrange(segments)])
        asked = time.thread_time()
        prepared = cell.reactor.prepare(adaptation)
        ready, before = time.thread_time(), always_the_same(100)
        began = time.thread_time()
        cell.reactor.receive(prepared)
        cell.scheduler.run(cell.scheduler.now)
        over = time.thread_time()
        found.append((max(before, always_the_same(100)), ready - asked, over - began))
        cell.take()
    lost = {name: wrong for name, wrong in cell.counts().items() if wrong}
    least = sorted(around for around, _, _ in found)[count // 200]
    spent = {}
    for times in QUIET:
        prepare, swap = Spent(), Spent()
        for around, took, swapped in found:
            if around <= times * least:
                prepare.add(took)
                swap.add(swapped)
        spent["all" if times == QUIET[-1] else f"at most {times:g} times"] = {
            "swaps": swap.bins.total(), "prepare": prepare.shown(), "swap": swap.shown()
        }  # fmt: skip
    return {"wrong": lost, "us": spent}


def settle() -> None:
    """What stands is no garbage, and what goes leaves none that is cyclic: no collector runs (docs/hosts.md)."""
    gc.collect()
    gc.freeze()
    gc.disable()


def told(cell: SwapCell, built: int, spent: dict[str, Spent], seconds: float) -> dict[str, Any]:
    garbage = gc.collect()
    gc.unfreeze()
    gc.enable()
    return {
        "cyclic garbage": garbage,
        "swaps": cell.number - built,
        "checks": cell.checks,
        "by_reactions": cell.inside,
        "from_a_thread": spent["thread"].bins.total() if "thread" in spent else 0,
        "seconds": seconds,
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
    counts = {name: sum(one[name] for one in found) for name in (*TOTALS, *COUNTED)}
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
    parser.add_argument("--moments", action="store_true")
    given = parser.parse_args()
    if given.moments:
        print(json.dumps(found := moments(min(given.swaps, 10_000)), indent=1))
        return 1 if found["wrong"] else 0
    print(json.dumps(found := campaign(given.swaps, given.out), indent=1))
    return 1 if any(found[name] for name in COUNTED) else 0


if __name__ == "__main__":
    raise SystemExit(main())
