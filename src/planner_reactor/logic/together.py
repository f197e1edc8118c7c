"""What must happen at the same time: the part of the logic on which concurrency in a plan rests.

A condition that holds *during* an action is held through it (`held_through`). If only a running action makes it hold
(an effect over the action's own interval, `Pose(x) @ Track`), both have to run together; two actions that live on each
other's effects have to begin and end together (`mutual`). `at_once` finds the groups of intervals that a network leaves
no other way than to overlap: what a planner has to compose concurrently.
"""

from __future__ import annotations

from planner_reactor.logic.allen import ALL, compose, inverse, relations
from planner_reactor.logic.network import Interval, Network

HOLDS_THROUGH = relations(["si", "e", "di", "fi"])
"""From a condition's interval to that of an action that needs it all the time: `encompasses`."""
OVERLAPPING = ALL & ~relations(["b", "bi", "m", "mi"])
"""The relations of two intervals that have a time in common."""


def held_through(effect: int, condition: int = HOLDS_THROUGH) -> int:
    """How an action lies to a user of its effect: `effect` leads from the action to what it brings about, `condition`
    from there to the user. An effect over the action's own interval, needed throughout, makes it `[si e di fi]`.
    """
    return compose(effect, condition)


def mutual(first_effect: int, second_effect: int, condition: int = HOLDS_THROUGH) -> int:
    """How two actions lie that communicate, each needing throughout what the other brings about; 0 if they cannot."""
    return held_through(first_effect, condition) & inverse(held_through(second_effect, condition))


def must_overlap(network: Network, first: Interval, second: Interval) -> bool:
    """Have the two a time in common in every world that the network allows?"""
    return not network.relation(first, second) & ~OVERLAPPING


def may_overlap(network: Network, first: Interval, second: Interval) -> bool:
    """Can they have a time in common, as far as propagation knows?"""
    return bool(network.relation(first, second) & OVERLAPPING)


def at_once(network: Network) -> list[tuple[Interval, ...]]:
    """The intervals in groups, in order: two that must overlap are in one group."""
    group = {interval: n for n, interval in enumerate(network.intervals)}
    for first, second, _ in network.edges():
        if must_overlap(network, first, second):
            kept, gone = sorted((group[first], group[second]))
            group = {interval: kept if n == gone else n for interval, n in group.items()}
    found: dict[int, list[Interval]] = {}
    for interval, n in group.items():
        found.setdefault(n, []).append(interval)
    return [tuple(members) for members in found.values()]
