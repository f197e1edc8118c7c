"""Why an adaptation was issued, and why its reactions are what they are: as data, and to be read.

`Because` says what set it off: a goal, a stub, an assumption, a perception, or another adaptation. `Reasons` say for
one situation what is wanted of it, which action is there for which condition, on which assumptions it rests and for
what. A refinement is a function of its situation, its context and the beliefs (decision 0014), so nothing but these
is kept: the reasons are found by planning once more, when somebody asks.
"""

from __future__ import annotations

from collections.abc import Iterator

import msgspec

from planner_reactor.errors import InputError
from planner_reactor.logic.domain import ActionSchema
from planner_reactor.logic.formulas import Atom, Term, variables
from planner_reactor.planner.because import Because
from planner_reactor.planner.beliefs import Beliefs
from planner_reactor.planner.plan import START, Link, Plan, Step
from planner_reactor.planner.problem import Problem
from planner_reactor.planner.reactions import names_of
from planner_reactor.planner.refinement import Refining
from planner_reactor.planner.situations import Context, Situation
from planner_reactor.planner.structure import action_of
from planner_reactor.planner.theory import Theory
from planner_reactor.planner.thinking import finish


class Reason(msgspec.Struct, frozen=True):
    """An action and what it is there for: conditions of other actions, or of the end."""

    action: str
    serves: tuple[str, ...]


class Reasons(msgspec.Struct, frozen=True):
    """Why a reaction is what it is. `wanted` must hold when it succeeds; `given` is what it counts on from its
    callers, `not_given` what it cannot; `rests_on` are assumptions with what they are needed for.
    """

    situation: str
    wanted: tuple[str, ...] = ()
    given: tuple[str, ...] = ()
    not_given: tuple[str, ...] = ()
    steps: tuple[Reason, ...] = ()
    rests_on: tuple[tuple[str, tuple[str, ...]], ...] = ()
    brings_in: tuple[str, ...] = ()
    missed: tuple[str, ...] = ()


class Explanation(msgspec.Struct, frozen=True):
    """Why one adaptation was issued."""

    adaptation: int
    purpose: str
    because: tuple[Because, ...]
    situations: tuple[Reasons, ...]

    def __str__(self) -> str:
        return "\n".join(_lines(self))


class Subject(msgspec.Struct, frozen=True):
    """One situation of an adaptation, and all that its refinement depended on."""

    name: str
    situation: Situation
    schema: ActionSchema
    context: Context
    beliefs: Beliefs


class Record(msgspec.Struct, frozen=True):
    """What is kept of an adaptation, so that it can be explained."""

    adaptation: int
    purpose: str
    because: tuple[Because, ...]
    subjects: tuple[Subject, ...]


def explain(record: Record, theory: Theory, *, fold: bool) -> Explanation:
    """The reasons behind an adaptation."""
    reasons = tuple(reasons_for(subject, theory, fold=fold) for subject in record.subjects)
    return Explanation(record.adaptation, record.purpose, record.because, reasons)


def unrecorded(adaptation: int, last: int) -> Explanation:
    """Of an adaptation of which nothing is kept; InputError if there was none."""
    if not 0 < adaptation <= last:
        raise InputError(f"no adaptation {adaptation}, the last is {last}")
    return Explanation(adaptation, "monitors and requests", (), ())


def reasons_for(subject: Subject, theory: Theory, *, fold: bool) -> Reasons:
    """Plan a situation once more, and say why it comes out as it does."""
    work = Refining(theory, subject.beliefs, subject.schema, subject.situation, subject.context, fold)
    refinement = finish(work.run())
    if refinement.composition is None:
        return Reasons(subject.name)
    called = names_of(subject.situation, refinement.composition, fold=fold)
    told = _Told(called)
    problem, first = work.plans[0]
    steps = [Reason(told.action(plan, s), told.served(plan, s)) for _, plan in work.plans for s in plan.steps]
    return Reasons(
        subject.name,
        tuple(told.atom(first.bindings.ground(g)) for g in problem.goals[: len(problem.goals) - problem.kept]),
        tuple(told.atom(truth.atom) for truth in problem.truths if not truth.lost),
        tuple(told.atom(truth.atom) for truth in problem.truths if truth.lost),
        tuple(dict.fromkeys(steps)),
        told.assumptions(work.plans, refinement.required),
        tuple(sorted(refinement.presumed)),
        tuple(sorted(refinement.missing)),
    )


class _Told:
    """Turns terms into the words of the reaction's text."""

    def __init__(self, names: dict[Term, str]) -> None:
        self._names = names

    def atom(self, atom: Atom) -> str:
        return f"{atom.predicate}({', '.join(map(self._term, atom.arguments))})"

    def _term(self, term: Term) -> str:
        known = self._names.get(term)
        return known if known is not None else str(term) if isinstance(term, str) else "something"

    def action(self, plan: Plan, step: Step) -> str:
        action = action_of(plan, step.number)
        arguments = ", ".join(map(self._term, action.arguments))
        return f"{action.name}[{arguments}]" if arguments else action.name

    def served(self, plan: Plan, step: Step) -> tuple[str, ...]:
        """The conditions that the step is there for."""
        found = [self._link(plan, link) for link in plan.links if link.producer == step.number]
        return tuple(dict.fromkeys(found))

    def _link(self, plan: Plan, link: Link) -> str:
        atom = self.atom(plan.bindings.ground(link.atom))
        return atom if link.consumer < 0 else f"{atom} of {self.action(plan, plan.step(link.consumer))}"

    def assumptions(
        self, plans: list[tuple[Problem, Plan]], required: frozenset[str]
    ) -> tuple[tuple[str, tuple[str, ...]], ...]:
        """Assumption → what rests on it."""
        found: dict[str, dict[str, None]] = {name: {} for name in sorted(required)}
        for problem, plan in plans:
            for name, about in _rests(problem, plan):
                if name in found:
                    found[name].setdefault(self.atom(about) if about.arguments else about.predicate)
        return tuple((name, tuple(about)) for name, about in found.items())


def _rests(problem: Problem, plan: Plan) -> Iterator[tuple[str, Atom]]:
    for use in plan.uses:
        if use.required and use.about is not None:
            yield use.assumption, plan.bindings.ground(use.about)
    for link in plan.links:
        atom = plan.bindings.ground(link.atom)
        if link.producer != START and not list(variables((atom,))):
            for name in sorted(problem.beliefs.lasting(atom).used):
                yield name, atom


def _lines(explanation: Explanation) -> Iterator[str]:
    yield f"{explanation.adaptation}. {explanation.purpose}"
    if explanation.because:
        yield f"   because {'; '.join(map(str, explanation.because))}"
    for reasons in explanation.situations:
        yield f"   {reasons.situation}, for {', '.join(reasons.wanted) or 'nothing'}"
        for label, said in (
            ("counts on", reasons.given), ("cannot count on", reasons.not_given), ("brings in", reasons.brings_in),
            ("would be otherwise with", reasons.missed),
        ):  # fmt: skip
            if said:
                yield f"      {label} {', '.join(said)}"
        for step in reasons.steps:
            yield f"      {step.action}: {', '.join(step.serves) or 'finds out'}"
        for name, about in reasons.rests_on:
            yield f"      rests on {name}" + (f": {', '.join(about)}" if about else "")
