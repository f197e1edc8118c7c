"""The planner: two loops that never end (R §7.1, §7.3, §7.5, Fig. 4).

The inner loop reduces the expectation, what the reactor for the assumptions held should have and does not
have yet, one situation at a time; when nothing is left the reactor is ω-ideal, and the outer loop relaxes
the assumption in use that is least likely to hold. Perceptions change what is done next:

    failed situations > failed assumptions > active stubs > quiescent stubs

A `step` is one short piece of work, so that a perception is never kept waiting. Nothing here depends on a
clock or on chance: the same perceptions between the same steps give the same adaptations.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import replace

from planner_reactor.link.messages import Adaptation, Mode, Perception
from planner_reactor.logic.domain import ActionSchema, Domain
from planner_reactor.logic.formulas import Atom
from planner_reactor.planner.agenda import (
    ACTIVE_STUB,
    FAILED_ASSUMPTION,
    FAILED_SITUATION,
    QUIESCENT,
    Agenda,
)
from planner_reactor.planner.goals import chosen_goal, root_schema
from planner_reactor.planner.issuing import Draft, Issuer, UnderWay
from planner_reactor.planner.memory import Memory
from planner_reactor.planner.model import Model, Segment
from planner_reactor.planner.refinement import refine
from planner_reactor.planner.relaxing import Assuming
from planner_reactor.planner.sensing import observer_of
from planner_reactor.planner.situations import Context, Refinement, Situation
from planner_reactor.planner.steps import Cause, Relax, Relaxation, Step, StepKind
from planner_reactor.planner.structure import first_action
from planner_reactor.planner.theory import Theory

__all__ = ["Planner", "Relaxation", "Step"]

MOST_REFUSALS = 5
"""So often in a row the reactor may refuse what is planned for a situation."""


class Planner:
    """Plans for one goal of a domain. Give it perceptions, call `step` as often as there is time.

    `relax` says which assumptions may be relaxed without need: all, those named, or none; with none, failed
    ones are not relaxed either. `period_ms` replaces the domain's periods of monitors. With `fold` constant
    arguments become part of a situation's name, else a situation has parameters and several instances at
    once.
    """

    def __init__(
        self,
        domain: Domain,
        *,
        goal: str | None = None,
        relax: Relax = "all",
        period_ms: int | None = None,
        stub_ms: int = 2000,
        mode: Mode = "drain",
        fold: bool = True,
        epoch: int = 0,
        patience: int | None = None,
    ) -> None:
        self.domain = domain
        self.goal = chosen_goal(domain, goal)
        self.fold = fold
        self.patience = patience
        self._theory = Theory(domain)
        self._root = root_schema(self._theory, self.goal)
        root = Situation(self.goal)
        self.model = Model(root)
        self._root_context = Context((True,) * len(self._root.executability), frozenset(), frozenset({self.goal}))
        self._issuer = Issuer(self.model, fold, stub_ms, period_ms, mode, epoch)
        self._assuming = Assuming(domain, relax)
        self._failures: Counter[str] = Counter()
        self._agenda = Agenda(self.model)
        self._draft: Draft | None = None
        self._memory = Memory(self._theory)
        self._counts: Counter[str] = Counter()
        self._start = self.model.new(root, self._root_context)

    # ------------------------------------------------------------------------------------- what it tells

    @property
    def assumptions_in_use(self) -> tuple[str, ...]:
        """Those that some issued segment rests on or brings in, the least likely first."""
        return tuple(sorted(self.model.used(), key=self._assuming.unlikelihood))

    @property
    def relaxed(self) -> Mapping[str, Cause]:
        """Assumptions given up, and whether by choice or because they failed."""
        return self._assuming.causes

    @property
    def relaxations(self) -> tuple[Relaxation, ...]:
        """Every assumption given up or taken back so far, in order, with the adaptations issued for it."""
        return tuple(self._assuming.records)

    @property
    def expectation(self) -> tuple[str, ...]:
        """The situations that are not yet as the ω-ideal reactor has them (E_t)."""
        if self.model.root not in self.model.segments:
            return (self.goal,) if not self._start.impossible else ()
        return tuple(segment.name for segment in self.model if segment.is_open)

    @property
    def _nothing_open(self) -> bool:
        if self.model.root not in self.model.segments:
            return bool(self._start.impossible)
        return self._agenda.is_empty()

    @property
    def ideal(self) -> bool:
        """Has everything been issued that the ω-ideal reactor needs?"""
        return not self.expectation and not self.impossible

    @property
    def impossible(self) -> Mapping[str, str]:
        """Situations for which there is no plan, and why."""
        segments = [self._start, *self.model]
        return {segment.name: segment.impossible for segment in segments if segment.impossible}

    @property
    def pending(self) -> tuple[int, ...]:
        """The adaptations that the reactor has not answered yet."""
        return tuple(self._issuer.under_way)

    @property
    def warnings(self) -> tuple[str, ...]:
        """What looks wrong about the segments as they are planned."""
        found = (w for segment in self.model if segment.refinement for w in segment.refinement.warnings)
        return tuple(dict.fromkeys(found))

    def statistics(self) -> Mapping[str, int]:
        """Counts: refinements, adaptations by outcome, relaxations by cause, perceptions by kind."""
        return {**self._counts, "refinements": self._memory.worked_out}

    # ------------------------------------------------------------------------------------------- one step

    def step(self) -> Step | None:
        """Do one short piece of work: refine a situation, issue an adaptation, or decide what to relax.

        None if there is nothing to do until something is perceived.
        """
        if self._draft is None:
            self._draft = self._next_draft()
        if self._draft is not None:
            return self._work_on(self._draft)
        return self._watch() or self._reinstate() or self._relax_next()

    def _next_draft(self) -> Draft | None:
        """The most urgent situation that is not held back by an adaptation under way."""
        if self.model.root not in self.model.segments:
            return None if self._start.impossible else Draft(self._start, f"goal {self.goal}")
        best = self._agenda.next()
        return None if best is None else Draft(best, *self._purpose(best))

    def _purpose(self, segment: Segment) -> tuple[str, str]:
        if segment.is_stub:
            return f"refine {segment.name}", ""
        about = self._assuming.current
        if about is not None:
            verb = {"normal": "relax", "forced": "give up", "reinstated": "reinstate"}[about.cause]
            return f"{verb} {about.assumption}: {segment.name}", about.assumption
        return f"adapt {segment.name}", ""

    def _work_on(self, draft: Draft) -> Step:
        """Refine the next situation of a draft; if it is the last, issue the adaptation."""
        situation = draft.waiting.pop(0) if draft.waiting else draft.segment.situation
        if situation in draft.refinements:
            return self._finish(draft)
        refinement = self._refine(situation, self._context(situation, draft))
        if refinement.tree is None and situation == draft.segment.situation:
            return self._give_up(draft, refinement)
        if refinement.tree is not None:
            draft.drafted.add(refinement)
            draft.waiting = [*self._to_refine(draft, refinement), *draft.waiting]
        if not draft.waiting:
            return self._finish(draft)
        return self._step("refine", draft)

    def _to_refine(self, draft: Draft, refinement: Refinement) -> list[Situation]:
        """Which new sub-situations must be concrete at once: what comes first; all, if there is a
        reaction now.
        """
        assert refinement.tree is not None
        new = [c.situation for c in refinement.children if c.situation not in self.model.segments]
        if draft.segment.is_stub:
            first = first_action(refinement.tree)
            first_child = next((c for c in refinement.children if first and c.situation.schema == first.name), None)
            new = [s for s in new if first_child and first and first.abstract and s == first_child.situation]
        done = {*draft.refinements, *draft.waiting}
        return [s for s in dict.fromkeys(new) if s not in done]

    def _finish(self, draft: Draft) -> Step:
        """Issue the adaptation that a draft amounts to, unless something that it touches is held."""
        segment = draft.segment
        holder = self._issuer.holder(self._issuer.touched_by(draft))
        if holder is not None:
            self._draft = None
            self._agenda.set_aside(segment, holder)
            return self._step("refine", draft)
        below = [c.situation for c in segment.children]
        adaptation = self._issuer.issue(draft, self._assuming.beliefs, self._assuming.watched)
        segment.stale, segment.urgency = False, QUIESCENT
        for stub in self._issuer.introduced:
            self._agenda.push(stub)
        below += [c.situation for c in segment.children]
        forced = self.relaxed.get(draft.assumption) == "forced"
        self._mark(self.model.renew_contexts(below), FAILED_ASSUMPTION if forced else QUIESCENT)
        self._draft = None
        self._assuming.note(adaptation.id if adaptation else None, done=self._nothing_open)
        if adaptation is None:
            return self._step("refine", draft)
        self._counts["issued"] += 1
        return self._step("refine", draft, adaptation)

    def _give_up(self, draft: Draft, refinement: Refinement) -> Step:
        """There is no plan for a situation: say so, and leave it as it is."""
        draft.segment.impossible = refinement.why_impossible(draft.segment.name)
        draft.segment.stale = False
        self._draft = None
        self._counts["impossible"] += 1
        self._assuming.note(None, done=self._nothing_open)
        return self._step("refine", draft)

    def _step(self, kind: StepKind, draft: Draft, *adaptations: Adaptation) -> Step:
        about = self._assuming.current or (self._assuming.records[-1] if self._assuming.records else None)
        cause = about.cause if about is not None and draft.assumption else ""
        return Step(kind, draft.segment.name, draft.assumption, cause, adaptations, draft.purpose)

    # ----------------------------------------------------------------------------------------- refinement

    def _context(self, situation: Situation, draft: Draft) -> Context:
        if situation == self.model.root:
            return self._root_context
        if situation == draft.segment.situation:
            return draft.segment.context
        return self.model.context(situation, draft.drafted)

    def _refine(self, situation: Situation, context: Context) -> Refinement:
        theory, beliefs, fold = self._theory, self._assuming.beliefs, self.fold
        schema = self._schema(situation)
        return self._memory.recall(
            situation, context, beliefs, lambda: refine(theory, beliefs, schema, situation, context, fold=fold)
        )

    def _schema(self, situation: Situation) -> ActionSchema:
        return self._root if situation == self.model.root else self.domain.schemas[situation.schema]

    # --------------------------------------------------------------------------------------- the outer loop

    def _watch(self) -> Step | None:
        """Monitors and perception requests that belong to no situation."""
        asked = {}
        for segment in [self._start, *self.model]:
            for atom in segment.refinement.asked if segment.refinement else ():
                action = observer_of(self.domain, atom)
                if action is not None and self._assuming.beliefs.known(atom) is None:
                    asked[atom] = action
        if self.model.root not in self.model.segments and not asked:
            return None
        adaptation = self._issuer.reconcile(self._assuming.beliefs, self._assuming.watched, asked)
        if adaptation is None:
            return None
        self._counts["issued"] += 1
        return Step("watch", adaptations=(adaptation,), purpose=adaptation.purpose)

    def _reinstate(self) -> Step | None:
        """Take back an assumption that holds again, once nothing else is under way."""
        if self._issuer.under_way or not self._nothing_open:
            return None
        name = self._assuming.take_back()
        if name is None:
            return None
        self._counts["reinstated"] += 1
        self._start.impossible = ""
        self._mark([segment for segment in self.model if segment.impossible], QUIESCENT)
        self._mark_outdated(QUIESCENT)
        self._assuming.note(None, done=self._nothing_open)
        return Step("reinstate", assumption=name, cause="reinstated", purpose=f"reinstate {name}")

    def _relax_next(self) -> Step | None:
        """The reactor is ω-ideal: relax the assumption in use that is least likely to hold."""
        if not self._nothing_open or self.model.root not in self.model.segments:
            return None
        name = self._assuming.least_likely(self.model.used())
        if name is None:
            return None
        self._relax(name, "normal", QUIESCENT)
        return Step("relax", assumption=name, cause="normal", purpose=f"relax {name}")

    def _relax(self, name: str, cause: Cause, urgency: int) -> None:
        """Plan without an assumption from now on."""
        self._counts[cause] += 1
        self._assuming.give_up(name, cause)
        self._draft = None
        self._mark_outdated(urgency)
        self._assuming.note(None, done=self._nothing_open)

    def _mark_outdated(self, urgency: int) -> None:
        """Everything has to be planned again that rests on what is relaxed now, or missed what is not."""
        relaxed = self._assuming.beliefs.relaxed
        outdated = [s for s in self.model if s.refinement and not s.refinement.serves(relaxed)]
        self._mark(outdated, urgency)

    def _mark(self, segments: list[Segment], urgency: int) -> None:
        """These have to be planned again."""
        for segment in segments:
            segment.stale = True
            segment.impossible = ""
            segment.urgency = min(segment.urgency, urgency)
            self._agenda.push(segment)

    # ---------------------------------------------------------------------------------------- perceptions

    def perceive(self, perception: Perception) -> None:
        """Take note of one perception; the next steps follow from it."""
        self._counts[perception.kind] += 1
        match perception.kind:
            case "adaptation_applied":
                self._issuer.applied(int(perception.subject))
                self._agenda.release(int(perception.subject))
            case "adaptation_refused":
                self._not_applied(self._issuer.not_applied(int(perception.subject)), why=perception.cause)
            case "adaptation_timed_out":
                self._not_applied(self._issuer.not_applied(int(perception.subject)))
            case "stub_trigger":
                self._raise(perception.subject, ACTIVE_STUB)
            case "situation_failure":
                self._situation_failed(perception.subject)
            case "assumption_failure":
                self._assumption_failed(perception.subject)
            case "assumption_holds":
                self._assuming.holds_again(perception.subject)
            case "information":
                self._told(perception)
            case "guard_kill" | "error":
                pass  # completion is told by adaptation_applied; errors are counted

    def _not_applied(self, flight: UnderWay | None, *, why: str = "") -> None:
        """Plan again what was in an adaptation that was refused (`why`) or that took too long."""
        if flight is None or flight.segment is None:
            return
        self._draft = None
        self._agenda.release(flight.adaptation.id)
        if flight.segment not in self.model.segments:
            fresh = self.model.new(flight.segment, self._root_context)
            self._start = replace(fresh, refusals=self._start.refusals)
        segment = self.model.segments.get(flight.segment, self._start)
        self._mark([segment], QUIESCENT)
        segment.refusals += bool(why)
        if segment.refusals >= MOST_REFUSALS:
            segment.impossible = f"the reactor refused it {segment.refusals} times ({why})"
        restored = [situation for situation, _ in flight.before]
        below = [c.situation for s in self.model for c in s.children if s.situation in restored]
        self._mark(self.model.renew_contexts([*restored, *below]), QUIESCENT)
        self._mark_outdated(QUIESCENT)

    def _raise(self, name: str, urgency: int) -> None:
        segment = self.model.named(name)
        if segment is not None:
            segment.urgency = min(segment.urgency, urgency)
            if segment.is_open:
                self._agenda.push(segment)
            if self._draft is not None and self._draft.segment is not segment and segment.is_open:
                self._draft = None

    def _situation_failed(self, name: str) -> None:
        self._raise(name, FAILED_SITUATION)
        self._failures[name] += 1
        segment = self.model.named(name)
        if self.patience and segment and self._failures[name] >= self.patience:
            self._failures[name] = 0
            doubtful = self._assuming.least_likely(segment.required)
            if doubtful is not None and not segment.stale:
                self._relax(doubtful, "forced", FAILED_ASSUMPTION)

    def _assumption_failed(self, name: str) -> None:
        if self._assuming.fails(name):
            self._relax(name, "forced", FAILED_ASSUMPTION)

    def _told(self, perception: Perception) -> None:
        """An answer to a perception request: plan again what asked for it."""
        *arguments, verdict = perception.values or ("",)
        atom = Atom(perception.subject, tuple(arguments))
        if verdict not in ("holds", "fails"):
            return
        self._assuming.beliefs = self._assuming.beliefs.learning(atom, holds=verdict == "holds")
        self._issuer.requests.pop(atom, None)
        self._draft = None
        self._start.impossible = ""
        asked = [s for s in self.model if s.impossible or (s.refinement and atom in s.refinement.asked)]
        self._mark(asked, QUIESCENT)
