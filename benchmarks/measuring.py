"""How the benchmarks measure: rates as medians of five runs taken in turns, so that a busy machine is busy for all.

A subject is a function that does some work and returns (CPU seconds, how much was done). Rates are per CPU second of
this process; latencies are wall-clock time.
"""

from __future__ import annotations

import gc
import statistics
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass

Work = Callable[[], tuple[float, int]]
ROUNDS = 5


@dataclass(frozen=True, slots=True)
class Rate:
    """Per second: the median of the rounds, the least and the greatest."""

    median: float
    least: float
    greatest: float


def timed(work: Callable[[], object]) -> float:
    """CPU seconds that the work takes, without the garbage of what went before."""
    gc.collect()
    begun = time.process_time()
    work()
    return time.process_time() - begun


def rates(subjects: Mapping[str, Work], *, rounds: int = ROUNDS) -> dict[str, Rate]:
    """The rates of all subjects, measured in turns."""
    seen: dict[str, list[float]] = {name: [] for name in subjects}
    for _ in range(rounds):
        for name, work in subjects.items():
            seconds, count = work()
            seen[name].append(count / seconds)
    return {name: Rate(statistics.median(found), min(found), max(found)) for name, found in seen.items()}


def percentiles(latencies: list[float]) -> tuple[float, float]:
    """(p50, p99) in microseconds, of seconds."""
    ordered = sorted(latencies)
    return ordered[len(ordered) // 2] * 1e6, ordered[int(len(ordered) * 0.99)] * 1e6
