"""The goal as the situation at the root (R (13)): asserted for ever, from the facts that may change to
what is wanted.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from typing import Final

from planner_reactor.errors import InputError, nearest
from planner_reactor.logic.domain import ActionSchema, Condition, Domain
from planner_reactor.logic.formulas import Atom, Term, filled
from planner_reactor.planner.situations import Situation
from planner_reactor.planner.theory import Theory

_FACT: Final = re.compile(r"\s*([A-Za-z]\w*)\s*\(([\w\s,]*)\)\s*")


def chosen_goal(domain: Domain, goal: str | None) -> str:
    """The goal to plan for: the one named, else the first of the domain; InputError if there is none."""
    if goal is None and domain.goals:
        return next(iter(domain.goals))
    if goal is None or goal not in domain.goals:
        hint = nearest(goal or "", domain.goals) or f"the domain has {', '.join(domain.goals) or 'no goal'}"
        raise InputError(f"{domain.file}: no goal {goal or ''}, {hint}")
    return goal


def pursued(domain: Domain, goal: str) -> tuple[str, ...]:
    """This goal, those that are kept at all times, and those that stand in for what is disabled."""
    return tuple(dict.fromkeys((goal, *(g.name for g in domain.goals.values() if g.kept or g.instead))))


def guarded(domain: Domain, goal: str) -> tuple[Situation, ...]:
    """The situations instead of which this goal is pursued, while they are disabled; none if it always is."""
    return tuple(
        Situation(atom.predicate, tuple(None if type(a) is int else a for a in atom.arguments))
        for atom in domain.goals[goal].instead
    )


def must_follow(domain: Domain, before: Domain, goals: tuple[str, ...]) -> None:
    """Can this text take the place of that one while reactions of that one are at work?"""
    for goal in goals:
        chosen_goal(domain, goal)
        if guarded(domain, goal) != guarded(before, goal):
            raise InputError(f"{domain.file}: goal {goal} acts instead of others than before")
    for name in before.assumptions:
        if name not in domain.assumptions:
            raise InputError(f"{domain.file}: no assumption {name}, and reactions in place may rest on it")
    for name, schema in before.schemas.items():
        other = domain.schemas.get(name)
        if other is None or (other.inputs, other.outputs, len(other.executability)) != (
            schema.inputs, schema.outputs, len(schema.executability),
        ):  # fmt: skip
            raise InputError(f"{domain.file}: action {name} takes, gives or needs something else than before")


def with_fact(domain: Domain, fact: str, *, holds: bool) -> Domain:
    """The domain with a fact such as `Machine(mill)`, or without it; InputError if it is none, or is so already."""
    match = _FACT.fullmatch(fact)
    if match is None:
        raise InputError(f"fact is {fact!r}, expected a predicate and constants, such as Machine(mill)")
    arguments = tuple(part.strip() for part in match[2].split(",")) if match[2].strip() else ()
    atom = Atom(match[1], arguments)
    facts = [known for known_ones in domain.facts.values() for known in known_ones]
    alike = [len(known.arguments) for known in facts if known.predicate == atom.predicate]
    if holds == (atom in facts) or (alike and len(arguments) not in alike):
        hint = nearest(fact, map(str, facts)) or f"the facts are {', '.join(map(str, facts))}"
        raise InputError(f"{fact} is {'a fact already' if atom in facts else 'no fact'}, {hint}")
    facts = [*facts, atom] if holds else [known for known in facts if known != atom]
    return Domain(
        assumptions=domain.assumptions.values(), goals=domain.goals.values(), rules=domain.rules,
        exclusions=domain.exclusions, persistences=[p for several in domain.persistences.values() for p in several],
        facts=facts, schemas=domain.schemas.values(), resources=domain.resources.values(), file=domain.file,
    )  # fmt: skip


def root_schema(theory: Theory, goal_name: str) -> ActionSchema:
    """The goal as an abstract action without parameters: from the facts that may change to what is
    wanted (R (13)).

    If facts say for which things the antecedent holds, the goal is meant for each of them, else for
    whatever an action brings.
    """
    goal = theory.domain.goals[goal_name]
    cases = list(_known_cases(theory, goal.antecedent))
    wanted: Iterable[Atom]
    if cases and goal.antecedent:
        wanted = dict.fromkeys(filled(atom, case) for case in cases for atom in goal.consequent)
    else:
        wanted = (*goal.antecedent, *goal.consequent)
    names = tuple(f"x{n}" for n in range(goal.size))
    facts = [fact for predicate in theory.domain.facts if predicate in theory.changing
             for fact in theory.domain.facts[predicate]]  # fmt: skip
    return ActionSchema(
        goal.name,
        names,
        executability=tuple(Condition(fact) for fact in facts),
        expansions=tuple(wanted),
        place=goal.place,
    )


def _known_cases(theory: Theory, atoms: tuple[Atom, ...]) -> Iterator[dict[int, Term]]:
    """The ways in which lasting facts satisfy the atoms."""
    cases: list[dict[int, Term]] = [{}]
    for atom in atoms:
        facts = theory.domain.facts.get(atom.predicate, ()) if atom.predicate not in theory.changing else ()
        found = []
        for case in cases:
            for fact in facts:
                extended = dict(case)
                if all(
                    extended.setdefault(a, b) == b if type(a) is int else a == b
                    for a, b in zip(atom.arguments, fact.arguments, strict=True)
                ):
                    found.append(extended)
        cases = found
    yield from cases
