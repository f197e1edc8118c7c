"""One run of a case in the kitting cell: its real planner, its world with its own faults, and the same chaos.

The world lives on when the reactor crashes: belts run, the arm's commands are abandoned, and what it holds has to be
taken up by the next incarnation, or be put away (row 30). Its books are asked after every event. The planner keeps
nothing: one that begins anew asks how the reactor stands and resumes on that (decision 0033).
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from functools import lru_cache

from planner_reactor.analysis.permission import Environment
from planner_reactor.link.messages import Perception, Standing
from planner_reactor.logic.domain import Domain
from planner_reactor.logic.reader import read_domain
from planner_reactor.planner.beliefs import in_doubt
from planner_reactor.planner.planner import Planner, Step
from planner_reactor.reactor.assumptions import CALM as PRESUMED
from planner_reactor.reactor.laws import Violation
from planner_reactor.runtime import Scheduler
from planner_reactor.simulation.books import Key
from planner_reactor.simulation.cases import Case
from planner_reactor.simulation.sensors import Read
from planner_reactor.simulation.sides import PlannerSide
from planner_reactor.simulation.stage import CALM, Stage
from planner_reactor.simulation.workshop import Axis, Dog
from planner_reactor.trace import Trace
from planner_reactor.workcell.domains import SHIPPED, shipped_domain
from planner_reactor.workcell.host import host
from planner_reactor.workcell.world import World

THOUGHT = 0.1
"""Seconds that a step of the planner takes."""

ASK_AGAIN = 3.0
"""Seconds after which a planner that was not told how the reactor stands asks once more."""

SETTLING = 150.0
"""Seconds before the end of the calm: what was asked for until then is answered at the end."""


@lru_cache
def the_domain() -> Domain:
    return read_domain(shipped_domain(), file=SHIPPED)


class Cell(Stage):
    """The stage with the kitting cell in the place of the workshop."""

    def __init__(self, case: Case) -> None:
        super().__init__(case)
        self.thinker = self._planner()
        self._asked = 0.0
        self._old: set[Key] = set()  # pending as the end comes near
        self._unknown: set[str] = set()  # assumptions of which the two sides think otherwise as the end comes near

    def _planner(self) -> Planner:
        return Planner(the_domain(), relax=() if self.case.trusting else "all")

    def make_shop(self) -> CellShop:
        return CellShop(self.scheduler, self.trace)

    def begin_reactor(self) -> None:
        before = self.side
        super().begin_reactor()
        if self.side is not None and self.side is not before:
            world = self.shop.world
            self.side.reactor.laws.ledgers.append(lambda: "" if world.balanced() else "the cell's books")

    def down(self, *, power: bool) -> None:
        arm = self.shop.world.arm
        if self.side is not None and arm is not None and arm.gripped:
            self.rows["30 crashes while something was held"] += 1
        super().down(power=power)

    def when_holding(self, strikes: Callable[[], object]) -> None:
        """As soon as the gripper holds something."""
        world = self.shop.world

        def attempt() -> bool:
            holding = world.arm is not None and world.arm.gripped and self.side is not None and not self.calm
            if holding:
                self.scheduler.soon(strikes)
            return bool(holding or self.calm)

        world.attempts.append(attempt)

    # -- the planner

    def open(self) -> None:
        """The planner begins with nothing."""
        self.shop.world.start(self.scheduler)
        self.scheduler.call_at(self.case.seconds + CALM - SETTLING, self._settles)
        self._think()

    def _settles(self) -> None:
        self._old.update(self.book.pending)
        self._unknown.update(self._differing())

    def _differing(self) -> set[str]:
        """What disables something and is trusted by the planner; what it was told to fail, and does not."""
        if self.side is None or self.side.reactor.halted:
            return set()
        failed, reactor = self.side.reactor.failed, self.side.reactor
        named = {a for a in failed if not a.startswith(PRESUMED) and reactor.resting_on(a)}
        trusted = {a for a in named if not in_doubt(a, frozenset(self.thinker.relaxed))}
        return trusted | {a for a, failing in self.watch.believed.items() if failing and a not in failed}

    def planner_begins(self, planner: PlannerSide) -> None:
        """The first meets a reactor that is as new as it is; any other asks how it stands."""
        if self.planners > 1:
            self.thinker = self._planner()
            self.thinker.enquire(self.planners)
        limits = {name: process.limit for name, process in self.shop.host.processes.items()}
        self.thinker.meet(Environment(self.shop.host.signatures, limits))

    def take_over(self) -> None:
        """Every planner that begins is another one."""

    def stands(self, standing: Standing) -> None:
        """The planner is told how the reactor stands: what others asked for and is not in it will never be."""
        self.book.settle(standing.versions, lambda key: key[0] < standing.epoch, standing.clauses)
        self.thinker.resume(standing)

    def _think(self) -> None:
        if self.planner is not None:
            now = self.scheduler.now
            if self.thinker.waits and now - self._asked > ASK_AGAIN:
                self.thinker.enquire(self.planners)
            if (step := self.thinker.step()) is not None:
                self._decided(step)
        self.scheduler.call_after(THOUGHT if self.book.pending else 1.0, self._think)

    def _decided(self, step: Step) -> None:
        if step.enquiry is not None:
            self._asked = self.scheduler.now
            self.send(step.enquiry)
        for adaptation in step.adaptations:
            if step.kind != "repeat":
                named = (*(c.situation for c in adaptation.changes), *adaptation.removed)
                self.book.issue(adaptation, dict.fromkeys(named))
            self.send(adaptation)

    def _heard(self, perception: Perception) -> None:
        super()._heard(perception)
        if self.planner is not None:
            self.thinker.perceive(perception)

    def restarted(self, perception: Perception) -> None:
        """What does not stand is not lost: the planner repeats it."""
        self.book.settle(dict(perception.values), lambda key: False)  # type: ignore[arg-type]  # pairs

    # -- the end

    def rest(self) -> None:
        """The cell is never at rest: but what was asked for some time ago is answered, and both books agree."""
        watch, world = self.watch, self.shop.world
        watch.violations += [
            Violation(11, self.scheduler.now, f"{finding.law}: {finding.message}") for finding in world.findings
        ]
        watch.agreed(self.side)
        if unanswered := self._old.intersection(self.book.pending):
            watch.breach(17, f"adaptations {sorted(unanswered)} are not resolved after {SETTLING} s")
        for assumption in sorted(self._unknown & self._differing()):
            watch.breach(17, f"the planner does not know how it is with {assumption}, after {SETTLING} s")
        if self.thinker.waits or self.thinker.fenced:
            watch.breach(17, "the planner was not told how the reactor stands")
        self.rows["what failed and came back to the planner"] += sum(
            relaxation.cause == "reinstated" for relaxation in self.thinker.relaxations
        )
        self.rows["kits completed"] += world.plant.downstream.completed


class CellShop:
    """The cell, as the stage sees a world."""

    def __init__(self, scheduler: Scheduler, trace: Trace) -> None:
        self.host = host(scheduler, trace=trace)
        self.dog = Dog()
        self.host.watchdog = self.dog
        world = self.host.world
        assert isinstance(world, World)
        self.world = world
        self.counts: Counter[str] = Counter()
        self.axis = Axis()
        self.did: Callable[[str, int, int], object] = lambda situation, instance, version: None
        self.failed: Callable[[str], object] = lambda situation: None
        self.beat: Callable[[], object] = lambda: None

    def read_anew(self) -> dict[str, Read]:
        """Its sensors have their own tests: nothing of what they say is held against the reactor here."""
        return {}

    def calm(self) -> None:
        """What has struck the world stays as it is: it is for the planner to deal with."""

    def relent(self) -> None:
        """Nor does anything come back by itself."""
