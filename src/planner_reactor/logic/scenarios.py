"""Is a network of intervals consistent, and what would a world look like in which it holds?

Path consistency alone accepts networks that no world satisfies; these answers are those of the complete search
(`solving`). `scenario` reads one base relation for every pair off the timeline; `holds_in` checks numbers against a
network.
"""

from __future__ import annotations

from collections.abc import Mapping

from planner_reactor.logic.allen import BASES, base_relation
from planner_reactor.logic.network import Interval, Network
from planner_reactor.logic.problems import Lies
from planner_reactor.logic.solving import GUESSES, solve


def is_consistent(network: Network, *, limit: int = GUESSES) -> bool:
    """Does any world satisfy the network? Complete; BudgetError after `limit` guesses (it is NP-complete)."""
    return timeline(network, limit=limit) is not None


def timeline(network: Network, *, limit: int = GUESSES) -> dict[Interval, tuple[float, float]] | None:
    """Start and end of each interval, as small whole numbers, in one world where the network holds;
    None if none.
    """
    if not network.consistent:
        return None
    statements = [Lies(first=first, relation=known, second=second) for first, second, known in network.edges()]
    times = solve(statements, network.intervals, limit=limit).times
    return None if times is None else {interval: times[interval] for interval in network.intervals}


def scenario(network: Network, *, limit: int = GUESSES) -> dict[tuple[Interval, Interval], str] | None:
    """One base relation for every pair (the one named first comes first), all holding together; None
    if none do.
    """
    times = timeline(network, limit=limit)
    if times is None:
        return None
    named = list(times)
    return {
        (first, second): BASES[base_relation(times[first], times[second]).bit_length() - 1]
        for n, first in enumerate(named)
        for second in named[n + 1 :]
    }


def holds_in(network: Network, times: Mapping[Interval, tuple[float, float]]) -> bool:
    """Do these starts and ends satisfy every relation of the network?"""
    return all(base_relation(times[first], times[second]) & relation for first, second, relation in network.edges())
