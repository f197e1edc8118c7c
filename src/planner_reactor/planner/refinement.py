"""One situation made concrete: from an abstract action and what its callers grant to a composition of
actions.

`refine` searches for a plan of the action's expansions, plans what to do when a test fails whose failure
says something (`otherwise`), finds the cleanup for a failure half-way, and works out what each
sub-situation may count on. It depends on nothing but its arguments: the same situation, context and beliefs
always give the same refinement, so that planning in increments and planning anew agree.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import msgspec
from msgspec.structs import replace

from planner_reactor.logic.domain import ActionSchema
from planner_reactor.logic.formulas import Atom, Numeral, Term, filled, variables
from planner_reactor.planner.beliefs import Beliefs
from planner_reactor.planner.plan import END, START, Link, Parameter, Plan, Step
from planner_reactor.planner.problem import Consulted, Problem, Truth
from planner_reactor.planner.reach import Reach
from planner_reactor.planner.search import Search
from planner_reactor.planner.situations import Child, Composition, Context, Refinement, Situation, situation_of
from planner_reactor.planner.structure import (
    Action,
    Tree,
    action_of,
    arrange,
    as_long_as_asked,
    needed_before,
)
from planner_reactor.planner.theory import Theory
from planner_reactor.planner.thinking import Work, finish
from planner_reactor.planner.threats import Threats

NESTED_TESTS = 3
"""How many tests may stand in each other's else-branches."""


def refine(
    theory: Theory, beliefs: Beliefs, schema: ActionSchema, situation: Situation, context: Context, *, fold: bool
) -> Refinement:
    """The refinement of a situation of this abstract action. Without `fold` sub-situations keep their
    constants.
    """
    return finish(refining(theory, beliefs, schema, situation, context, fold=fold))


def refining(
    theory: Theory, beliefs: Beliefs, schema: ActionSchema, situation: Situation, context: Context, *, fold: bool
) -> Work[Refinement]:
    """The same as work that can be interrupted."""
    return Refining(theory, beliefs, schema, situation, context, fold).run()


class Refining(msgspec.Struct, eq=False):
    """One refinement being worked out; `plans` are those behind it, the first its own, others of branches."""

    theory: Theory
    beliefs: Beliefs
    schema: ActionSchema
    situation: Situation
    context: Context
    fold: bool
    consulted: Consulted = msgspec.field(default_factory=Consulted)
    required: set[str] = msgspec.field(default_factory=set)
    presumed: set[str] = msgspec.field(default_factory=set)
    children: list[Child] = msgspec.field(default_factory=list)
    outputs: list[tuple[Term, ...]] = msgspec.field(default_factory=list)
    cleanup: dict[Action, None] = msgspec.field(default_factory=dict)
    upsets: set[Action] = msgspec.field(default_factory=set)
    warnings: list[str] = msgspec.field(default_factory=list)
    plans: list[tuple[Problem, Plan]] = msgspec.field(default_factory=list)
    numbered: int = 0  # steps of all plans so far

    def run(self) -> Work[Refinement]:
        problem = self._problem()
        tree = yield from self._solve(problem, NESTED_TESTS)
        composition = None
        if tree is not None:
            composition = Composition(tree, tuple(self.outputs), tuple(self.cleanup), frozenset(self.upsets))
        return Refinement(
            self.situation,
            composition,
            tuple(self.children),
            frozenset(self.required),
            frozenset(self.presumed - self.required),
            frozenset(self.consulted.missing),
            tuple(self.consulted.asked),
            frozenset(self.consulted.blocked),
            tuple(dict.fromkeys(self.warnings)),
            self.consulted.gave_up,
            frozenset(self.presumed | self.required),
            unreachable=() if tree is not None else Reach(problem, self.consulted).out_of_reach(),
        )

    # ------------------------------------------------------------------------------------- the problem

    def _problem(self) -> Problem:
        schema = self.schema
        given = {
            variable: Parameter(n) if constant is None else constant
            for n, (variable, constant) in enumerate(zip(schema.inputs, self.situation.arguments, strict=True))
        }
        conditions = [filled(condition.atom, given) for condition in schema.executability]
        truths = [
            Truth(atom, not lasts)
            for atom, lasts in zip(conditions, self.context.granted, strict=True)
            if not list(variables((atom,)))
        ]
        goals = [filled(atom, given) for atom in schema.expansions]
        problem = Problem(
            self.theory,
            self.beliefs,
            tuple(dict.fromkeys(truths)),
            tuple(goals),
            self.context.forbidden | self.theory.alternatives.get(schema.name, frozenset()),
            outputs=schema.outputs,
            replayed=self.context.replayed,
            variables=schema.size,
            enduring=schema.name not in self.theory.domain.schemas,
            maintained=schema.name in self.theory.kept,
            upheld=self.theory.upheld_beside(schema.name),
        )
        kept = [t.atom for t in problem.truths if t.atom not in goals and self._is_kept(problem, given, t)]
        return replace(problem, goals=(*goals, *kept), kept=len(kept))

    def _is_kept(self, problem: Problem, given: dict[int, Term], truth: Truth) -> bool:
        """Must this still hold at the end? It could be ended, and the action does not say that it ends it."""
        if truth.lost or truth.atom.predicate not in self.theory.changing:
            return False
        if not self.beliefs.lasting(truth.atom).holds:
            return False
        scratch = Plan()
        step = scratch.add(self.schema)
        for variable, term in given.items():
            scratch.bindings.bind(step.offset + variable, term)
        return not Threats(problem, scratch).ends(step, truth.atom)

    # --------------------------------------------------------------------------------------- its plan

    def _solve(self, problem: Problem, depth: int) -> Work[Tree | None]:
        plan = yield from Search(problem, Plan(first=self.numbered), self.consulted).solve()
        if plan is None:
            return None
        self.numbered += len(plan.steps)
        self.plans.append((problem, plan))
        self._count(problem, plan)
        self._look_at_lasting(problem, plan)
        self.outputs.append(tuple(plan.bindings.walk(term) for term in problem.outputs))
        otherwise: dict[int, Tree] = {}
        for step in plan.steps:
            if step.schema.otherwise and depth:
                tree = yield from self._solve(_after_failure(problem, plan, step), depth - 1)
                if tree is not None:
                    otherwise[step.number] = tree
        after = _After(plan, otherwise)
        for step in plan.steps:
            yield
            self._look_after(problem, after, step)
        tree = arrange(plan, otherwise)
        return as_long_as_asked(tree) if problem.maintained else tree

    def _look_at_lasting(self, problem: Problem, plan: Plan) -> None:
        """What finishes time (13), once it is reached, must not be ended when the goal is pursued again."""
        goal = self.theory.domain.goals.get(self.schema.name)
        if goal is None or not problem.enduring:
            return
        lasting = {atom.predicate for atom, lasts in zip(goal.consequent, goal.lasting, strict=True) if lasts}
        for atom in map(plan.bindings.ground, problem.goals):
            known = all(isinstance(argument, str | Numeral) for argument in atom.arguments)
            if atom.predicate in lasting and known:  # of other things it is said anew each time
                self.warnings += [
                    f"{atom} in {goal.name} is to hold to the end of time, and {step.schema.name} ends it whenever the "
                    f"goal is pursued again"
                    for step in plan.steps
                    if Threats(problem, plan).ends(step, atom)
                ]

    def _count(self, problem: Problem, plan: Plan) -> None:
        """Note the assumptions on which the plan rests, and those that it only brings in."""
        for use in plan.uses:
            (self.required if use.required else self.presumed).add(use.assumption)
        for link in plan.links:
            if link.atom.predicate in self.theory.domain.persistences and link.producer != START and not link.lost:
                lasting = self.beliefs.lasting(plan.bindings.ground(link.atom))
                if problem.enduring and link.consumer == END:
                    continue
                abstract = link.consumer >= 0 and plan.step(link.consumer).schema.abstract
                if lasting.used and not self._is_fresh(plan, link, abstract=abstract):
                    (self.presumed if abstract else self.required).update(lasting.used)

    def _is_fresh(self, plan: Plan, link: Link, *, abstract: bool) -> bool:
        """Is it used as soon as it is brought about, so that it need not last?"""
        if link.maintained:
            return True
        instant = link.consumer >= 0 and plan.step(link.consumer).schema.senses
        if link.throughout and not instant:
            return False
        return not any(
            not step.schema.senses
            and step.number not in (link.producer, link.consumer)
            and not plan.is_before(step.number, link.producer)
            and (link.consumer == END or not plan.is_before(link.consumer, step.number))
            for step in plan.steps
        )

    def _look_after(self, problem: Problem, after: _After, step: Step) -> None:
        """What one step means for others: a sub-situation, a cleanup, a test that may fail for ever."""
        if step.schema.abstract:
            self._add_child(after, step)
        self._add_cleanup(problem, after.plan, step)
        if step.schema.senses and step.number not in after.otherwise and not after.has_achiever(step):
            self.warnings.append(
                f"{step.schema.name} in {self.situation.schema}: nothing there can change what it tests, "
                f"so that it may fail for ever"
            )

    def _add_child(self, after: _After, step: Step) -> None:
        action = action_of(after.plan, step.number)
        lost = {link.condition for link in after.links_to(step) if link.lost}
        granted = tuple([n not in lost for n in range(len(step.schema.executability))])
        fails = any(not after.plan.is_before(other, step.number) for other in after.may_fail)
        again = self.context.replayed
        same = frozenset(
            n
            for n, argument in enumerate(action.arguments)
            if isinstance(argument, Parameter) and (fails or (again is not None and argument.number in again))
        )
        replayed = None if again is None and not fails else same
        situation = situation_of(action, fold=self.fold)
        self.children.append(Child(situation, action.arguments, granted, replayed))

    # -------------------------------------------------------------------------------- failing half-way

    def _add_cleanup(self, problem: Problem, plan: Plan, step: Step) -> None:
        """If the step ends what held at the start, a failure from then on must bring it about again."""
        threats = Threats(problem, plan)
        for truth in problem.truths:
            if not truth.lost and threats.ends(step, truth.atom):
                for action in self._cleanups(plan, step, truth.atom):
                    self.cleanup.setdefault(action)
                    self.upsets.add(action_of(plan, step.number))

    def _cleanups(self, plan: Plan, step: Step, atom: Atom) -> Iterator[Action]:
        for schema, effect in self.theory.domain.producers.get(atom.predicate, ()):
            if schema.cleanup:
                mark = plan.mark()
                cleaning = plan.add(schema)
                if plan.bindings.unify(effect.atom.shifted(cleaning.offset).arguments, atom.arguments):
                    arguments = self._matched(plan, step, cleaning)
                    if all(isinstance(a, str | Numeral | Parameter) for a in arguments):
                        yield Action(schema.name, False, arguments)
                plan.undo(mark)

    def _matched(self, plan: Plan, step: Step, cleaning: Step) -> tuple[Term, ...]:
        """The arguments of a cleanup for what the step has brought about."""
        for condition in cleaning.schema.executability:
            wanted = condition.atom.shifted(cleaning.offset)
            for effect in step.effects():
                mark = plan.bindings.mark()
                if effect.atom.predicate == wanted.predicate:
                    if plan.bindings.unify(wanted.arguments, effect.atom.arguments):
                        break
                    plan.bindings.undo(mark)
        return plan.arguments(cleaning)


class _After:
    """A finished plan: what supports each step, and which basic steps may fail without a branch for it."""

    def __init__(self, plan: Plan, otherwise: Mapping[int, Tree]) -> None:
        self.plan = plan
        self.otherwise = otherwise
        self.may_fail = [s.number for s in plan.steps if not s.schema.abstract and s.number not in otherwise]
        self._links: dict[int, list[Link]] = {}
        for link in plan.links:
            self._links.setdefault(link.consumer, []).append(link)

    def links_to(self, step: Step) -> Sequence[Link]:
        return self._links.get(step.number, ())

    def has_achiever(self, test: Step) -> bool:
        """Does something that the test looks at come from another step, so that a retry may change it?"""
        return not test.schema.executability or any(link.producer not in (START, END) for link in self.links_to(test))


def _after_failure(problem: Problem, plan: Plan, test: Step) -> Problem:
    """What is to be planned if the test aborts: the same goals, from what holds then."""
    threats = Threats(problem, plan)
    before = [plan.step(n) for n in needed_before(plan, test.number)]
    ground = plan.bindings.ground
    truths = [t for t in problem.truths if not any(threats.ends(step, t.atom) for step in before)]
    for step in before:
        later = [other for other in before if other is not step and not plan.is_before(other.number, step.number)]
        for effect in step.effects():
            atom = ground(effect.atom)
            if not any(threats.ends(other, atom) for other in later):
                truths.append(Truth(atom, not problem.beliefs.lasting(atom).holds))
    truths.extend(Truth(ground(effect.atom.shifted(test.offset))) for effect in test.schema.otherwise)
    named = [t for t in truths if not list(variables((t.atom,)))]
    barred = problem.barred | {(test.schema.name, plan.arguments(test))}
    return replace(problem, truths=tuple(dict.fromkeys(named)), barred=barred)
