"""`network`: is a network of intervals consistent, what follows from it, and what would such a world look like?"""

from __future__ import annotations

from itertools import combinations
from pathlib import Path
from typing import Any

from planner_reactor.calls.inputs import read_text
from planner_reactor.logic.allen import base_relation, names
from planner_reactor.logic.network_text import read_network
from planner_reactor.logic.scenarios import timeline


def network(file: str | Path) -> dict[str, Any]:
    """Judge a network of intervals from a file with lines `i1 (b m o) i2`.

    Returns `consistent` (by complete search), `intervals`, `closure` (of every pair about which something is known:
    `first`, `relations`, `second`, by path consistency), `scenario` (one relation for each pair, holding together)
    and `timeline` (start and end of each interval in it); the last three are None for an inconsistent network.
    Raises DomainError for a wrong text, BudgetError if the search gives up.
    """
    found = read_network(read_text(file), file=str(file))
    times = timeline(found)
    if times is None:
        return {
            "consistent": False, "intervals": list(map(str, found.intervals)),
            "closure": None, "scenario": None, "timeline": None,
        }  # fmt: skip
    return {
        "consistent": True,
        "intervals": list(map(str, found.intervals)),
        "closure": [
            {"first": str(first), "relations": list(names(relation)), "second": str(second)}
            for first, second, relation in found.edges()
        ],
        "scenario": [
            {"first": str(a), "relation": names(base_relation(times[a], times[b]))[0], "second": str(b)}
            for a, b in combinations(times, 2)
        ],
        "timeline": {str(interval): list(ends) for interval, ends in times.items()},
    }
