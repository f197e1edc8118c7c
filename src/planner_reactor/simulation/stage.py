"""One run of a case in the workshop: both sides, link, disk and world on one scheduler, and the faults that strike.

A crash inside an adaptation unwinds the reactor where it stands (`Crash`); a crash at another time drops it between two
events. Either way its process is gone, the disk is as it is, and after a while the next incarnation begins on it.
"""

from __future__ import annotations

from collections import Counter
from typing import Any

from planner_reactor.errors import DiskError
from planner_reactor.link.codec import decode
from planner_reactor.link.messages import Perception
from planner_reactor.runtime import Scheduler, VirtualClock
from planner_reactor.simulation.books import Book
from planner_reactor.simulation.cases import Case, Fault, Point
from planner_reactor.simulation.clocks import TimeOfDay
from planner_reactor.simulation.disks import Moment, SimulatedDisk
from planner_reactor.simulation.drivers import Drivers
from planner_reactor.simulation.improviser import Improviser
from planner_reactor.simulation.lives import Crash
from planner_reactor.simulation.sides import PlannerSide, ReactorSide
from planner_reactor.simulation.striking import strike
from planner_reactor.simulation.watch import Watch
from planner_reactor.simulation.wires import CLEAN, Name, Weather, Wire
from planner_reactor.simulation.workshop import Workshop
from planner_reactor.trace import Event, Trace

CALM = 260.0
"""Seconds after which all must be resolved, once faults have ceased: the longest deed, a deadline, a few rounds."""

POINT_OF: dict[str, Point] = {
    "adaptation_received": "received", "adaptation_applied": "applied", "adaptation_refused": "refused",
    "adaptation_timed_out": "timed_out", "draining": "draining", "inhibited": "inhibited", "removed": "removed",
    "retired": "retired", "renewed": "renewed", "added": "added", "uninhibited": "uninhibited",
}  # fmt: skip
OUTCOMES = {"adaptation_applied": "applied", "adaptation_refused": "refused", "adaptation_timed_out": "timed_out"}


class Stage:
    """Everything of one run. `rows` counts what happened, by the rows of the fault table."""

    def __init__(self, case: Case) -> None:
        self.case = case
        self.scheduler = Scheduler(VirtualClock(), seed=case.seed)
        self.trace = Trace(lambda: self.scheduler.now, keep=False)
        self.rows: Counter[str] = Counter()
        self.inside: Counter[str] = Counter()  # faults that struck inside an adaptation, by kind and point
        self.draw = self.scheduler.random("stage")
        self.shop = self.make_shop()
        self.disk = SimulatedDisk()
        self.clock = TimeOfDay(self.scheduler)
        self.book = Book()
        self.brain = Improviser(self.book, self.scheduler.random("planner"))
        self.watch = Watch(self.scheduler, self.book)
        self.wire = Wire(self.scheduler, self._arrived, self._met)
        self.side: ReactorSide | None = None
        self.planner: PlannerSide | None = None
        self.planners = 0
        self.calm = False
        self.armed: list[Fault] = []
        self.restarts: list[float] = []
        self.shop.did = lambda s, i, v: self.watch.did(self.side, s, i, v)
        self.shop.beat = self.watch.beat
        self.trace.sinks.append(self._traced)

    def run(self) -> None:
        """Faults strike for as long as the case says; then they cease, and all is asked."""
        self.wire.weather = Weather(*self.draw.choice(((0.0, 0.0, 0.05), (0.05, 0.05, 0.3), (0.2, 0.2, 1.0))))
        for fault in self.case.faults:
            self.scheduler.call_at(fault.at, lambda fault=fault: self._due(fault))  # type: ignore[misc]
        self.begin_reactor()
        self.begin_planner()
        self.open()
        with self.clock:
            self._run(self.case.seconds)
            self._cease()
            self._run(self.case.seconds + CALM)
        self._sum_up()
        self.rest()
        if self.side is not None:
            self.side.reactor.laws.check()
            self.side.end(power=False)
            self.watch.over(self.side)

    def make_shop(self) -> Any:
        """The world of this stage."""
        return Workshop(self.scheduler)

    def open(self) -> None:
        """The planner asks for something to begin with."""
        self.send(self.brain.first())
        self._think()

    def rest(self) -> None:
        """Faults have ceased for long enough: is everything resolved?"""
        self.watch.at_rest(self.side, sum(end.unacknowledged for end in self.wire.ends.values()))

    def _sum_up(self) -> None:
        wire, shop, rows = self.wire.counts, self.shop.counts, self.rows
        rows.update({f"4 frames {what.replace('_', '-')}": n for what, n in wire.items()})
        rows["6 moves resumed after the drive was gone"] += shop["resumed"]
        rows["12 deeds of a version whose successor is there"] += self.watch.late_versions
        rows["14 deeds that raised"] += shop["raised"]
        rows["14 deeds that hung"] += shop["hung"]
        for wrong in self.shop.axis.wrong:
            self.watch.breach(11, wrong)

    def _run(self, until: float) -> None:
        while True:
            try:
                self.scheduler.run(until)
                return
            except Crash as crash:
                self.down(power=crash.power)

    def _cease(self) -> None:
        self.calm = True
        self.armed.clear()
        self.shop.calm()
        self.disk.mend()
        self.wire.weather = CLEAN
        self.wire.open.update({"reactor": True, "planner": True})
        if self.planner is None:
            self.begin_planner()
        self.release()

    # -- the reactor's side

    def begin_reactor(self) -> None:
        """The next incarnation, on what the disk holds."""
        if self.side is not None:
            return
        drivers = Drivers(self.shop.host, Counter())
        self.side = side = ReactorSide(
            self.scheduler, self.shop.host, drivers, self.disk, self.wire, self.trace, self._moment
        )
        self.watch.began(side)
        if not side.start():
            self.rows["27 no start on a full disk"] += 1
            side.end(power=False)
            self.side = None
            self.scheduler.call_after(1.0, self.begin_reactor)
            return
        assert side.session is not None
        self.watch.gave[side.session.incarnation] = side.sent

    def down(self, *, power: bool) -> None:
        """The reactor's process is gone."""
        if (side := self.side) is None:
            return
        self.side = None
        if side.end(power=power):
            self.rows["13 commands abandoned by a crash"] += 1
        self.watch.pause()
        self.watch.over(side)
        if power:
            torn = self.disk.torn
            self.disk.crash(self.draw)
            self.rows["3 writes torn"] += self.disk.torn - torn
        self.scheduler.call_after(self.draw.choice((0.1, 1.0, 5.0)), self.begin_reactor)

    def _moment(self, moment: Moment) -> None:
        if moment != "replaced" and self.side is not None:
            self.at_point(moment)

    def release(self) -> None:
        """The reset after a halt; somebody tries again if the journal cannot say so."""
        if self.side is not None and self.side.session is not None and self.side.reactor.halted:
            self.watch.pause()
            try:
                self.side.reactor.reset()
            except DiskError:
                self.rows["27 no reset on a full disk"] += 1
                self.scheduler.call_after(1.0, self.release)

    # -- the planner's side

    def begin_planner(self) -> None:
        """The next incarnation: what was not answered is sent again, under the same ids."""
        if self.planner is not None:
            return
        self.planners += 1
        self.planner = PlannerSide(self.planners, self.wire)
        self.wire.plug("planner", self.planner.session)
        for pending in self.book.pending.values():
            self.planner.send(pending.adaptation)

    def end_planner(self) -> None:
        """The planner's process is gone; its book is on disk."""
        if self.planner is not None:
            self.planner = None
            self.wire.plug("planner", None)
            self.scheduler.call_after(self.draw.choice((0.2, 2.0, 20.0)), self.begin_planner)

    def _think(self) -> None:
        if self.calm:
            return
        if self.planner is not None and (adaptation := self.brain.improvise()) is not None:
            self.send(adaptation)
        self.scheduler.call_after(self.draw.uniform(2.0, 24.0), self._think)

    def send(self, adaptation: object) -> None:
        if self.planner is not None and adaptation is not None:
            self.planner.send(adaptation)  # type: ignore[arg-type]  # what the improviser drew

    # -- the link

    def _met(self, to: Name) -> None:
        if to == "planner" and self.planner is not None:
            self.planner.met()

    def _arrived(self, to: Name, messages: list[bytes]) -> None:
        if to == "reactor":
            if self.side is not None:
                self.side.receive(messages)
                self.side.pump()
            return
        planner = self.planner
        assert planner is not None
        for message in messages:
            perception = decode(message)
            assert isinstance(perception, Perception)
            if self.planner is planner and self.watch.new(planner.session.peer, perception):
                self._heard(perception)
        if self.side is not None:
            self.scheduler.soon(self._pump)

    def _pump(self) -> None:
        if self.side is not None:
            self.side.pump()

    def _heard(self, perception: Perception) -> None:
        assert self.planner is not None
        self.rows["10 perceptions acted on"] += 1
        if perception.kind == "restarted":
            self.book.restarted(perception, self.planner.dead)
        elif (outcome := OUTCOMES.get(perception.kind)) is not None:
            number = int(perception.subject)
            self.book.answered((perception.epoch, number), outcome)
            self.rows[f"answers: {perception.cause or outcome}"] += 1
            self.at_point("told")

    # -- faults

    def _due(self, fault: Fault) -> None:
        if self.calm:
            return
        if fault.point is not None:
            self.armed.append(fault)
        else:
            strike(self, fault)

    def _traced(self, event: Event) -> None:
        self._count(event)
        if (point := POINT_OF.get(event.kind)) is None or self.side is None:
            return
        if point == "added" and self.side.reactor.restoring:
            self.at_point("restoring")
        elif point in ("received", "applied", "refused", "timed_out") or self.under_way:
            self.at_point(point)

    def _count(self, event: Event) -> None:
        """What the fault table asks for and no fault brings about by itself."""
        rows, kind = self.rows, event.kind
        if kind == "adaptation_applied":
            self._applied(event.data["id"])
        elif kind == "adaptation_timed_out":
            rows["8 situations that did not end in time"] += 1
        elif kind == "draining" and self.side is not None:
            instances = self.side.reactor.situations.named(event.data["situation"]).instances
            rows["9 drained while instances overlapped"] += len(instances) > 1
        elif kind in ("aborted", "error", "limit"):
            rows["10 deeds that failed inside an adaptation"] += self.under_way
        elif kind == "adaptation_refused":
            asked = self.book.pending.get((self.book.epoch, event.data["id"]))
            rows["11 groups refused as one"] += asked is not None and len(asked.adaptation.adds) > 1
        elif kind == "zeno":
            rows["16 livelocks"] += 1

    @property
    def under_way(self) -> bool:
        """Is an adaptation under way in the reactor?"""
        return self.side is not None and bool(self.side.reactor.transactions.under_way)

    def _applied(self, number: int) -> None:
        assert self.side is not None
        transaction = self.side.reactor.last_applied
        assert transaction is not None
        assert transaction.adaptation.id == number
        self.watch.applied(transaction.adaptation)
        self.rows[f"applied by {transaction.adaptation.mode}"] += 1

    def at_point(self, point: Point) -> None:
        """A named point inside an adaptation: what was armed for it strikes now."""
        for fault in self.armed:
            if fault.point == point:
                self.armed.remove(fault)
                strike(self, fault)
                return
