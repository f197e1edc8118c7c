"""The ways to support one open condition (R §7.4): chaining from effects to conditions.

In the order in which they are tried: what holds at the start, the effects of steps that are there already,
new abstract actions, rules, new basic actions. (What must hold at the end looks to the steps first.) A way,
when called, extends the plan and gives the new conditions that it raises, or None if it is not possible
after all; the caller undoes what it left.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from functools import partial
from typing import TypeAlias

import msgspec

from planner_reactor.logic.allen import compose, relations
from planner_reactor.logic.domain import ActionSchema, Effect, Rule
from planner_reactor.logic.formulas import Atom
from planner_reactor.planner.plan import END, START, WHOLE, Link, Plan, Step, Use
from planner_reactor.planner.problem import Consulted, Goal, Problem, Truth
from planner_reactor.planner.theory import DEEPEST

Way: TypeAlias = Callable[[], "list[Goal] | None"]

_EARLIER = relations(["b", "m", "o", "s", "d"])
"""The interval of a condition may end before that of its user, or that of an action before its effect's."""


class Supports(msgspec.Struct, eq=False):
    """Extends `plan` for `problem`; what it misses is noted in `consulted`."""

    problem: Problem
    plan: Plan
    consulted: Consulted = msgspec.field(default_factory=Consulted)

    def ways(self, goal: Goal, affords: Callable[[ActionSchema], bool]) -> Iterator[Way]:
        """Every way to support the goal; by new steps only of actions that can be afforded."""
        atom = self.plan.bindings.ground(goal.atom)
        at_end = goal.consumer == END
        if not at_end:
            yield from self._truths(goal, atom)
        yield from self._steps(goal, atom)
        if at_end:
            yield from self._truths(goal, atom)
        yield from self._actions(goal, atom, affords, abstract=True)
        if goal.depth < DEEPEST:
            for rule in self.problem.theory.domain.rules_for.get(atom.predicate, ()):
                yield partial(self._by_rule, goal, rule)
        yield from self._actions(goal, atom, affords, abstract=False)

    # ------------------------------------------------------------------------------- what is there already

    def _truths(self, goal: Goal, atom: Atom) -> Iterator[Way]:
        for truth in self.problem.truths:
            if truth.atom.predicate == atom.predicate:
                yield partial(self._by_truth, goal, truth)
        for fact in self.problem.theory.domain.facts.get(atom.predicate, ()):
            if fact.predicate not in self.problem.theory.changing:
                yield partial(self._by_fact, goal, fact)
        for told, holds in sorted(self.problem.beliefs.told, key=str):
            if holds and told.predicate == atom.predicate:
                yield partial(self._by_fact, goal, told)
        for kept in self.problem.upheld:
            if kept.predicate == atom.predicate:
                yield partial(self._by_upheld, goal, kept)

    def _by_upheld(self, goal: Goal, kept: Atom) -> list[Goal] | None:
        return [] if self.plan.bindings.unify(goal.atom.arguments, kept.arguments) else None

    def _by_fact(self, goal: Goal, fact: Atom) -> list[Goal] | None:
        lasting = self.problem.beliefs.lasting(fact)
        self.consulted.missing |= lasting.missing
        if not lasting.holds or not self.plan.bindings.unify(goal.atom.arguments, fact.arguments):
            return None
        self.plan.uses.extend(Use(name, True, goal.atom) for name in sorted(lasting.used))
        return []

    def _by_truth(self, goal: Goal, truth: Truth) -> list[Goal] | None:
        if not self.plan.bindings.unify(goal.atom.arguments, truth.atom.arguments):
            return None
        if self.problem.is_kept(goal):
            return self._linked(goal, Link(truth.atom, START, END, goal.condition))
        lasting = self.problem.beliefs.lasting(truth.atom)
        if truth.lost or not lasting.holds:
            self.consulted.missing |= lasting.missing
            if not self._is_abstract(goal.consumer):
                return None
            return self._linked(goal, Link(truth.atom, START, goal.consumer, goal.condition, lost=True))
        required = not self._is_abstract(goal.consumer)
        self.plan.uses.extend(Use(name, required, truth.atom) for name in sorted(lasting.used))
        return self._linked(goal, Link(truth.atom, START, goal.consumer, goal.condition, self._throughout(goal)))

    def _steps(self, goal: Goal, atom: Atom) -> Iterator[Way]:
        effects = self.problem.theory.effects
        for step in self.plan.steps:
            if step.number != goal.consumer and atom.predicate in effects[step.schema.name]:
                for effect in step.schema.effects:
                    if effect.atom.predicate == atom.predicate:
                        yield partial(self._by_step, goal, step, effect)

    def _by_step(self, goal: Goal, step: Step, effect: Effect) -> list[Goal] | None:
        """The effect of a step serves, if the step can lie where it must."""
        plan = self.plan
        if not plan.bindings.unify(goal.atom.arguments, effect.atom.shifted(step.offset).arguments):
            return None
        maintained = effect.relation & ~_EARLIER != 0
        if goal.consumer == (END if maintained else WHOLE):
            return None
        if goal.consumer != END and not plan.order(step.number, goal.consumer, compose(effect.relation, goal.relation)):
            return None
        atom = plan.bindings.ground(goal.atom)
        throughout = self._throughout(goal)
        lasting = self.problem.beliefs.lasting(atom)
        lost = False
        if not lasting.holds and not maintained:
            self.consulted.missing |= lasting.missing
            lost = self._is_abstract(goal.consumer)
            if throughout and not lost and not self._is_instant(goal.consumer):
                return None
        link = Link(atom, step.number, goal.consumer, goal.condition, throughout, maintained, lost=lost)
        return self._linked(goal, link)

    def _linked(self, goal: Goal, link: Link) -> list[Goal]:
        self.plan.links.append(link)
        return []

    # ---------------------------------------------------------------------------------------------- rules

    def _by_rule(self, goal: Goal, rule: Rule) -> list[Goal] | None:
        plan = self.plan
        offset = plan.fresh(rule.size)
        if not plan.bindings.unify(goal.atom.arguments, rule.head.shifted(offset).arguments):
            return None
        if rule.assumptions:
            if not self.assume((a.shifted(offset) for a in rule.assumptions), goal.atom):
                return None
            plan.links.append(Link(goal.atom, START, goal.consumer, goal.condition, derived=True))
        for one, other in rule.distinct:
            pair = Atom("", (one, other)).shifted(offset).arguments
            plan.distinct.append((pair[0], pair[1]))
        return [
            Goal(
                condition.atom.shifted(offset),
                compose(condition.relation, goal.relation),
                goal.consumer,
                goal.condition,
                goal.depth + 1,
            )
            for condition in rule.body
        ]

    # ---------------------------------------------------------------------------------------- new actions

    def _actions(
        self, goal: Goal, atom: Atom, affords: Callable[[ActionSchema], bool], *, abstract: bool
    ) -> Iterator[Way]:
        for schema, effect in self.problem.theory.achievers.get((atom.predicate, abstract), ()):
            if not _may_match(schema, effect, atom):
                continue
            if schema.name in self.problem.forbidden:
                self.consulted.blocked.add(schema.name)
            elif affords(schema):
                yield partial(self._by_action, goal, schema, effect)

    def _by_action(self, goal: Goal, schema: ActionSchema, effect: Effect) -> list[Goal] | None:
        step = self.plan.add(schema)
        if self._by_step(goal, step, effect) is None or not self._applicable(step):
            return None
        presumed = self.problem.beliefs.assume(schema.presumes)
        self.consulted.missing |= presumed.missing
        self.plan.uses.extend(Use(name, False, Atom(schema.name)) for name in sorted(presumed.used))
        return [
            Goal(condition.atom.shifted(step.offset), condition.relation, step.number, n)
            for n, condition in enumerate(schema.executability)
        ]

    def _applicable(self, step: Step) -> bool:
        """Do the conditions on selecting the action hold? One that is unknown is noted as asked for."""
        beliefs, bindings = self.problem.beliefs, self.plan.bindings
        for atom in step.schema.applicability:
            ground = bindings.ground(atom.shifted(step.offset))
            if atom.predicate in beliefs.domain.assumptions:
                if not self.assume((ground,), Atom(step.schema.name)):
                    return False
            elif not self._is_known(ground):
                return False
        return True

    def assume(self, atoms: Iterable[Atom], about: Atom) -> bool:
        """Rest the plan on these assumptions, if they hold, for what they are `about`; one whose arguments are
        still open waits for them.
        """
        plan, told = self.plan, []
        for atom in atoms:
            ground = plan.bindings.ground(atom)
            if any(type(argument) is int for argument in ground.arguments):
                plan.assumed.append(ground)
            else:
                told.append(ground)
        answer = self.problem.beliefs.assume(told)
        self.consulted.missing |= answer.missing
        plan.uses.extend(Use(name, True, about) for name in sorted(answer.used))
        return answer.holds

    def settle_assumed(self) -> bool:
        """Do the assumptions hold whose arguments were open? What is still open means all."""
        plan = self.plan
        answer = self.problem.beliefs.assume(plan.assumed, plan.bindings)
        self.consulted.missing |= answer.missing
        plan.uses.extend(Use(name, True) for name in sorted(answer.used))
        return answer.holds

    def _is_known(self, atom: Atom) -> bool:
        told = self.problem.beliefs.known(atom)
        if told is not None:
            return told
        if atom in self.problem.theory.domain.facts.get(atom.predicate, ()):
            return True
        if any(truth.atom == atom for truth in self.problem.truths):
            return True
        if all(isinstance(a, str) for a in atom.arguments):
            self.consulted.asked.setdefault(atom)
        return False

    # ---------------------------------------------------------------------------------------- small parts

    def _is_abstract(self, consumer: int) -> bool:
        return consumer >= 0 and self.plan.step(consumer).schema.abstract

    def _is_instant(self, consumer: int) -> bool:
        return consumer >= 0 and self.plan.step(consumer).schema.senses

    def _throughout(self, goal: Goal) -> bool:
        return goal.consumer >= 0 and goal.relation & _EARLIER == 0


def _may_match(schema: ActionSchema, effect: Effect, atom: Atom) -> bool:
    """Could this effect be the atom, as far as constants and new things show?"""
    seen: dict[int, object] = {}
    for own, wanted in zip(effect.atom.arguments, atom.arguments, strict=True):
        free = type(wanted) is int
        if type(own) is not int:
            if not free and own != wanted:
                return False
        elif own in schema.outputs or own in schema.unnamed:
            if not free:
                return False
        elif seen.setdefault(own, wanted) != wanted and not free:
            return False
    return True
