"""One run: a planner and a reactor, side by side, on one scheduler, in a host's world (R Fig. 1).

The planner thinks in short steps; what a step costs is charged to the run's clock (`timing`), and its adaptations leave
it only then. Messages take `LATENCY` either way. Faults strike the world, never the programs. The run ends when the
world is finished, or at `until`.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

from planner_reactor.analysis.permission import Environment
from planner_reactor.errors import RefusedError
from planner_reactor.experiments.timing import Fixed, PlannerTime
from planner_reactor.link.channels import AdaptationChannel, PerceptionChannel
from planner_reactor.link.messages import Adaptation, Enquiry, Perception, Standing
from planner_reactor.planner.planner import Planner, Step
from planner_reactor.reactor.laws import CHECKED as LAWS_CHECKED
from planner_reactor.reactor.reactor import Reactor
from planner_reactor.runtime import Budgets, Clock, Host, Scheduler, VirtualClock, World
from planner_reactor.trace import Trace

LATENCY = 0.001
"""Seconds that a message takes from one side to the other."""

ASK_AGAIN = 1.0
"""Seconds after which a planner asks how the reactor stands once more, if it was not told."""

LOOK_AGAIN = 1.0
"""Seconds after which a world is asked again whether it is finished, if nothing is traced meanwhile."""

HostMaker = Callable[[Scheduler, Trace], Host]


@dataclass(slots=True)
class Relaxation:
    """One assumption given up, or taken up again: times in seconds, None if it has not come to that."""

    assumption: str
    cause: str  # normal | forced | reinstated
    decided_s: float
    issued_s: float | None = None
    applied_s: float | None = None
    last: int = 0  # id of the last adaptation issued for it


@dataclass(slots=True)
class Milestones:
    """When what was reached first: seconds, None if it was not."""

    first_adaptation_issued_s: float | None = None
    first_reactor_s: float | None = None
    first_ideal_s: float | None = None


@dataclass(slots=True)
class Costs:
    """What the run itself took, in seconds."""

    simulated: float = 0.0
    wall: float = 0.0
    cpu: float = 0.0
    planner_cpu: list[float] = field(default_factory=list)


class Loop:
    """Planner, reactor, link and world of one run."""

    def __init__(
        self,
        planner: Planner,
        make_host: HostMaker,
        *,
        seed: int = 0,
        clock: Clock | None = None,
        planner_time: PlannerTime | None = None,
        budgets: Budgets | None = None,
        keep_trace: bool = True,
    ) -> None:
        self.scheduler = Scheduler(clock or VirtualClock(), seed=seed)
        self.trace = Trace(lambda: self.scheduler.now, keep=keep_trace)
        self.host = make_host(self.scheduler, self.trace)
        self.planner = planner
        self.planners = 1
        self._meet(planner)
        self.planner_time = planner_time or Fixed()
        self.perceptions = PerceptionChannel(self._perceived)
        self.adaptations = AdaptationChannel(self._issued)
        self.reactor = Reactor(
            self.scheduler, host=self.host, perceptions=self.perceptions, trace=self.trace, budgets=budgets
        )
        self.milestones = Milestones()
        self.relaxations: list[Relaxation] = []
        self.costs = Costs()
        self.issued = 0
        self.replayed = False  # has its beginning been run once more, and compared (law 16)?
        self._completes_ideal: int | None = None  # the adaptation with which the first ω-ideal reactor is complete
        self._unanswered: set[int] = set()
        self._acted_on = 0  # number of the last perception given to the planner
        self._busy = False
        self._stop_at: Callable[[], bool] = lambda: False
        if (world := self.host.world) is not None:
            self.reactor.laws.ledgers.append(lambda: _imbalance(world))
            self._stop_at = world.finished
        self.trace.sinks.append(self._watch)

    def run(self, *, until: float | None = None) -> None:
        """Run until the world is finished, or the instant `until` (seconds)."""
        wall, cpu = time.perf_counter(), time.process_time()
        if not self.planner_time.deterministic:
            self.trace.record("not_deterministic", because="the planner is charged its real time")
        self._begin()
        if self.host.world is not None:
            self.host.world.start(self.scheduler)
        self.scheduler.soon(self._turn)
        self._look()
        self._go(until)
        self.reactor.laws.check()
        self.costs.simulated = self.scheduler.now
        self.costs.wall = time.perf_counter() - wall
        self.costs.cpu = time.process_time() - cpu

    def _begin(self) -> None:
        self.reactor.start()

    def _go(self, until: float | None) -> None:
        with self.reactor.executer.patient():
            self.reactor.executer.run(until=until)

    def _look(self) -> None:
        """A world may finish without a word: ask it now and then, as long as anything goes on."""
        if self._stop_at():
            self.scheduler.stop()
        elif not self.scheduler.idle:
            self.scheduler.call_after(LOOK_AGAIN, self._look)

    # -- the planner's side

    def tell(self, what: Callable[[Planner], object]) -> None:
        """Somebody tells the planner something (`advice`); it goes on thinking with that."""
        what(self.planner)
        self._perceived()

    def _meet(self, planner: Planner) -> None:
        limits = {name: process.limit for name, process in self.host.processes.items()}
        planner.meet(Environment(self.host.signatures, limits))

    def succeed(self, planner: Planner) -> None:
        """The planner's process is gone, or has lost its office; this one begins, and asks how the reactor stands."""
        self.planners += 1
        self.planner, self._busy = planner, False
        self._unanswered.clear()
        self._completes_ideal = None
        self._meet(planner)
        planner.enquire(self.planners)
        self._turn()

    def _enquire(self, enquiry: Enquiry) -> None:
        """The planner asks; if the answer is lost with the reactor, or is refused, it asks again."""
        self.scheduler.call_after(LATENCY, lambda: self._asked(enquiry))
        self.scheduler.call_after(ASK_AGAIN, lambda: self._ask_again(self.planner))

    def _asked(self, enquiry: Enquiry) -> None:
        try:
            standing = self.reactor.enquire(enquiry)
        except RefusedError:
            return
        self.scheduler.call_after(LATENCY, lambda: self._told(standing))

    def _told(self, standing: Standing) -> None:
        self.planner.resume(standing)
        self._turn()

    def _ask_again(self, planner: Planner) -> None:
        if planner is self.planner and planner.waits:
            planner.enquire(self.planners)
            self._turn()

    def _take(self) -> list[Perception]:
        """What the planner is told now: in order, without gaps (law 10)."""
        return [perception for perception in self.perceptions.take() if self._next(perception)]

    def _next(self, perception: Perception) -> bool:
        if perception.number != self._acted_on + 1:
            self.reactor.laws.breach(10, f"perception {perception.number} after {self._acted_on}")
        self._acted_on = perception.number
        return True

    def _perceived(self) -> None:
        if not self._busy:
            self.scheduler.call_after(LATENCY, self._turn)

    def _turn(self) -> None:
        """Let the planner take what it has been told, and do one step."""
        if self._busy:
            return
        for perception in self._take():
            self.planner.perceive(perception)
        outstanding = len(self.planner.expectation)
        began = time.process_time()
        step = self.planner.step()
        while step is not None and step.kind == "verify":  # in modelled time a verdict is known at once
            step = self.planner.step()
        cpu = time.process_time() - began
        if step is None:
            return
        self.costs.planner_cpu.append(cpu)
        self._decided(step)
        if step.withheld:
            self.trace.record("adaptation_withheld", purpose=step.purpose, because=step.withheld)
        self._busy = True
        charge = self.planner_time.seconds(step, outstanding, cpu)
        planner = self.planner
        self.scheduler.call_after(charge, lambda: self._thought(step, planner))

    def _thought(self, step: Step, planner: Planner) -> None:
        if planner is not self.planner:
            return  # it is gone, and what it thought with it
        self._busy = False
        if step.enquiry is not None:
            self._enquire(step.enquiry)
        for adaptation in step.adaptations if step.kind == "repeat" else ():
            self.trace.record("adaptation_issued_again", id=adaptation.id)
            self._transmit(adaptation)
        for adaptation in step.adaptations if step.kind != "repeat" else ():
            self._send(adaptation, step)
            if self._completes_ideal is None and self.planner.ideal:
                self._completes_ideal = adaptation.id
        self._note_progress(step)
        self._turn()

    def _decided(self, step: Step) -> None:
        if step.assumption:
            last = self.relaxations[-1] if self.relaxations else None
            if last is None or (last.assumption, last.cause) != (step.assumption, step.cause):
                self.relaxations.append(Relaxation(step.assumption, step.cause, self.scheduler.now))
                self.trace.record("relaxation", assumption=step.assumption, cause=step.cause)

    def _send(self, adaptation: Adaptation, step: Step) -> None:
        self.issued += 1
        self._unanswered.add(adaptation.id)
        now = self.scheduler.now
        if self.milestones.first_adaptation_issued_s is None:
            self.milestones.first_adaptation_issued_s = now
        for relaxation in reversed(self.relaxations):
            if (relaxation.assumption, relaxation.cause) == (step.assumption, step.cause):
                relaxation.issued_s, relaxation.last = now, adaptation.id
                break
        self.trace.record(
            "adaptation_issued", id=adaptation.id, purpose=adaptation.purpose, text=adaptation.definitions,
            kills=adaptation.kills, adds=adaptation.adds, situations=[c.situation for c in adaptation.changes],
            removed=adaptation.removed, rests_on={c.situation: c.assumptions for c in adaptation.changes},
            adopts=adaptation.adopts, drops=adaptation.drops, assumption=step.assumption, cause=step.cause,
            assumptions=self.planner.assumptions_in_use,
        )  # fmt: skip
        self._transmit(adaptation)

    def _transmit(self, adaptation: Adaptation) -> None:
        self.adaptations.send(adaptation)

    def _issued(self) -> None:
        self.scheduler.call_after(LATENCY, self._deliver)

    def _deliver(self) -> None:
        adaptation = self.adaptations.take()
        if adaptation is not None:
            self.reactor.receive(adaptation)

    # -- what is remembered of it

    def _note_progress(self, step: Step) -> None:
        self.trace.record(
            "planner_step", step=step.kind, situation=step.situation, assumption=step.assumption,
            assumptions=self.planner.assumptions_in_use, expectation=len(self.planner.expectation),
        )  # fmt: skip

    def _watch(self, event: Any) -> None:
        if event.kind in ("adaptation_applied", "adaptation_refused", "adaptation_timed_out"):
            self._unanswered.discard(event.data["id"])
        if event.kind == "adaptation_applied":
            self._note_applied(event.data["id"])
        if self._stop_at():
            self.scheduler.stop()

    def _note_applied(self, adaptation_id: int) -> None:
        now = self.scheduler.now
        if self.milestones.first_reactor_s is None:
            self.milestones.first_reactor_s = now
        for relaxation in self.relaxations:
            if relaxation.last == adaptation_id:
                relaxation.applied_s = now
        last = self._completes_ideal
        if last is None or self.milestones.first_ideal_s is not None:
            return
        if min(self._unanswered, default=last + 1) > last:
            self.milestones.first_ideal_s = now
            self.trace.record("ideal")


def _imbalance(world: World) -> str:
    return "" if world.balanced() else f"the world's ledger does not balance: {dict(world.ledger())}"


def summary(loop: Loop) -> Mapping[str, Any]:
    """What a run comes to, with the keys of the command line's JSON."""
    reactor, counts = loop.reactor, loop.reactor.counts
    world = loop.host.world
    pending = len(reactor.transactions.under_way) + len(loop.adaptations)
    return {
        **(world.report() if world is not None else {}),
        "adaptations": {
            "issued": loop.issued, "applied": counts["applied"], "refused": counts["refused"],
            "timed_out": counts["timed_out"], "pending": pending,
        },
        "changes_applied": counts["changes_applied"],
        "assumptions": {
            "planner": sorted(loop.planner.assumptions_in_use), "reactor": list(reactor.assumptions_in_use),
        },
        "first_adaptation_issued_s": loop.milestones.first_adaptation_issued_s,
        "first_reactor_s": loop.milestones.first_reactor_s,
        "first_ideal_s": loop.milestones.first_ideal_s,
        "stub_triggers": reactor.stub_triggers,
        "relaxations": [
            {
                "assumption": r.assumption, "cause": r.cause, "decided_s": r.decided_s,
                "issued_s": r.issued_s, "applied_s": r.applied_s,
            }
            for r in loop.relaxations
        ],
        "interruptions": reactor.laws.interruptions,
        "laws_checked": [*LAWS_CHECKED, *([16] if loop.replayed else [])],
        "violations": [str(v) for v in reactor.laws.violations],
        "simulated_s": loop.costs.simulated,
        "wall_s": round(loop.costs.wall, 3),
        "cpu_s": round(loop.costs.cpu, 3),
        "trace_hash": loop.trace.hash,
    }  # fmt: skip
