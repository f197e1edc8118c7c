"""Part of a plan done again for other constants.

Conditions that are alike but for constants that the domain does not tell apart have plans that are alike:
the search solves the first group of them and repeats its part of the plan for the others, so that a hundred
cost little more than one.
"""

from __future__ import annotations

from collections.abc import Sequence

import msgspec
from msgspec.structs import replace

from planner_reactor.logic.formulas import Atom, Term, variables
from planner_reactor.planner.beliefs import Beliefs, told_apart
from planner_reactor.planner.plan import Plan, Result, Step, Unnamed
from planner_reactor.planner.problem import Goal
from planner_reactor.planner.theory import Theory


class Part(msgspec.Struct, frozen=True):
    """The steps, links and goals of a plan that solve one group: `steps[first:last]`, `links[start:stop]`."""

    goals: tuple[Atom, ...]
    first: int
    last: int
    start: int
    stop: int


def pattern(theory: Theory, beliefs: Beliefs, plan: Plan, goals: Sequence[Goal]) -> object:
    """What two groups have in common if the plan of one serves for the other."""
    apart = told_apart(beliefs.relaxed)
    atoms = tuple(plan.bindings.ground(goal.atom) for goal in goals)
    numbers: dict[Term, int] = {variable: n for n, variable in enumerate(variables(atoms))}
    found = []
    for goal, atom in zip(goals, atoms, strict=True):
        terms: list[tuple[object, object]] = []
        for argument in atom.arguments:
            kind = theory.alike.get(argument) if isinstance(argument, str) and argument not in apart else None
            if kind is not None:
                terms.append((kind, numbers.setdefault(argument, len(numbers))))
            else:
                terms.append(("variable", numbers[argument]) if type(argument) is int else ("", argument))
        found.append((atom.predicate, tuple(terms), goal.relation, goal.consumer, goal.condition))
    return tuple(found)


def repeat(plan: Plan, part: Part, goals: Sequence[Goal]) -> bool:
    """Do the part again for these goals, which have the same pattern; False (and nothing done) if it
    is entangled.
    """
    steps, links = plan.steps[part.first : part.last], plan.links[part.start : part.stop]
    own = {step.number for step in steps}
    shift = len(plan.steps) - part.first
    if any(link.producer >= plan.first and link.producer not in own for link in links):
        return False
    mapping = _Mapping(plan, part, own, shift, goals)
    bound = [[mapping(plan.bindings.walk(s.offset + v)) for v in range(s.schema.size)] for s in steps]
    for step, values in zip(steps, bound, strict=True):
        again = Step(step.number + shift, step.schema, plan.fresh(step.schema.size))
        for variable, value in enumerate(values):
            if type(value) is not int:
                plan.bindings.bind(again.offset + variable, value)
        plan.steps.append(again)
        plan.network.add(again.number)
    for link in links:
        atom = Atom(link.atom.predicate, tuple(mapping(a) for a in plan.bindings.ground(link.atom).arguments))
        plan.links.append(
            replace(link, atom=atom, producer=mapping.step(link.producer), consumer=mapping.step(link.consumer))
        )
    mapping.bind_goals(goals)
    others = [step.number for step in plan.steps[: part.first]]
    return all(
        plan.order(mapping.step(one), mapping.step(other), plan.network.relation(one, other))
        for one in own
        for other in (*own, *others)
        if one != other
    )


class _Mapping:
    """From the terms of the part to those of its repetition."""

    def __init__(self, plan: Plan, part: Part, own: set[int], shift: int, goals: Sequence[Goal]) -> None:
        self._plan = plan
        self._part = part
        self._own = own
        self._shift = shift
        self._constants: dict[Term, Term] = {}
        for old, goal in zip(part.goals, goals, strict=True):
            for a, b in zip(old.arguments, plan.bindings.ground(goal.atom).arguments, strict=True):
                if a != b and type(a) is not int:
                    self._constants[a] = b

    def __call__(self, term: Term) -> Term:
        if isinstance(term, Result) and term.step in self._own:
            return Result(term.step + self._shift, term.number)
        if isinstance(term, Unnamed) and term.step in self._own:
            return Unnamed(term.step + self._shift, term.number)
        return self._constants.get(term, term)

    def step(self, number: int) -> int:
        return number + self._shift if number in self._own else number

    def bind_goals(self, goals: Sequence[Goal]) -> None:
        """The open variables of the goals stand for what those of the part stand for."""
        walk = self._plan.bindings.walk
        for old, goal in zip(self._part.goals, goals, strict=True):
            for a, b in zip(old.arguments, goal.atom.arguments, strict=True):
                value, open_ = self(walk(a)), walk(b)
                if type(open_) is int and type(value) is not int:
                    self._plan.bindings.bind(open_, value)
