"""Part of a plan done again for other constants.

Conditions that are alike but for constants that the domain does not tell apart have plans that are alike:
the search solves the first group of them and repeats its part of the plan for the others, so that a hundred
cost little more than one.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import msgspec
from msgspec.structs import replace

from planner_reactor.logic.allen import ALL
from planner_reactor.logic.formulas import Atom, Term, variables
from planner_reactor.planner.beliefs import Beliefs, told_apart
from planner_reactor.planner.plan import END, Link, Plan, Result, Step, Unnamed
from planner_reactor.planner.problem import Goal
from planner_reactor.planner.theory import Theory


class Part(msgspec.Struct, frozen=True):
    """Steps and links of a plan that solve one group of goals, with what their variables stand for.

    `values` are those of the variables of each step, `reached` those of the arguments of each goal; `orders` say
    how the steps lie to each other and to the others. Steps that have nothing to do with the constants of the
    group are not among them: what is needed once serves all groups. `entangled`: a link begins at a step of
    another part, so that it cannot be repeated.
    """

    goals: tuple[Atom, ...]
    reached: tuple[tuple[Term, ...], ...]
    steps: tuple[Step, ...]
    values: tuple[tuple[Term, ...], ...]
    links: tuple[Link, ...]
    orders: tuple[tuple[int, int, int], ...]
    entangled: bool


def part_of(theory: Theory, plan: Plan, goals: tuple[Atom, ...], first: int, start: int) -> Part:
    """The part `steps[first:]`, `links[start:]` of a plan, which solves these goals."""
    walk, ground = plan.bindings.walk, plan.bindings.ground
    values = {s.number: tuple([walk(s.offset + v) for v in range(s.schema.size)]) for s in plan.steps[first:]}
    own = _own(theory, goals, values)
    steps = tuple([step for step in plan.steps[first:] if step.number in own])
    links = [link for link in plan.links[start:] if link.consumer not in values or link.consumer in own]
    numbers = [step.number for step in plan.steps]
    relation = plan.network.relation
    return Part(
        goals,
        tuple(ground(goal).arguments for goal in goals),
        steps,
        tuple([values[step.number] for step in steps]),
        tuple(replace(link, atom=ground(link.atom)) for link in links),
        tuple((a, b, r) for a in values if a in own for b in numbers if a != b and (r := relation(a, b)) != ALL),
        any(link.producer >= plan.first and link.producer not in values for link in plan.links[start:]),
    )


def _own(theory: Theory, goals: tuple[Atom, ...], values: Mapping[int, tuple[Term, ...]]) -> set[int]:
    """The steps that speak of the group's constants, or hand things to or take things from one that does."""
    constants = {a for goal in goals for a in goal.arguments if isinstance(a, str) and a in theory.alike}
    own = {number for number, terms in values.items() if not constants.isdisjoint(terms)}
    changed = True
    while changed:
        before = len(own)
        for number, terms in values.items():
            things = {t.step for t in terms if isinstance(t, Result | Unnamed)}
            if number in own:
                own |= things & values.keys()
            elif not things.isdisjoint(own):
                own.add(number)
        changed = len(own) > before
    return own if constants else set(values)


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
        condition = -1 if goal.consumer == END else goal.condition
        found.append((atom.predicate, tuple(terms), goal.relation, goal.consumer, condition))
    return tuple(found)


def repeat(plan: Plan, part: Part, goals: Sequence[Goal]) -> bool:
    """Do the part again for these goals, which have the same pattern; False (and nothing done) if it
    is entangled.
    """
    if part.entangled:
        return False
    mapping = _Mapping(plan, part, goals)
    for step, values in zip(part.steps, part.values, strict=True):
        again = Step(mapping.step(step.number), step.schema, plan.fresh(step.schema.size))
        for variable, value in enumerate(values):
            if type(value) is not int:
                plan.bindings.bind(again.offset + variable, mapping(value))
        plan.steps.append(again)
        plan.network.add(again.number)
    for link in part.links:
        atom = Atom(link.atom.predicate, tuple([mapping(a) for a in link.atom.arguments]))
        plan.links.append(
            Link(
                atom, mapping.step(link.producer), mapping.step(link.consumer), link.condition,
                link.throughout, link.maintained, link.derived, link.lost,
            )
        )  # fmt: skip
    mapping.bind_goals(goals)
    return all(plan.order(mapping.step(one), mapping.step(other), relation) for one, other, relation in part.orders)


class _Mapping:
    """From the terms of the part to those of its repetition."""

    def __init__(self, plan: Plan, part: Part, goals: Sequence[Goal]) -> None:
        self._plan = plan
        self._part = part
        new = plan.first + len(plan.steps)
        self._steps = {step.number: new + n for n, step in enumerate(part.steps)}
        self._constants: dict[Term, Term] = {}
        for old, goal in zip(part.goals, goals, strict=True):
            for a, b in zip(old.arguments, plan.bindings.ground(goal.atom).arguments, strict=True):
                if a != b and type(a) is not int:
                    self._constants[a] = b

    def __call__(self, term: Term) -> Term:
        if type(term) is Result and term.step in self._steps:
            return Result(self._steps[term.step], term.number)
        if type(term) is Unnamed and term.step in self._steps:
            return Unnamed(self._steps[term.step], term.number)
        return self._constants.get(term, term)

    def step(self, number: int) -> int:
        return self._steps.get(number, number)

    def bind_goals(self, goals: Sequence[Goal]) -> None:
        """The open variables of the goals stand for what those of the part stand for."""
        walk = self._plan.bindings.walk
        for reached, goal in zip(self._part.reached, goals, strict=True):
            for value, b in zip(reached, goal.atom.arguments, strict=True):
                open_ = walk(b)
                if type(open_) is int and type(value) is not int:
                    self._plan.bindings.bind(open_, self(value))
