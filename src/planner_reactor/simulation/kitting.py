"""One run of a case in the kitting cell: its real planner, its world with its own faults, and the same chaos.

The world lives on when the reactor crashes: belts run, the arm's commands are abandoned, and what it holds has to be
taken up by the next incarnation, or be put away (row 30). Its books are asked after every event.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable

from msgspec.structs import replace

from planner_reactor.analysis.verdicts import Environment
from planner_reactor.experiments.runs import the_domain
from planner_reactor.link.messages import Perception, PerceptionKind
from planner_reactor.planner.planner import Planner
from planner_reactor.reactor.laws import Violation
from planner_reactor.runtime import Scheduler
from planner_reactor.simulation.books import Key
from planner_reactor.simulation.cases import Case
from planner_reactor.simulation.stage import Stage
from planner_reactor.simulation.workshop import Axis
from planner_reactor.trace import Trace
from planner_reactor.workcell.host import host
from planner_reactor.workcell.world import World

THOUGHT = 0.1
"""Seconds that a step of the planner takes."""

SETTLED: dict[str, PerceptionKind] = {"applied": "adaptation_applied", "lost": "adaptation_refused"}


class Cell(Stage):
    """The stage with the kitting cell in the place of the workshop."""

    def __init__(self, case: Case) -> None:
        super().__init__(case)
        self.world: World
        self.thinker = Planner(the_domain(), relax="all")
        limits = {name: process.limit for name, process in self.shop.host.processes.items()}
        self.thinker.meet(Environment(self.shop.host.signatures, limits))

    def make_shop(self) -> CellShop:
        return CellShop(self.scheduler, self.trace)

    def begin_reactor(self) -> None:
        super().begin_reactor()
        if self.side is not None and self.side.session is not None:
            world = self.shop.world
            self.side.reactor.laws.ledgers.append(lambda: "" if world.balanced() else "the cell's books")

    def down(self, *, power: bool) -> None:
        arm = self.shop.world.arm
        if self.side is not None and arm is not None and arm.gripped:
            self.rows["30 crashes while something was held"] += 1
        super().down(power=power)

    def open(self) -> None:
        """The planner begins with nothing."""
        self.shop.world.start(self.scheduler)
        self._think()

    def _think(self) -> None:
        if self.planner is not None and (step := self.thinker.step()) is not None:
            for adaptation in step.adaptations:
                named = (*(c.situation for c in adaptation.changes), *adaptation.removed)
                self.book.issue(adaptation, dict.fromkeys(named))
                self.send(adaptation)
        self.scheduler.call_after(THOUGHT if self.book.pending else 1.0, self._think)

    def _heard(self, perception: Perception) -> None:
        waiting = dict(self.book.pending)
        super()._heard(perception)
        self.thinker.perceive(perception)
        if perception.kind == "restarted":
            for key in waiting:
                if key not in self.book.pending:
                    self._settled(key, perception)

    def _settled(self, key: Key, perception: Perception) -> None:
        """Nobody told what became of it: what stands does."""
        applied = all(
            self.book.versions.get(c.situation, 0) > c.base for c in self.book.issued[key].changes
        ) and bool(self.book.issued[key].changes)
        kind = SETTLED["applied" if applied else "lost"]
        self.thinker.perceive(replace(perception, kind=kind, subject=str(key[1]), cause="restarted", values=()))

    def rest(self) -> None:
        """The cell is never at rest; its planner and its reactor agree, or are about to."""
        findings = [f"{f.law}: {f.message}" for f in self.shop.world.findings]
        self.watch.violations += [Violation(11, self.scheduler.now, text) for text in findings]
        if self.side is None or self.side.session is None:
            self.watch.breach(17, "there is no reactor")
        self.rows["kits completed"] += self.shop.world.plant.downstream.completed


class CellShop:
    """The cell, as the stage sees a world."""

    def __init__(self, scheduler: Scheduler, trace: Trace) -> None:
        self.host = host(scheduler, trace=trace)
        world = self.host.world
        assert isinstance(world, World)
        self.world = world
        self.counts: Counter[str] = Counter()
        self.axis = Axis()
        self.did: Callable[[str, int, int], object] = lambda situation, instance, version: None
        self.beat: Callable[[], object] = lambda: None

    def calm(self) -> None:
        """What has struck the world stays as it is: it is for the planner to deal with."""
