"""Actions that keep each other going must have something to begin with (X §3.3).

LOOK tells where an object is for as long as it is in view, MOVECAMERA keeps it in view for as long as it is told where
it is: each is the other's condition, throughout. Such a ring holds by induction, if what goes round in it holds when it
begins: here, that the object is in view when the situation is asserted. A ring of which nothing held at the start would
never begin, and is no plan.
"""

from __future__ import annotations

from collections.abc import Iterable

from planner_reactor.logic.formulas import Atom
from planner_reactor.planner.plan import Link, Plan
from planner_reactor.planner.problem import Problem
from planner_reactor.rs.graphs import cycles


def is_founded(plan: Plan, problem: Problem) -> bool:
    """Does something hold at the start of each ring of actions that keep each other going?"""
    kept = [link for link in plan.links if link.maintained and link.producer >= 0 and link.consumer >= 0]
    if not kept:
        return True
    facts = [fact for named in problem.theory.domain.facts.values() for fact in named]
    given = {truth.atom for truth in problem.truths} | set(facts) | set(problem.upheld)
    return all(_begins(plan, ring, given) for ring in _rings(kept))


def _rings(kept: list[Link]) -> Iterable[list[Link]]:
    """The links within each group of actions that depend on each other."""
    needs: dict[int, tuple[int, ...]] = {}
    for link in kept:
        needs[link.consumer] = (*needs.get(link.consumer, ()), link.producer)
        needs.setdefault(link.producer, ())
    for group in cycles(needs):
        yield [link for link in kept if link.consumer in group and link.producer in group]


def _begins(plan: Plan, ring: list[Link], given: set[Atom]) -> bool:
    return any(plan.bindings.ground(link.atom) in given for link in ring)
