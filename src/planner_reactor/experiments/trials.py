"""Many runs of one kind by several processes, and what is written down of them.

Each trial is a plain value that a function of a module turns into a row, so that any `concurrent.futures` executor can
do it. Rows come back in the order of the trials, whoever was first.
"""

from __future__ import annotations

import csv
import json
from collections.abc import Callable, Iterable, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from statistics import mean, stdev
from typing import Any, TypeVar

T = TypeVar("T")
R = TypeVar("R")


def run_trials(
    one: Callable[[T], R], trials: Sequence[T], *, workers: int, watch: Callable[[int, int], object]
) -> list[R]:
    """`one` of every trial; `watch(done, of)` is told of progress."""
    watch(0, len(trials))
    if workers <= 1:
        return _in_order(map(one, trials), len(trials), watch)
    with ProcessPoolExecutor(max_workers=workers) as pool:
        return _in_order(pool.map(one, trials), len(trials), watch)


def _in_order(results: Iterable[R], of: int, watch: Callable[[int, int], object]) -> list[R]:
    found: list[R] = []
    for result in results:
        found.append(result)
        watch(len(found), of)
    return found


def write_rows(file: Path, rows: Sequence[Mapping[str, Any]]) -> None:
    """Rows of equal form as CSV; lists are written with spaces between their members."""
    with file.open("w", newline="", encoding="utf-8") as target:
        writer = csv.DictWriter(target, list(rows[0]) if rows else [])
        writer.writeheader()
        for row in rows:
            writer.writerow({k: " ".join(map(str, v)) if isinstance(v, list) else v for k, v in row.items()})


def write_json(file: Path, found: Mapping[str, Any]) -> None:
    """One object, readable."""
    file.write_text(json.dumps(found, indent=1) + "\n", encoding="utf-8")


def interval(values: Sequence[float]) -> tuple[float, float]:
    """The mean, and half the width of its 95 % confidence interval (normal approximation)."""
    half = 1.96 * stdev(values) / len(values) ** 0.5 if len(values) > 1 else 0.0
    return round(mean(values), 3), round(half, 3)


def middle(values: Iterable[float], share: float = 0.5) -> float | None:
    """The value below which this share of them lies, or None of none."""
    ordered = sorted(values)
    return ordered[min(len(ordered) - 1, int(share * len(ordered)))] if ordered else None
