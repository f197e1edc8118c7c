"""The interval logic: closing networks, adding one edge, the complete search, explanations.

Networks are those of the field: A(n, d, s) has n intervals, each with d neighbours on average, sets of s base relations
on average (Nebel 1997); d = 6.5 is consistent as a rule, 9.5 is about the phase transition. Planted ones hold in a
world that was drawn first. CPU milliseconds, medians over seeds.
"""

from __future__ import annotations

import random
import statistics
from collections.abc import Callable
from itertools import combinations
from time import perf_counter
from types import ModuleType
from typing import Any

from measuring import timed
from planner_rows import progress, row

from planner_reactor.errors import BudgetError
from planner_reactor.logic.allen import BIT, base_relation
from planner_reactor.logic.explaining import minimal
from planner_reactor.logic.network import Network
from planner_reactor.logic.problems import Lies
from planner_reactor.logic.solving import solve
from planner_reactor.logic.stn import TimeNetwork

Edges = list[tuple[int, int, int]]
SEEDS = range(5)


def rows(peers: dict[str, ModuleType]) -> list[dict[str, Any]]:
    """All of them; no peer of the other parts does this."""
    return [*closures(), *edges(), *searches()]


def closures() -> list[dict[str, Any]]:
    progress("closing networks")
    return [
        row("closure, 200 intervals, d = 6.5", "ms", median(lambda s: close(uniform(200, 6.5, s))), 20.0, {}),
        row("closure, 200 intervals, d = 9.5", "ms", median(lambda s: close(uniform(200, 9.5, s))), 200.0, {}),
        row("closure, 200 planted, 10 % of pairs", "ms", median(lambda s: close(planted(200, 0.1, s))), 200.0, {}),
        row("closure, 200 planted, 30 % of pairs", "ms", close(planted(200, 0.3, 0)), 200.0, {}),
    ]


def edges() -> list[dict[str, Any]]:
    progress("one edge")
    found = sorted(one_edge(random.Random(1)))
    bounds = sorted(one_bound(random.Random(1)))
    return [
        row("one edge of 200 intervals, p50", "ms", found[len(found) // 2], 1.0, {}),
        row("one edge of 200 intervals, p99", "ms", found[len(found) * 99 // 100], 1.0, {}),
        row("one edge of 200 intervals, worst", "ms", found[-1], 1.0, {}),
        row("one bound of 100 points in time, p99", "ms", bounds[len(bounds) * 99 // 100], 1.0, {}),
    ]


def searches() -> list[dict[str, Any]]:
    progress("complete search")
    easy = median(lambda seed: search(uniform(200, 6.5, seed)))
    found = [row("complete search, 200 intervals, d = 6.5", "ms", easy, None, {})]
    hard = sorted(search(uniform(50, 9.5, seed)) for seed in range(20))
    found.append(row("complete search, 50 intervals, d = 9.5, median", "ms", hard[10], None, {}))
    found.append(row("complete search, 50 intervals, d = 9.5, worst of 20", "ms", hard[-1], None, {}))
    found.append(row("least explanation, 50 intervals, d = 14", "ms", median(explain), None, {}))
    return found


def uniform(size: int, degree: float, seed: int, labels: float = 6.5) -> Edges:
    """A(n, d, s)."""
    rng = random.Random(seed)
    return [
        (i, j, label(rng, labels)) for i, j in combinations(range(size), 2) if rng.random() < degree / (size - 1)
    ]


def planted(size: int, share: float, seed: int) -> Edges:
    """What is said of a share of the pairs is true of one world, and vague."""
    rng = random.Random(seed)
    spans = [sorted(rng.sample(range(10 * size), 2)) for _ in range(size)]
    return [
        (i, j, label(rng, 6.5) | base_relation((spans[i][0], spans[i][1]), (spans[j][0], spans[j][1])))
        for i, j in combinations(range(size), 2)
        if rng.random() < share
    ]


def label(rng: random.Random, size: float) -> int:
    found = 0
    while not found:
        found = sum(bit for bit in BIT.values() if rng.random() < size / 13)
    return found


def median(work: Callable[[int], float]) -> float:
    return statistics.median(work(seed) for seed in SEEDS)


def close(said: Edges) -> float:
    return 1e3 * timed(lambda: Network().extend(said))


def one_edge(rng: random.Random) -> list[float]:
    """Milliseconds for each edge that is added, and taken back, to closed networks."""
    found = []
    for seed in SEEDS:
        network = Network()
        network.extend(uniform(200, 6.5, seed))
        for _ in range(400):
            i, j = rng.sample(range(200), 2)
            mark = network.mark()
            begun = perf_counter()
            network.constrain(i, j, label(rng, 6.5))
            found.append(1e3 * (perf_counter() - begun))
            network.undo(mark)
    return found


def one_bound(rng: random.Random) -> list[float]:
    times = TimeNetwork()
    for _ in range(100):
        times.point()
    found = []
    for _ in range(1000):
        p, q = rng.sample(range(100), 2)
        begun = perf_counter()
        times.bound(p, q, q - p + rng.randrange(20))
        found.append(1e3 * (perf_counter() - begun))
    return found


def search(said: Edges) -> float:
    def work() -> None:
        try:
            solve([Lies(first=i, relation=known, second=j) for i, j, known in said], limit=2000)
        except BudgetError:
            progress("a search gave up after 2,000 guesses")

    return 1e3 * timed(work)


def explain(seed: int) -> float:
    said = [Lies(first=i, relation=known, second=j) for i, j, known in uniform(50, 14, seed)]
    core = solve(said).core
    return 1e3 * timed(lambda: minimal([said[n] for n in core]))
