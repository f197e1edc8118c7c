"""Random swaps of segments in a reactor of 10,000 processes, issued by the world, by reactions, and by another thread.

Measured is what one swap takes, from `receive` to all of it applied, in CPU time of the thread that runs the reactor
(and on the wall, which on a busy machine says more of the machine). `python benchmarks/bench_swap.py [SWAPS]` runs
as many as asked (10⁶ by default) and prints what was lost, restarted and left behind: nothing.
"""

from __future__ import annotations

import gc
import json
import random
import sys
import threading
import time
from typing import Any

from measuring import percentiles
from swap_cell import SwapCell

from planner_reactor.runtime import VirtualClock, WallClock

SEGMENTS = 1_112
"""Of 9 processes each: 10,008 in all."""

MANY = 1_000_000

COUNTED = (
    "swaps that were not applied", "bystanders restarted", "events lost", "perceptions lost", "reactions left over",
    "basic processes left over", "instances left over", "violations",
)  # fmt: skip
"""What has to be 0."""


def swaps(count: int, *, segments: int = SEGMENTS) -> dict[str, Any]:
    """So many swaps on the virtual clock: every tenth by a reaction, three events to ten swaps."""
    cell, draw = SwapCell(segments, VirtualClock()), random.Random(count)
    processor, wall = [], []
    built = cell.number
    gc.collect()
    gc.freeze()
    while cell.number - built < count:
        segment = cell.segments[draw.randrange(segments)]
        if draw.random() < 0.3:
            cell.happen(cell.segments[draw.randrange(segments)])
            cell.scheduler.run(cell.scheduler.now)
        adaptation = cell.prepared(segment, swapping=draw.random() < 0.3)
        began, used = time.perf_counter(), time.thread_time()
        cell.reactor.receive(adaptation)
        cell.scheduler.run(cell.scheduler.now)
        processor.append(time.thread_time() - used)
        wall.append(time.perf_counter() - began)
        cell.take()
    return told(cell, count, processor, wall)


def swaps_from_a_thread(count: int, *, segments: int = SEGMENTS) -> dict[str, Any]:
    """So many on the wall clock, asked for by a thread of its own while events happen: it posts, and goes on."""
    cell, draw = SwapCell(segments, WallClock()), random.Random(count)
    latencies: list[float] = []
    room = threading.Semaphore(8)

    def apply(index: int, posted: float) -> None:
        segment = cell.segments[index]
        cell.swap(segment)
        if draw.random() < 0.3:
            cell.happen(cell.segments[draw.randrange(segments)])
        cell.scheduler.soon(lambda: (latencies.append(time.perf_counter() - posted), room.release(), cell.take()))

    def ask() -> None:
        asking = random.Random(7)
        for _ in range(count):
            room.acquire()
            index, posted = asking.randrange(segments), time.perf_counter()
            cell.scheduler.post(lambda index=index, posted=posted: apply(index, posted))  # type: ignore[misc]
        cell.scheduler.post(lambda: cell.scheduler.call_after(0.2, cell.scheduler.stop))

    thread = threading.Thread(target=ask)
    thread.start()
    cell.scheduler.run()
    thread.join()
    return told(cell, count, latencies, latencies)


def told(cell: SwapCell, count: int, processor: list[float], wall: list[float]) -> dict[str, Any]:
    p50, p99 = percentiles(processor)
    wall_p50, wall_p99 = percentiles(wall)
    return {
        "swaps": count,
        "by_reactions": cell.inside,
        "processes": cell.reactor.executer.processes_live,
        "cpu_us": [round(p50, 1), round(p99, 1)],
        "wall_us": [round(wall_p50, 1), round(wall_p99, 1)],
        **cell.counts(),
    }


def main() -> int:
    """Most of them on the virtual clock, a tenth from a thread."""
    count = int(sys.argv[1]) if len(sys.argv) > 1 else MANY
    print(json.dumps(swaps(count - count // 10), indent=1), flush=True)
    print(json.dumps(swaps_from_a_thread(count // 10), indent=1))
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
