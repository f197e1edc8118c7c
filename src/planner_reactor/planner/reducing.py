"""The inner loop: reducing the expectation, one situation at a time (R §7.1, §7.2, §7.5).

A `Reducer` takes the most urgent open situation, refines it, and with it what must be concrete at once: of
a situation that was a stub the first step, of one that has a reaction all that is new, so that a reaction
is never replaced by less. Then the difference is issued. Where a sub-situation turns out to be impossible,
another way is sought that does without it; if there is none, the stub stays and the reason is reported.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable

from planner_reactor.link.messages import Adaptation
from planner_reactor.logic.domain import ActionSchema
from planner_reactor.logic.formulas import Atom
from planner_reactor.planner.agenda import FAILED_ASSUMPTION, QUIESCENT, Agenda
from planner_reactor.planner.because import Because, Trigger
from planner_reactor.planner.convergence import Convergence
from planner_reactor.planner.drafts import Draft
from planner_reactor.planner.explaining import Record, Subject
from planner_reactor.planner.goals import guarded, root_schema
from planner_reactor.planner.issuing import MOST_REFUSALS, Issuer, UnderWay
from planner_reactor.planner.memory import Memory, Thought
from planner_reactor.planner.model import Model, Segment
from planner_reactor.planner.purposes import purpose, step_of
from planner_reactor.planner.refinement import refining
from planner_reactor.planner.relaxing import Assuming
from planner_reactor.planner.situations import Context, Refinement, Situation
from planner_reactor.planner.sizing import Sizing, at_once
from planner_reactor.planner.steps import Step
from planner_reactor.planner.theory import Theory
from planner_reactor.planner.thinking import advance

MOST_RECORDS = 10_000
UNITS = 24
"""So much work is done in one step (see `thinking`)."""
PATIENCE = 4 * UNITS
"""After so much work on one refinement others have their turn, if a failure is to be answered."""


class Reducer:
    """Brings the model in line with the goals and the assumptions held. `starts` are goals that are not in the
    model yet, `leaving` those that are to go.
    """

    def __init__(
        self,
        theory: Theory,
        model: Model,
        issuer: Issuer,
        assuming: Assuming,
        counts: Counter[str],
        convergence: Convergence | None = None,
    ) -> None:
        self.theory, self.model, self.issuer = theory, model, issuer
        self.assuming, self.counts = assuming, counts
        self.convergence, self.sizing = convergence or Convergence(), Sizing()
        self.records: dict[int, Record] = {}  # of the last adaptations, to be explained
        self.memory = Memory(theory)
        self.starts: dict[Situation, Segment] = {}
        self.leaving: dict[Situation, Because] = {}
        self._roots: dict[Situation, ActionSchema] = {}
        self._refused: dict[Situation, int] = {}  # how often a goal was, before it was issued
        self._agenda = Agenda(model)
        self._draft: Draft | None = None

    @property
    def has_begun(self) -> bool:
        """Has anything been issued that is still there?"""
        return bool(self.model.segments)

    @property
    def is_done(self) -> bool:
        """Is there nothing left to reduce, held back or not?"""
        if self.leaving or not all(start.impossible for start in self.starts.values()):
            return False
        return self._agenda.is_empty()

    @property
    def segments(self) -> list[Segment]:
        """All segments, with the goals also before they are issued."""
        return [*self.model, *self.starts.values()]

    def pursue(self, goal: str) -> None:
        """Plan for this goal, too, beside those that are there."""
        root = Situation(goal)
        self.leaving.pop(root, None)
        if root not in self.model.roots:
            self.model.roots[root] = None
            self._roots[root] = root_schema(self.theory, goal)
            self.model.instead[root] = guarded(self.theory.domain, goal)
            self.starts[root] = self._new_start(root)
            self.starts[root].pending = self.issuer.holder(frozenset({root}))  # it may just be going

    def withdraw(self, goal: str, because: Because) -> None:
        """Take the goal away, and all that stands for it alone."""
        root = Situation(goal)
        self.abandon()
        if self.starts.pop(root, None) is not None:
            self.model.roots.pop(root, None)
        elif root in self.model.roots:
            self.leaving[root], self._refused[root] = because, 0

    def _leave(self) -> Step | None:
        """Take one goal away at a time, so that what two have in common is not taken for what the other needs."""
        if any(flight.withdrawn is not None for flight in self.issuer.under_way.values()):
            return None
        for root, because in list(self.leaving.items()):
            shared = {c.situation for s in self.model.left_by(root) for c in s.children}
            adaptation = self.issuer.withdraw(root, self.assuming.beliefs, self.assuming.watched)
            if adaptation is not None:
                del self.leaving[root]
                self.records[adaptation.id] = Record(adaptation.id, adaptation.purpose, (because,), ())
                self.mark(self.model.renew_contexts(shared), QUIESCENT, because)
                self.counts["issued"] += 1
                return Step("refine", root.schema, adaptations=(adaptation,), purpose=adaptation.purpose)
        return None

    def _come_back(self, root: Situation, because: Because) -> None:
        """A goal could not be taken away: it is still to go, unless it is wanted again, or was refused too often."""
        again = self.starts.pop(root, None)
        self._refused[root] = self._refused.get(root, 0) + (because.trigger == "adaptation_refused")
        if again is None and self._refused[root] < MOST_REFUSALS:
            self.leaving[root] = because
        self.abandon()
        self.mark(self.model.renew_contexts(list(self.model.segments)), QUIESCENT, because)
        self.mark_outdated(QUIESCENT, because)

    def adopt(self, theory: Theory, because: Because) -> None:
        """Another text is the domain from now on: plan everything again that it makes different."""
        self.abandon()
        self.theory, self.memory = theory, Memory(theory)
        for root in self._roots:
            self._roots[root] = root_schema(theory, root.schema)
        for root in self.starts:
            self.starts[root] = self._new_start(root)
        self.mark([s for s in self.model if s.refinement], QUIESCENT, because)
        for segment in self.model:
            segment.avoided, segment.settled = frozenset(), False

    def _new_start(self, root: Situation) -> Segment:
        granted = (True,) * len(self._roots[root].executability)
        start = self.model.new(root, Context(granted, frozenset(), frozenset({root.schema})))
        start.because = (Because("goal", root.schema),)
        return start

    # ------------------------------------------------------------------------------------------- one step

    def step(self) -> Step | None:
        """Refine one situation; issue the adaptation when it was the last of a draft. None:
        nothing to do now.
        """
        if self._draft is None:
            left = self._leave() if self.leaving else None
            if left is not None:
                return left
            self._draft = self._next_draft()
        return None if self._draft is None else self._work_on(self._draft)

    def abandon(self) -> None:
        """Something has changed: what was being drafted is drafted anew; what was being worked out is remembered."""
        if self._draft is not None and self._draft.thought is not None:
            self.memory.lay_aside(self._draft.thought)
        self._draft = None

    def _next_draft(self) -> Draft | None:
        for root, start in self.starts.items():
            if start.pending is not None and start.pending not in self.issuer.under_way:
                self.starts[root] = start = self._new_start(root)  # it was held back, and its version may have risen
            if not start.impossible and start.pending is None:
                return Draft(start, f"goal {start.name}")
        segment, beliefs = self._agenda.next(), self.assuming.beliefs
        while segment is not None and not segment.turn and self.memory.laid_aside(segment, beliefs):
            self._agenda.let_others(segment)  # it, or one that is alike, has made others wait already
            segment = self._agenda.next()
        return None if segment is None else Draft(segment, *purpose(segment, self.assuming.current))

    def _work_on(self, draft: Draft) -> Step:
        """Work on a draft until it is issued, nothing more can be done about it, or so much is done as is
        done in one step.
        """
        left = UNITS
        while left > 0:
            situation = draft.waiting[0] if draft.waiting else draft.segment.situation
            if situation in draft.drafted.refinements:
                draft.more = self.sizing.more(draft, self.model, self.theory.domain)
                if draft.more is not None:
                    draft.waiting = [draft.more]
                    continue
                if left < UNITS and draft.size > UNITS:
                    break  # so much is issued that it is a step of its own
                self._count(UNITS - left)
                return self._finish(draft)
            before = left
            refinement, left = self._refine(situation, draft, left)
            draft.spent += before - left
            if refinement is not None and not self._take(draft, refinement):
                break
        self._count(UNITS - left)
        self._let_others(draft)
        return step_of(draft, self.assuming)

    def _let_others(self, draft: Draft) -> None:
        """An assumption has failed, and nothing is issued yet: a long thought waits for what is as urgent and short."""
        thought, begun, about = draft.thought, draft.segment.situation in self.model.segments, self.assuming.current
        unanswered = about is not None and about.cause == "forced" and not about.adaptations
        if thought is not None and thought.units >= PATIENCE and unanswered and begun and draft.more is None:
            thought.units = 0
            if self._agenda.let_others(draft.segment):
                self.abandon()

    def _count(self, units: int) -> None:
        self.counts["units"] += units
        self.counts["longest_step"] = max(self.counts["longest_step"], units)

    def _take(self, draft: Draft, refinement: Refinement) -> bool:
        """Put a refinement into the draft; False if that was the end of the draft."""
        situation = refinement.situation
        if situation == draft.more:
            draft.add_more(refinement)
        elif refinement.composition is not None:
            draft.drafted.add(refinement)
            draft.waiting = [*at_once(draft, refinement, self.model), *draft.waiting[1:]]
        elif not draft.fail(situation):
            self._give_up(draft.segment, refinement)
            return False
        return True

    def _finish(self, draft: Draft) -> Step:
        """Issue the adaptation that a draft amounts to, unless something that it touches is held."""
        self._draft = None
        segment = draft.segment
        difference = self.issuer.difference(draft)
        touched = difference.touched
        holder = self.issuer.holder(touched)
        if holder is not None:
            self._agenda.set_aside(segment, holder)
            if segment.situation in self.starts:
                segment.pending = holder
            return step_of(draft, self.assuming)
        refinements = draft.refinements
        below = [child.situation for child in segment.children]
        below += [c.situation for r in refinements.values() for c in r.children if c.situation not in touched]
        adaptation = self.issuer.issue(draft, difference, self.assuming.beliefs, self.assuming.watched)
        self.starts.pop(segment.situation, None)
        segment.stale, segment.urgency, segment.turn, segment.asked = False, QUIESCENT, 0, ()
        for situation in refinements:
            issued = self.model.segments[situation]
            issued.avoided, issued.settled = draft.to_avoid(situation), situation in draft.settled
        for stub in self.issuer.introduced:
            self._agenda.push(stub)
        forced = self.assuming.causes.get(draft.assumption) == "forced"
        changed = self.model.renew_contexts(below)
        self.mark(changed, FAILED_ASSUMPTION if forced else QUIESCENT, Because("context", segment.name))
        self.convergence.reduced(segment, (*self.issuer.introduced, *changed))
        self.assuming.note(adaptation.id if adaptation else None, done=self.is_done)
        because, segment.because = segment.because, ()
        if adaptation is None:
            return step_of(draft, self.assuming)
        self._record(adaptation, draft, because)
        self.counts["issued"] += 1
        return step_of(draft, self.assuming, adaptation)

    def _record(self, adaptation: Adaptation, draft: Draft, because: tuple[Because, ...]) -> None:
        """Keep what is needed to explain it."""
        names = self.model.names
        subjects = tuple([Subject(names[s], s, self._schema(s), *draft.contexts[s]) for s in draft.refinements])
        self.records[adaptation.id] = Record(adaptation.id, adaptation.purpose, because, subjects)
        if len(self.records) > MOST_RECORDS:
            del self.records[next(iter(self.records))]

    def _give_up(self, segment: Segment, refinement: Refinement) -> None:
        """There is no plan for a situation: say so, leave it as it is, and let its callers try without it."""
        self._draft = None
        segment.impossible = refinement.why_impossible(segment.name)
        segment.asked = refinement.asked
        segment.stale = False
        self.counts["impossible"] += 1
        for situation in self.model.callers(segment.situation):
            caller = self.model.segments[situation]
            if not caller.settled:
                caller.avoided |= {segment.situation.schema}
                self.mark([caller], QUIESCENT, Because("impossible", segment.name))
        self.assuming.note(None, done=self.is_done)

    # ----------------------------------------------------------------------------------------- refinement

    def _refine(self, situation: Situation, draft: Draft, units: int) -> tuple[Refinement | None, int]:
        """The refinement, from memory or worked out now, and how many of the units are left; None if
        they were not enough.
        """
        if draft.thought is None:
            context, beliefs = draft.context(situation, self.model), self.assuming.beliefs
            draft.contexts[situation] = context, beliefs
            key = self.memory.key(situation, context, beliefs)
            known = self.memory.recall(key, situation, beliefs)
            if known is not None:
                return known, units - 1
            draft.thought = self.memory.take_up(key, beliefs)
        if draft.thought is None:
            schema = self._schema(situation)
            work = refining(self.theory, beliefs, schema, situation, context, fold=self.issuer.fold)
            draft.thought = Thought(key, beliefs, work)
        thought = draft.thought
        found, left = advance(thought.work, units)
        thought.units += units - left
        if found is not None:
            draft.thought = None
            self.memory.keep(thought.key, found)
            if found.situation != situation:  # it was begun for another that is alike
                found = self.memory.recall(thought.key, situation, thought.beliefs)
        return found, left

    def _schema(self, situation: Situation) -> ActionSchema:
        root = self._roots.get(situation)
        return root if root is not None else self.theory.domain.schemas[situation.schema]

    # ------------------------------------------------------------------------------------ what is to be done

    def mark(self, segments: Iterable[Segment], urgency: int, because: Because) -> None:
        """These have to be planned again."""
        for segment in segments:
            if because not in segment.because:
                segment.because = (*segment.because, because)
            segment.stale = True
            segment.impossible = ""
            segment.urgency = min(segment.urgency, urgency)
            self._agenda.push(segment)

    def mark_outdated(self, urgency: int, because: Because, *, given_up: bool = True) -> None:
        """Plan again what rests on what is relaxed now, or missed what is not; also what was `given_up`."""
        relaxed = self.assuming.beliefs.relaxed
        outdated = [s for s in self.model.begin_anew() if s.refinement and not s.refinement.serves(relaxed)]
        self.mark([s for s in outdated if given_up or s.refusals < MOST_REFUSALS], urgency, because)

    def raise_urgency(self, name: str, urgency: int, because: Because) -> Segment | None:
        """The reactor has to do with this situation now."""
        segment = self.model.named(name)
        if segment is not None:
            segment.urgency = min(segment.urgency, urgency)
            if segment.is_open:
                if because not in segment.because:
                    segment.because = (*segment.because, because)
                self._agenda.push(segment)
                if self._draft is not None and self._draft.segment is not segment:
                    self.abandon()
        return segment

    def reconsider(self, because: Because, about: Atom | None = None) -> None:
        """More holds, or is known, than before: what seemed impossible, or was avoided, may be possible now."""
        self.abandon()
        again = []
        for segment in self.segments:
            asked = segment.refinement.asked if segment.refinement else ()
            if segment.impossible or segment.avoided or segment.settled or about in asked:
                segment.avoided, segment.settled = frozenset(), False
                again.append(segment)
        self.mark(again, QUIESCENT, because)  # the root, too, if it has not begun

    # ------------------------------------------------------------------------------- answers of the reactor

    def applied(self, adaptation: int) -> None:
        """The reactor has applied it; what it held back may go on."""
        self.issuer.applied(adaptation)
        self._agenda.release(adaptation)

    def not_applied(self, adaptation: int, *, why: str = "") -> None:
        """Plan again what was in an adaptation that was refused (`why`) or that took too long."""
        flight = self.issuer.not_applied(adaptation)
        self._agenda.release(adaptation)
        trigger: Trigger = "adaptation_refused" if why else "adaptation_timed_out"
        because = Because(trigger, str(adaptation))
        if flight is not None and flight.withdrawn is not None:
            self._come_back(flight.withdrawn[0], because)
        if flight is not None and flight.segment is not None:
            self.abandon()
            self._plan_again(flight, flight.segment, why, because)

    def _plan_again(self, flight: UnderWay, situation: Situation, why: str, because: Because) -> None:
        if situation in self.model.roots and situation not in self.model.segments:
            if self.leaving.pop(situation, None) is not None:
                del self.model.roots[situation]
                return
            self.model.roots[situation] = None
            self.starts[situation] = self._new_start(situation)
            self.starts[situation].refusals = self._refused.get(situation, 0)
        segment = self.model.segments.get(situation) or self.starts[situation]
        self.mark([segment], QUIESCENT, because)
        segment.refusals += bool(why)
        if situation in self.starts:
            self._refused[situation] = segment.refusals
        if segment.refusals >= MOST_REFUSALS:
            segment.impossible = f"it was refused {segment.refusals} times ({why})"
        restored = [s for s, _ in flight.before]
        below = [c.situation for s in self.model for c in s.children if s.situation in restored]
        renewed = self.model.renew_contexts([*restored, *below])
        self.mark([s for s in renewed if s.refusals < MOST_REFUSALS], QUIESCENT, because)
        self.mark_outdated(QUIESCENT, because, given_up=False)
