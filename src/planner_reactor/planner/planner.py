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

from planner_reactor.analysis.permission import Environment
from planner_reactor.errors import InputError, nearest
from planner_reactor.link.messages import Mode, Perception, Standing
from planner_reactor.logic.diagnosis import Diagnosis
from planner_reactor.logic.domain import Domain
from planner_reactor.planner.agenda import ACTIVE_STUB, FAILED_ASSUMPTION, FAILED_SITUATION, QUIESCENT
from planner_reactor.planner.because import Because
from planner_reactor.planner.convergence import lacking, unlikelihood
from planner_reactor.planner.diagnosing import Diagnosing, suspects
from planner_reactor.planner.explaining import Explanation, explain, unrecorded
from planner_reactor.planner.forecast import Forecast
from planner_reactor.planner.foresight import Foresight
from planner_reactor.planner.goals import chosen_goal, must_follow, pursued, with_fact
from planner_reactor.planner.issuing import Issuer
from planner_reactor.planner.model import Model
from planner_reactor.planner.reducing import Reducer
from planner_reactor.planner.relaxing import Assuming
from planner_reactor.planner.sensing import answer, to_ask
from planner_reactor.planner.sizing import Sizing
from planner_reactor.planner.standings import ANSWERS, Standings
from planner_reactor.planner.steps import Cause, Relax, Relaxation, Step
from planner_reactor.planner.theory import Theory
from planner_reactor.planner.verifying import Gate, Verdicts, without_unsound

__all__ = ["Planner", "Relaxation", "Step"]


class Planner:
    """Plans for one goal of a domain. Give it perceptions, call `step` as often as there is time.

    `relax` says which assumptions may be relaxed without need: all, those named, or none; with none, failed
    ones are not relaxed either. `period_ms` replaces the domain's periods of monitors. With `fold` constant
    arguments become part of a situation's name, else a situation has parameters and several instances at
    once. With `foresight` it thinks ahead when there is nothing else to do, so that a failure finds it prepared.
    With `verify` no adaptation is issued before it is verified (`verifying`). `response_ms` is the time that may go
    into one adaptation: the longer, the fewer and larger they are (`sizing`).
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
        foresight: bool = False,
        verify: bool = True,
        response_ms: float | None = None,
    ) -> None:
        self.domain = domain
        self.goal = chosen_goal(domain, goal)
        self.model = Model()
        self.patience = patience
        self._counts: Counter[str] = Counter()
        self._diagnosing = Diagnosing()
        self._assuming = Assuming(domain, relax)
        self._issuer = Issuer(self.model, fold, stub_ms, period_ms, mode, epoch)
        self._gate = Gate(mode=mode) if verify else None
        self._withheld: dict[int, str] = {}
        self._reducer = Reducer(Theory(domain), self.model, self._issuer, self._assuming, self._counts)
        self._reducer.sizing = Sizing.within(response_ms)
        for name in pursued(domain, self.goal):
            self._reducer.pursue(name)
        self._foresight = Foresight(self._reducer) if foresight else None
        self._standing = Standings()

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
        return tuple(segment.name for segment in self._reducer.segments if segment.is_open)

    @property
    def ideal(self) -> bool:
        """Has everything been issued that the ω-ideal reactor needs?"""
        return not self.expectation and not self.impossible

    @property
    def lacking(self) -> tuple[int, ...]:
        """What the expectation amounts to (e of (11)): open situations by how much may stand below them."""
        return lacking(self.domain, self._reducer.segments)

    @property
    def unlikelihood(self) -> float:
        """l(ω) of the assumptions held (9)."""
        return unlikelihood(self.domain, self.relaxed)

    @property
    def breaches(self) -> tuple[str, ...]:
        """Where the planner did not get nearer to its end, against (9) or (11): nowhere, if it is right."""
        return tuple(self._reducer.convergence.breaches)

    @property
    def impossible(self) -> Mapping[str, str]:
        """Situations for which there is no plan, and why."""
        return {segment.name: segment.impossible for segment in self._reducer.segments if segment.impossible}

    @property
    def diagnoses(self) -> tuple[Diagnosis, ...]:
        """Which assumptions the failed situations speak against, with which confidence, the most probable first."""
        return self._diagnosing.diagnoses(self.model, self._assuming.beliefs)

    @property
    def pending(self) -> tuple[int, ...]:
        """The adaptations that the reactor has not answered yet."""
        return tuple(self._issuer.under_way)

    @property
    def warnings(self) -> tuple[str, ...]:
        """What looks wrong about the segments as they are planned."""
        return tuple(dict.fromkeys(self.forecast.warnings()))

    @property
    def forecast(self) -> Forecast:
        """How long situations will last, and where resources may be short, as the reactor is planned now."""
        return Forecast(self.domain, self.model, self._issuer.fold)

    @property
    def withheld(self) -> Mapping[int, str]:
        """The adaptations that were not issued because they do not hold: by id, the situations and why."""
        return self._withheld

    def explain(self, adaptation: int) -> Explanation:
        """Why an adaptation was issued, and why its reactions are what they are; of the last 10,000."""
        record = self._reducer.records.get(adaptation)
        if record is None:
            return unrecorded(adaptation, self._issuer.next_id - 1)
        return explain(record, self._reducer.theory, fold=self._issuer.fold)

    # ----------------------------------------------------------------------------------- goals at run time

    @property
    def goals(self) -> tuple[str, ...]:
        """The goals that are pursued, in the order in which they were given."""
        return tuple(root.schema for root in self.model.roots if root not in self._reducer.leaving)

    def pursue(self, goal: str) -> None:
        """Pursue this goal of the domain, too, from now on; what the others need goes on meanwhile."""
        self._reducer.pursue(chosen_goal(self.domain, goal))

    def withdraw(self, goal: str) -> None:
        """Pursue this goal no more: what stands for it alone is taken away, once it is at rest."""
        if goal not in self.goals:
            raise InputError(f"{goal} is not pursued, {nearest(goal, self.goals) or f'but {self.goals}'}")
        self._reducer.withdraw(goal, Because("withdrawn", goal))

    def adopt(self, domain: Domain) -> None:
        """Plan with another text from now on: other rules, facts, goals, likelihoods, further actions and assumptions.

        What it makes different is adapted, piece by piece; all else goes on. The actions that there are must need
        what they needed before (InputError): reactions in place rest on that.
        """
        must_follow(domain, self.domain, self.goals)
        self.domain = domain
        self._assuming.adopt(domain)
        if self._foresight is not None:
            self._foresight = Foresight(self._reducer)
        self._reducer.adopt(Theory(domain), Because("domain", domain.file))

    def tell(self, fact: str, *, holds: bool) -> None:
        """A fact such as `Machine(mill)` holds from now on, or no more: a resource is down."""
        self.adopt(with_fact(self.domain, fact, holds=holds))

    def doubt(self, assumption: str) -> None:
        """Do without this assumption from now on, though nothing speaks against it yet; until it is trusted again."""
        if self._assuming.may_doubt(assumption):
            self._relax(assumption, "normal", FAILED_ASSUMPTION)

    def trust(self, assumption: str) -> None:
        """Hold this assumption again, as soon as nothing else is under way."""
        self._assuming.trust(assumption)

    def meet(self, environment: Environment) -> None:
        """What is known of the basic processes from now on: bounds of adaptations are numbers."""
        if self._gate is not None:
            self._gate.meet(environment)

    def statistics(self) -> Mapping[str, int]:
        """Counts: refinements, situations taken over, adaptations, relaxations by cause, perceptions by kind."""
        return {**self._counts, "refinements": self._reducer.memory.worked_out}

    # ------------------------------------------------------------------------------------------- one step

    def step(self) -> Step | None:
        """Do one short piece of work: refine a situation, issue an adaptation, or decide what to relax.

        None if there is nothing to do until something is perceived.
        """
        held = self._gate.held if self._gate is not None else None
        if self._standing.busy:
            return self._standing.step({adaptation.id for adaptation in held.adaptations} if held else ())
        if self._gate is not None and held is not None:
            return self._verified(self._gate.look_on(), self._gate)
        step = self._reducer.step() or self._watch() or self._reinstate() or self._relax_next() or self._think_ahead()
        if step is None or self._gate is None or not step.adaptations:
            return step
        return self._verified(self._gate.look(step), self._gate)

    def _verified(self, looked: tuple[Step, Verdicts] | None, gate: Gate) -> Step:
        """The step that was looked at without what does not hold, which counts as refused; if it is decided."""
        if looked is None:
            return gate.waiting()
        step, withheld = without_unsound(*looked)
        for number, why in withheld.items():
            self._withheld[number] = why
            self._counts["withheld"] += 1
            self._counts["issued"] -= 1
            self._reducer.not_applied(number, why=f"withheld, {why}")
        return step

    @property
    def fenced(self) -> bool:
        """Has a later planner taken over? Then this one does nothing any more."""
        return self._standing.fenced

    @property
    def waits(self) -> bool:
        """Has it asked how the reactor stands, and was not told?"""
        return self._standing.waits

    def enquire(self, enquirer: int) -> None:
        """Ask the reactor how it stands, and plan nothing before it answers; `enquirer` tells planners apart."""
        self._standing.enquire(enquirer)

    def resume(self, standing: Standing) -> None:
        """Go on with a reactor that stands: take over what is as it should be, adapt the rest (`resuming`)."""
        if not self._standing.answers(standing, self._issuer.epoch):
            return
        from planner_reactor.planner.resuming import Resumption, begun_anew  # reads RS, as no beginning does

        self._reducer = begun_anew(self._reducer)
        self._issuer, self.model = self._reducer.issuer, self._reducer.model
        self._withheld.clear()
        if self._foresight is not None:
            self._foresight = Foresight(self._reducer)
        if self._gate is not None:
            self._gate.stand(standing.clauses.values())
        self._standing.resume(Resumption(self._reducer, standing))
        for name in standing.failed:
            self._assumption_failed(name, 0)

    def _think_ahead(self) -> Step | None:
        """Nothing is to be done: work out what would be, were the next assumption to fail."""
        if self._foresight is None or not self._reducer.is_done:
            return None
        name = self._foresight.step(self.assumptions_in_use)
        return None if name is None else Step("foresee", assumption=name, purpose=f"foresee being without {name}")

    def _watch(self) -> Step | None:
        """Monitors and perception requests that belong to no situation."""
        beliefs, watched = self._assuming.beliefs, self._assuming.watched
        asked = to_ask(self.domain, self._reducer.segments, beliefs)
        done = self._reducer.is_done and not self.impossible  # then nothing asserts what nobody planned
        adaptation = self._issuer.remove_strangers(beliefs, watched) if done else None
        adaptation = adaptation or self._issuer.reconcile(beliefs, watched, asked)
        if adaptation is None:
            return None
        self._counts["issued"] += 1
        return Step("watch", adaptations=(adaptation,), purpose=adaptation.purpose)

    def _reinstate(self) -> Step | None:
        """Take back an assumption that holds again, once nothing else is under way."""
        busy = self._issuer.under_way or not self._reducer.is_done
        name = None if busy else self._assuming.take_back()
        if name is None:
            return None
        self._counts["reinstated"] += 1
        because = Because("reinstated", name)
        self._reducer.reconsider(because)
        self._reducer.mark_outdated(QUIESCENT, because)
        self._assuming.note(None, done=self._reducer.is_done)
        return Step("reinstate", assumption=name, cause="reinstated", purpose=f"reinstate {name}")

    def _relax_next(self) -> Step | None:
        """The reactor is ω-ideal: relax the assumption in use that is least likely to hold."""
        done = self._reducer.is_done and self._reducer.has_begun
        name = self._assuming.least_likely(self.model.used()) if done else None
        if name is None:
            return None
        self._relax(name, "normal", QUIESCENT)
        return Step("relax", assumption=name, cause="normal", purpose=f"relax {name}")

    def _relax(self, name: str, cause: Cause, urgency: int, told: int | None = None) -> None:
        """Plan without an assumption from now on."""
        self._counts[cause] += 1
        before = self.unlikelihood
        self._diagnosing.begin_anew()
        self._assuming.give_up(name, cause)
        self._reducer.convergence.relaxed(name, before, self.unlikelihood)
        self._reducer.abandon()
        self._reducer.mark_outdated(urgency, Because(cause, name, told))
        self._assuming.note(None, done=self._reducer.is_done)

    # ---------------------------------------------------------------------------------------- perceptions

    def perceive(self, perception: Perception) -> None:
        """Take note of one perception; the next steps follow from it."""
        self._counts[perception.kind] += 1
        if perception.kind in ANSWERS and perception.epoch != self._issuer.epoch:
            return  # it was another planner's
        self._standing.perceive(perception, self._issuer)
        if self._gate is not None:
            self._gate.perceive(perception)
        if perception.kind.startswith("assumption_"):
            self._diagnosing.sensed(perception.subject, unknown=perception.kind == "assumption_unknown")
        match perception.kind:
            case "adaptation_applied":
                self._reducer.applied(int(perception.subject))
            case "adaptation_refused":
                self._reducer.not_applied(int(perception.subject), why=perception.cause or "no reason given")
            case "adaptation_timed_out":
                self._reducer.not_applied(int(perception.subject))
            case "stub_trigger":
                because = Because("stub_trigger", perception.subject, perception.number)
                self._reducer.raise_urgency(perception.subject, ACTIVE_STUB, because)
            case "situation_failure":
                if perception.cause != "assumption":
                    self._diagnosing.failed(perception.subject, perception.count)
                self._situation_failed(perception.subject, perception.number)
            case "storm":
                self._doubt(perception.subject, perception.number)
            case "assumption_failure":
                self._assumption_failed(perception.subject, perception.number)
            case "assumption_holds":
                self._assuming.holds_again(perception.subject)
            case "information":
                self._told(perception)
            case "assumption_unknown" | "guard_kill" | "error" | "restarted" | "halted":
                pass  # completion is told by adaptation_applied; errors are counted

    def _situation_failed(self, name: str, number: int) -> None:
        """Its turn comes first; failures that nothing explains count as evidence, if there is no
        more patience.
        """
        segment = self._reducer.raise_urgency(name, FAILED_SITUATION, Because("situation_failure", name, number))
        if segment and self._diagnosing.runs_out(name, self.patience):
            self._doubt(name, number)

    def _doubt(self, name: str, number: int) -> None:
        """Give up what the failures of this situation speak against most, or else what is least likely."""
        segment = self.model.named(name)
        if segment is None or segment.stale:
            return
        suspected = (a for a in suspects(self.diagnoses) if a in segment.required and self._assuming.fails(a))
        diagnosed = next(suspected, None)
        doubtful = diagnosed or self._assuming.least_likely(segment.required)
        if doubtful is not None:
            self._relax(doubtful, "forced", FAILED_ASSUMPTION, number)

    def _assumption_failed(self, name: str, number: int) -> None:
        if self._assuming.fails(name):
            self._relax(name, "forced", FAILED_ASSUMPTION, number)

    def _told(self, perception: Perception) -> None:
        """An answer to a perception request: plan again what asked for it."""
        told = answer(perception)
        if told is not None:
            atom, holds = told
            self._assuming.beliefs = self._assuming.beliefs.learning(atom, holds=holds)
            self._issuer.requests.pop(atom, None)
            self._reducer.reconsider(Because("information", str(atom), perception.number), atom)
