"""What could spoil a plan, and how order prevents it (R §7.4: constraints enforced by propagation).

A link is threatened by a step that puts an end to what it protects (an exclusion of the causal theory),
and, if nothing makes that last, by every step that takes time. The threatening step must then end before
the supporting one starts, or start after the supported one. What a rule concludes on assumptions is also
spoiled if the plan itself ends it and is done again: then it may not be relied upon at all (R S: retrying
must be idempotent).
"""

from __future__ import annotations

from collections.abc import Iterator

import msgspec

from planner_reactor.logic.formulas import Atom, Bindings, Numeral
from planner_reactor.planner.plan import BEFORE, END, NOT_LATER, START, Link, Parameter, Plan, Step
from planner_reactor.planner.problem import Problem


class Threats(msgspec.Struct, eq=False):
    """Finds and resolves the threats to the links of a plan."""

    problem: Problem
    plan: Plan

    def resolve(self, links: int = 0, steps: int = 0) -> bool:
        """Order the steps so that no link is threatened; False if that is impossible.

        Pairs of one of the first `links` links and one of the first `steps` steps are known to be safe.
        """
        return self._order(list(self._open(links, steps)))

    def _order(self, threats: list[tuple[Link, Step]]) -> bool:
        """Apply what leaves no choice, then try the choices that remain."""
        plan = self.plan
        while True:
            choices = []
            for link, step in threats:
                if not self._is_safe(link, step):
                    ways = [way for way in self._ways(link, step) if self._possible(*way)]
                    if not ways:
                        return False
                    choices.append((link, step, ways))
            forced = [ways[0] for _, _, ways in choices if len(ways) == 1]
            if not forced:
                break
            if not all(plan.order(*way) for way in forced):
                return False
            threats = [(link, step) for link, step, _ in choices]
        if not choices:
            return True
        rest = [(link, step) for link, step, _ in choices]
        mark = plan.mark()
        for way in choices[0][2]:
            if plan.order(*way) and self._order(rest):
                return True
            plan.undo(mark)
        return False

    def _open(self, links: int, steps: int) -> Iterator[tuple[Link, Step]]:
        plan, ends = self.plan, self.problem.theory.ends
        enders: dict[str, list[Step]] = {}
        for step in plan.steps:
            for predicate in ends.get(step.schema.name, ()):
                enders.setdefault(predicate, []).append(step)
        persistent = self.problem.theory.domain.persistences
        for n, link in enumerate(plan.links):
            predicate = link.atom.predicate
            if link.lost or link.maintained or not (predicate in enders or predicate in persistent):
                continue
            since = steps if n < links else 0
            fragile = self.is_fragile(link)
            for step in plan.steps[since:] if fragile else enders.get(predicate, ()):
                if step.number in (link.producer, link.consumer) or step.number - plan.first < since:
                    continue
                if (fragile and not step.schema.senses) or self.ends(step, link.atom):
                    yield link, step

    def is_fragile(self, link: Link) -> bool:
        """Does nothing make it last beyond the moment when it is brought about?"""
        if link.producer == START or (self.problem.enduring and link.consumer == END):
            return False
        return not self.problem.beliefs.lasting(self.plan.bindings.ground(link.atom)).holds

    def _is_safe(self, link: Link, step: Step) -> bool:
        plan = self.plan
        if link.producer != START and plan.is_before(step.number, link.producer):
            return True
        if link.consumer == END:
            return False
        allowed = BEFORE if link.throughout else NOT_LATER
        return plan.network.relation(link.consumer, step.number) & ~allowed == 0

    def _ways(self, link: Link, step: Step) -> Iterator[tuple[int, int, int]]:
        if link.producer != START:
            yield step.number, link.producer, BEFORE
        if link.consumer != END:
            yield link.consumer, step.number, BEFORE

    def _possible(self, first: int, second: int, relation: int) -> bool:
        return self.plan.network.relation(first, second) & relation != 0

    def ends(self, step: Step, atom: Atom) -> bool:
        """Does an effect of the step exclude the atom, as far as is known by now?"""
        if not self.problem.theory.may_end(step.schema, atom.predicate):
            return False
        wanted = self.plan.bindings.ground(atom)
        return any(self._excludes(step, effect.atom, wanted) for effect in step.effects())

    def _excludes(self, step: Step, effect: Atom, wanted: Atom) -> bool:
        ground = self.plan.bindings.ground
        for exclusion, one, other in self.problem.theory.domain.excluding.get(effect.predicate, ()):
            if other.predicate != wanted.predicate:
                continue
            offset = self.plan.fresh(exclusion.size)
            trial = Bindings()
            if not (
                trial.unify(one.shifted(offset).arguments, ground(effect).arguments)
                and trial.unify(other.shifted(offset).arguments, wanted.arguments)
            ):
                continue
            pairs = [Atom("", pair).shifted(offset).arguments for pair in exclusion.distinct]
            if all(trial.walk(a) != trial.walk(b) for a, b in pairs) and all(
                self._holds_beside(step, trial, given.shifted(offset)) for given in exclusion.given
            ):
                return True
        return False

    def _holds_beside(self, step: Step, trial: Bindings, given: Atom) -> bool:
        """Is this a further effect of the step, or known at the start?"""
        ground = self.plan.bindings.ground
        beside = [ground(effect.atom) for effect in step.effects()] + [t.atom for t in self.problem.truths]
        beside += [ground(link.atom) for link in self.plan.links if link.consumer == step.number]
        for atom in beside:
            mark = trial.mark()
            if atom.predicate == given.predicate and trial.unify(given.arguments, atom.arguments):
                return True
            trial.undo(mark)
        return False

    def spoils_itself(self) -> bool:
        """Does a rule's conclusion fail when the plan is done again, because the plan itself ended it?"""
        again = self.problem.replayed
        if again is None:
            return False
        for link in self.plan.links:
            if link.derived:
                atom = self.plan.bindings.ground(link.atom)
                if all(_is_same_again(a, again) for a in atom.arguments) and self._is_ended(atom):
                    return True
        return False

    def _is_ended(self, atom: Atom) -> bool:
        for step in self.plan.steps:
            if self.ends(step, atom):
                restored = any(
                    self.plan.bindings.ground(effect.atom) == atom
                    for other in self.plan.steps
                    if other is step or self.plan.is_before(step.number, other.number)
                    for effect in other.effects()
                )
                if not restored:
                    return True
        return False


def _is_same_again(term: object, again: frozenset[int]) -> bool:
    if isinstance(term, Parameter):
        return term.number in again
    return isinstance(term, str | Numeral)
