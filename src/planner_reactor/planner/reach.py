"""What can be reached at all, and how many actions it costs at least: bounds for the search.

Nothing that is brought about is taken to be undone, and arguments are not looked at, so a bound never
exceeds the truth; NEVER means that no plan exists. Where a relaxed assumption would have made a bound
lower, it is noted as missing: if it is reinstated, another plan may win.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import TypeAlias

from planner_reactor.logic.domain import Rule
from planner_reactor.logic.formulas import Atom
from planner_reactor.planner.problem import Consulted, Problem
from planner_reactor.planner.theory import Theory

NEVER = 1 << 30
_Bounds: TypeAlias = dict[str, int]


class Reach:
    """Lower bounds for one problem; they are shared by all problems that have the same predicates to
    begin with.
    """

    def __init__(self, problem: Problem, consulted: Consulted) -> None:
        self.problem = problem
        self.consulted = consulted
        known = {truth.atom.predicate for truth in problem.truths}
        known |= {atom.predicate for atom in problem.upheld}
        known |= {atom.predicate for atom, holds in problem.beliefs.told if holds}
        given = frozenset(known) | problem.theory.lasting_facts
        self._here = _bounds(problem.theory, given, problem.forbidden, problem.beliefs.relaxed)
        self._best = _bounds(problem.theory, given, problem.forbidden, frozenset())
        self._together: dict[tuple[str, ...], int] = {}

    def least(self, predicate: str) -> int:
        """At least so many actions bring it about (what these need does not count)."""
        found = self._here.get(predicate, NEVER)
        if found > self._best.get(predicate, NEVER):
            self.consulted.missing |= _missing(self.problem.theory, self.problem.beliefs.relaxed, predicate)
        return found

    def out_of_reach(self) -> tuple[str, ...]:
        """Why there can be no plan: the predicates behind the goals that nothing here can bring about, if there are."""
        found: dict[str, None] = {}
        waiting = [atom.predicate for atom in self.problem.goals if atom.predicate not in self._here]
        seen = set(waiting)
        while waiting:
            predicate = waiting.pop(0)
            needs = _needs(self.problem, predicate)
            if not needs:
                found[predicate] = None
            for need in dict.fromkeys(n for way in needs for n in way if n not in self._here and n not in seen):
                seen.add(need)
                waiting.append(need)
        return tuple(found)

    def least_together(self, predicates: tuple[str, ...]) -> int:
        """At least so many actions bring about all of these: those count that no action can help
        to two of.
        """
        found = self._together.get(predicates)
        if found is None:
            found = self._together[predicates] = self._least_together(predicates)
        return found

    def _least_together(self, predicates: tuple[str, ...]) -> int:
        contributors = self.problem.theory.contributors
        total = largest = 0
        counted: set[str] = set()
        for predicate in predicates:
            cost = self.least(predicate)
            largest = max(largest, cost)
            if cost and not contributors[predicate] & counted:
                counted |= contributors[predicate]
                total += cost
        return max(total, largest)


def _needs(problem: Problem, predicate: str) -> list[tuple[str, ...]]:
    """What each way to bring the predicate about needs; a way that is not open here is none."""
    theory, relaxed = problem.theory, problem.beliefs.relaxed
    rules = [r for r in theory.domain.rules_for.get(predicate, ()) if _holds(r.assumptions, relaxed)]
    schemas = [
        schema
        for schema, _ in theory.domain.producers.get(predicate, ())
        if not (schema.name in problem.forbidden or schema.cleanup) and _holds(theory.assumed(schema), relaxed)
    ]
    return [tuple(sorted(n)) for n in (*map(theory.body, rules), *(theory.needs[s.name] for s in schemas))]


def _missing(theory: Theory, relaxed: frozenset[str], predicate: str) -> frozenset[str]:
    """The relaxed assumptions on the ways that lead to the predicate."""
    key = (predicate, relaxed)
    found = theory.missing.get(key)
    if found is None:
        behind = theory.assumptions_behind(predicate)
        found = theory.missing[key] = frozenset(n for n in relaxed if n.partition("(")[0] in behind)
    return found


def _bounds(theory: Theory, given: frozenset[str], forbidden: frozenset[str], relaxed: frozenset[str]) -> _Bounds:
    key = (given, forbidden, relaxed)
    found = theory.bounds.get(key)
    if found is None:
        if len(theory.bounds) > 10_000:
            theory.bounds.clear()
        found = theory.bounds[key] = _fixpoint(theory, given, forbidden, relaxed)
    return found


def _fixpoint(theory: Theory, given: frozenset[str], forbidden: frozenset[str], relaxed: frozenset[str]) -> _Bounds:
    bounds = dict.fromkeys(given, 0)
    rules = [rule for rule in theory.domain.rules if _holds(rule.assumptions, relaxed)]
    waiting = [
        schema
        for schema in theory.domain.schemas.values()
        if not (schema.name in forbidden or schema.cleanup) and _holds(theory.assumed(schema), relaxed)
    ]
    changed = True
    while changed:
        changed = False
        for rule in rules:
            if theory.body(rule) <= bounds.keys():
                changed |= _lower(bounds, rule.head.predicate, _cost(theory, rule, bounds))
        still = []
        for schema in waiting:
            if theory.needs[schema.name] <= bounds.keys():
                for predicate in theory.effects[schema.name]:
                    changed |= _lower(bounds, predicate, 1)
            else:
                still.append(schema)
        waiting = still
    return bounds


def _holds(assumptions: Iterable[Atom], relaxed: frozenset[str]) -> bool:
    return not relaxed or not any(a.predicate in relaxed for a in assumptions)


def _cost(theory: Theory, rule: Rule, bounds: _Bounds) -> int:
    return sum(count * max([bounds[predicate] for predicate in group]) for group, count in theory.alike_groups(rule))


def _lower(bounds: _Bounds, predicate: str, cost: int) -> bool:
    if cost >= min(bounds.get(predicate, NEVER), NEVER):
        return False
    bounds[predicate] = cost
    return True
