"""One run of a case in the workshop: both sides, link, disk and world on one scheduler, and the faults that strike.

A crash inside an adaptation unwinds the reactor where it stands (`Crash`); a crash at another time drops it between two
events. Either way its process is gone, the disk is as it is, and after a while the next incarnation begins on it.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from typing import Any

from planner_reactor.errors import DiskError
from planner_reactor.link.codec import LARGEST_STANDING, decode
from planner_reactor.link.messages import Adaptation, Enquiry, Perception, Standing
from planner_reactor.reactor.storms import Intensity
from planner_reactor.runtime import Scheduler, VirtualClock
from planner_reactor.simulation.books import Book
from planner_reactor.simulation.cases import Case, Fault, Point
from planner_reactor.simulation.clocks import TimeOfDay
from planner_reactor.simulation.counting import Counting
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

UNDERWAY = 1.0
"""Seconds that a message may be on its way over a link that is sound: a resend or two."""

KNOWN = 60.0
"""Seconds after which the planner must know what fails, once faults have ceased."""

POINT_OF: dict[str, Point] = {
    "adaptation_received": "received", "adaptation_applied": "applied", "adaptation_refused": "refused",
    "adaptation_timed_out": "timed_out", "draining": "draining", "inhibited": "inhibited", "removed": "removed",
    "retired": "retired", "renewed": "renewed", "added": "added", "uninhibited": "uninhibited",
}  # fmt: skip
OUTCOME: tuple[Point, ...] = ("applied", "refused", "timed_out")
"""Points at which an outcome is certain, and not told yet."""

OUTCOMES = {"adaptation_applied": "applied", "adaptation_refused": "refused", "adaptation_timed_out": "timed_out"}
INTENSITY = Intensity(failures=40, window=10.0)
"""Of failures, in cases in which everything fails for a while."""


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
        self.brain = Improviser(self.book, self.scheduler.random("planner"), self.scheduler.random("rests"))
        self.intensity = INTENSITY if any(fault.kind == "failing" for fault in case.faults) else None
        self.watch = Watch(self.scheduler, self.book, self.intensity)
        self.wire = Wire(self.scheduler, self._arrived, self._met, self._room)
        self.side: ReactorSide | None = None
        self.planner: PlannerSide | None = None
        self.planners = 0
        self.calm = False
        self.armed: list[Fault] = []
        self.restarts: list[float] = []
        self.counting = Counting(self)
        self.shop.did = self._did
        self.shop.failed = self._failed
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
            self._run(self.case.seconds + CALM - UNDERWAY)
            perceived = self.side, self.side.perceptions.sent if self.side else 0
            asked = self.planner, len(self.planner.sent) if self.planner else 0
            self._run(self.case.seconds + CALM)
        for what, (side, given), still in (("perceptions", perceived, self.side), ("requests", asked, self.planner)):
            if side is not None and side is still:  # the world goes on: there may be something new all the time
                self.watch.arrived(what, given, side)
        self.rest()
        if self.side is not None:
            self.side.reactor.laws.check()
            self.side.end(power=False)
            self.watch.over(self.side)
        self._sum_up()

    def when_holding(self, strikes: Callable[[], object]) -> None:
        """In a world with a gripper: as soon as it holds something."""

    def make_shop(self) -> Any:
        """The world of this stage."""
        return Workshop(self.scheduler)

    def open(self) -> None:
        """The planner asks for something to begin with."""
        self.send(self.brain.first())
        self._think()

    def rest(self) -> None:
        """Faults have ceased for long enough: is everything resolved?"""
        self.watch.at_rest(self.side)

    def _sum_up(self) -> None:
        self.counting.sum_up()
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
        self.scheduler.call_after(KNOWN, lambda: self.watch.informed(self.side))
        for after in (KNOWN + 1.0, 2.0 * KNOWN):  # a reactor that does not stand yet does not hear
            self.scheduler.call_after(after, self.shop.relent)

    # -- the reactor's side

    def begin_reactor(self) -> None:
        """The next incarnation, on what the disk holds."""
        if self.side is not None:
            return
        drivers = Drivers(self.shop.host, Counter(), lambda: self.scheduler.now)
        self.side = side = ReactorSide(
            self.scheduler, self.shop.host, drivers, self.disk, self.wire, self.trace, self._moment,
            intensity=self.intensity,
        )  # fmt: skip
        self.counting.begins()
        self.watch.began(side, self.shop.read_anew())
        if not side.start():
            self.rows["27 no start on a full disk"] += 1
            side.end(power=False)
            self.side = None
            self.scheduler.call_after(1.0, self.begin_reactor)
            return
        assert side.session is not None
        self.watch.gave[side.session.incarnation] = side.sent
        self.watch.stands(side)
        self.restarts = [t for t in self.restarts if t > self.scheduler.now - 5.0] + [self.scheduler.now]
        self.rows["32 restarts in a storm"] += len(self.restarts) > 3
        if side.reactor.halted:
            self._release_later()

    def down(self, *, power: bool) -> None:
        """The reactor's process is gone."""
        if (side := self.side) is None:
            return
        self.side = None
        self.rows["13 commands abandoned by a crash"] += side.end(power=power)
        self.watch.pause()
        self.watch.over(side)
        if power:
            self._power_goes()
        self.scheduler.call_after(self.draw.choice((0.1, 1.0, 5.0)), self.begin_reactor)

    def _power_goes(self) -> None:
        pending, durable = self.disk.pending, self.disk.durable
        self.disk.crash(self.draw)
        kept = len(self.disk.durable) - len(durable)
        self.rows["3 writes torn"] += 0 < kept < len(pending)
        self.rows["3 writes lost"] += 0 == kept < len(pending)

    def _moment(self, moment: Moment) -> None:
        if moment != "replaced" and self.side is not None:
            self.at_point(moment)

    def _release_later(self) -> None:
        """People come, sooner or later."""
        self.scheduler.call_after(self.draw.uniform(1.0, 30.0), self.release)

    def release(self) -> None:
        """The reset after a halt; somebody tries again if the journal cannot say so."""
        if self.side is None or self.side.session is None or not self.side.reactor.halted:
            return
        self.watch.pause()
        self.shop.dog.reset()
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
        self.watch.believed.clear()
        self.planner = PlannerSide(self.planners, self.wire)
        self.wire.plug("planner", self.planner.session)
        self.planner_begins(self.planner)

    def planner_begins(self, planner: PlannerSide) -> None:
        """It has its book; in the place of the first there may be another (`take_over`)."""
        for pending in self.book.pending.values():
            planner.send(pending.adaptation)

    def take_over(self) -> None:
        """Who begins next is another planner."""
        self.book.take_over()

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
        self.scheduler.call_after(self.draw.uniform(2.0, 20.0), self._think)

    def send(self, message: Adaptation | Enquiry) -> None:
        if self.planner is not None:
            self.planner.send(message)

    # -- the link

    def _met(self, to: Name) -> None:
        if to == "planner" and self.planner is not None:
            self.planner.met()

    def _room(self, to: Name) -> None:
        if to == "reactor" and self.side is not None:
            self.side.pump()

    def _arrived(self, to: Name, messages: list[bytes]) -> None:
        if to == "reactor":
            if self.side is not None:
                self.side.receive(messages)
            return
        planner = self.planner
        assert planner is not None
        for message in messages:
            told = decode(message, largest=LARGEST_STANDING)
            if self.planner is not planner:
                break
            if isinstance(told, Standing):
                self.stands(told)
            elif isinstance(told, Perception) and self.watch.new(planner.session, told):
                self._heard(told)

    def stands(self, standing: Standing) -> None:
        """A planner that enquired is told how the reactor stands; the improviser never asks."""

    def _heard(self, perception: Perception) -> None:
        assert self.planner is not None
        self.rows["10 perceptions acted on"] += 1
        if perception.kind == "restarted":
            self.restarted(perception)
        elif perception.kind == "error" and perception.subject == "journal" and not self.disk.refused:
            self.watch.breach(10, "the planner is told of a disk that takes nothing, and it has taken everything")
        elif perception.kind in ("assumption_failure", "assumption_holds"):
            self.watch.believed[perception.subject] = perception.kind == "assumption_failure"
        elif (outcome := OUTCOMES.get(perception.kind)) is not None:
            self.book.answered((perception.epoch, int(perception.subject)), outcome)
            self.rows[f"answers: {perception.cause or outcome}"] += 1
            if outcome == "refused":
                self.rows["23 refusals told with their reason"] += bool(perception.cause)
                if not perception.cause:
                    self.watch.breach(10, f"a refusal without a reason: {perception}")
            self.at_point("told")

    def restarted(self, perception: Perception) -> None:
        """What the reactor had taken is settled by the versions that stand."""
        assert self.planner is not None
        self.book.settle(dict(perception.values), self.planner.dead.__contains__)  # type: ignore[arg-type]  # pairs

    # -- faults

    def _due(self, fault: Fault) -> None:
        if self.calm:
            return
        if fault.point is not None:
            self.armed.append(fault)
        else:
            strike(self, fault)

    def _did(self, situation: str, instance: int, version: int) -> None:
        self.watch.did(self.side, situation, instance, version)
        if self.shop.dog.stands(self.scheduler.now):
            self.watch.breach(15, f"a deed of {situation}, and the watchdog has stopped the machine")

    def _failed(self, situation: str) -> None:
        if self.side is not None:
            pending = self.side.reactor.transactions.pending_situations
            self.rows["10 deeds that failed in what is being changed"] += situation in pending

    def _traced(self, event: Event) -> None:
        self.counting.event(event)
        self.watch.event(event)
        if event.kind == "halted":
            self.watch.pause()
            self._release_later()
        if (point := POINT_OF.get(event.kind)) is None or self.side is None:
            return
        if point == "added" and self.side.reactor.restoring:
            self.at_point("restoring")
        elif point == "received" or point in OUTCOME or self.under_way:
            self.at_point(point)

    @property
    def under_way(self) -> bool:
        """Is an adaptation under way in the reactor?"""
        return self.side is not None and bool(self.side.reactor.transactions.under_way)

    def is_inside(self, fault: Fault) -> bool:
        """Does it strike while an adaptation is taken and its outcome not told?"""
        if self.side is None:
            return False
        counts = self.side.reactor.counts
        in_hand = counts["received"] > counts["applied"] + counts["refused"] + counts["timed_out"]
        return in_hand or fault.point in OUTCOME

    def at_point(self, point: Point) -> None:
        """A named point inside an adaptation: what was armed for it strikes now."""
        for fault in self.armed:
            if fault.point == point:
                self.armed.remove(fault)
                strike(self, fault)
                return
