"""What is asserted after every event: laws that the reactor cannot ask by itself, and the ledgers between two sides.

`reactor/laws.py` asks thirteen laws of one reactor. Here are those that span crashes or need both sides: 3, 14 and 15
(by what the world saw), 9, 10 (with content), 12, 17, and the ledgers of adaptations, perceptions and commands. 16 is
asked by running a case twice. Nothing here is asked of the reactor that it could get wrong by itself: what it applies
is held against the planner's book, what it believes against what the sensors said.
"""

from __future__ import annotations

from collections import Counter, deque
from math import inf

from planner_reactor.link.messages import Adaptation, Perception
from planner_reactor.link.session import Session
from planner_reactor.reactor.assumptions import CALM
from planner_reactor.reactor.laws import Violation
from planner_reactor.reactor.situations import Situations
from planner_reactor.reactor.storms import COUNTED, Intensity
from planner_reactor.runtime import Scheduler
from planner_reactor.simulation.books import Book, Key
from planner_reactor.simulation.sensors import CAUTIONS, PERIOD, Read, caution_of
from planner_reactor.simulation.sides import PlannerSide, ReactorSide
from planner_reactor.simulation.workshop import BEAT
from planner_reactor.trace import Event

LATE = 0.5
"""Seconds by which a beat may be late: one round that waits its quantum, and rounding."""

STORMY = 30
"""Failures of a situation that may come to pass in the step in which it is stopped."""


class Watch:
    """Collects violations of one run. `commands` counts the commands of the present incarnation."""

    def __init__(self, scheduler: Scheduler, book: Book, intensity: Intensity | None = None) -> None:
        self.scheduler = scheduler
        self.book = book
        self.violations: list[Violation] = []
        self.commands: Counter[str] = Counter()
        self.totals: Counter[str] = Counter()
        self.heard = (0, 0)  # incarnation of the reactor and number of the last perception acted on
        self._told: dict[tuple[int, int], int] = {}  # incarnations of planner and reactor → the number given last
        self.gave: dict[int, list[Perception]] = {}  # incarnation → what it gave to the link
        self.late_versions = 0
        self._intensity = intensity
        self._failures: dict[str, deque[float]] = {}
        self._stormy: set[str] = set()  # what has failed too often, and was not changed since
        self._versions: dict[tuple[str, int], int] = {}
        self._last_beat: float | None = None
        self._side: ReactorSide | None = None
        self._read: dict[str, Read] = {}  # what the sensors have said to this incarnation
        self._failing: dict[str, bool] = {}  # what the planner was told of an assumption last
        self.believed: dict[str, bool] = {}  # what the planner that lives has heard: does it fail?
        self._changed: dict[str, float] = {}  # and when that was another thing than before

    def breach(self, law: int, message: str) -> None:
        self.violations.append(Violation(law, self.scheduler.now, message))

    # -- one incarnation of the reactor

    def began(self, side: ReactorSide, read: dict[str, Read]) -> None:
        """An incarnation begins; what sensors say to it comes to be in `read`."""
        self._side = side
        self.commands = side.drivers.counts
        self._read = read
        self._failing, self._changed = {}, {}
        self._versions.clear()
        self._failures.clear()
        self._stormy.clear()
        self._last_beat = None
        side.reactor.laws.ledgers.append(lambda: self._unbalanced(side))

    def stands(self, side: ReactorSide) -> None:
        """It stands on its journal, and begins with what that says to fail."""
        self._failing = dict.fromkeys(side.reactor.failed, True)

    def over(self, side: ReactorSide) -> None:
        """Its violations and counts are ours."""
        self._side = None
        if (problem := self._unbalanced(side)) or (problem := "live commands" if side.drivers.live else ""):
            self.breach(11, f"at the end of an incarnation: {problem}")
        self.violations += side.reactor.laws.violations
        self.totals.update({f"commands {what}": n for what, n in side.drivers.counts.items()})
        self.totals["commands abandoned by itself"] += side.drivers.counts["abandoned"] - side.drivers.closed
        self.totals.update({f"adaptations {what}": n for what, n in side.reactor.counts.items()})

    def _unbalanced(self, side: ReactorSide) -> str:
        counts = side.drivers.counts
        ended = counts["done"] + counts["failed"] + counts["abandoned"]
        if counts["sent"] != ended + len(side.drivers.live):
            return f"commands: {dict(counts)}, {len(side.drivers.live)} live"
        if counts["overdue"]:
            return f"commands: {counts['overdue']} lived longer than the limit of their process"
        if [p.number for p in side.sent[-2:]] != list(range(1, len(side.sent) + 1))[-2:]:
            return f"perceptions: {len(side.sent)} given, the last {side.sent[-1].number}"
        book = self.book.counts
        answered = book["applied"] + book["refused"] + book["timed_out"] + book["lost"]
        if book["issued"] != answered + len(self.book.pending):
            return f"the planner's adaptations: {dict(book)}, {len(self.book.pending)} pending"
        return ""

    # -- what the world sees

    def did(self, side: ReactorSide | None, situation: str, instance: int, version: int) -> None:
        """A deed of an instance begins, by the reaction with this label (laws 3 and 15)."""
        if side is None:
            self.breach(15, f"a deed of {situation} without a reactor")
            return
        if self._versions.setdefault((situation, instance), version) != version:
            self.breach(3, f"instance {instance} of {situation} was served by {version} too")
        if version not in side.reactor.reactions:
            self.late_versions += 1
        if side.reactor.halted:
            self.breach(15, f"a deed of {situation} after HALT")

    def beat(self) -> None:
        """Law 12: whatever else goes on, one reaction acts every five seconds."""
        now = self.scheduler.now
        self.totals["beats"] += 1
        if self._last_beat is not None and now - self._last_beat > BEAT + LATE:
            self.breach(12, f"no beat for {now - self._last_beat:.2f} s")
        self._last_beat = now
        if (side := self._side) is not None:
            counted = sum(instance.bodies for instance in side.reactor.situations.instances.values())
            if counted != (served := side.reactor.executer.statistics().bodies_in_service):
                self.breach(11, f"instances: {counted} bodies are counted as in service, {served} are")

    def pause(self) -> None:
        """It does not act by right."""
        self._last_beat = None

    # -- what it believes

    def event(self, event: Event) -> None:
        """What the reactor has just done, by its trace."""
        if event.kind == "entered":
            self._serves(event.data["situation"])
        elif event.kind in ("assumption_failure", "assumption_holds"):
            self._believes(event.data["assumption"], failing=event.kind == "assumption_failure")
        elif event.kind == "ended" and not event.data["ok"] and event.data["cause"] in COUNTED:
            self._fails(event.data["situation"])
        elif event.kind == "storm":
            self._stormy.add(event.data["situation"])
        elif event.kind == "halted":
            self._failures.clear()
            self._stormy.clear()
        elif event.kind == "adaptation_applied":
            self._failures.clear()
            if self._side is not None and (transaction := self._side.reactor.last_applied) is not None:
                self._stormy.difference_update(transaction.situations)

    def _fails(self, situation: str) -> None:
        """Law 13: what fails too often is stopped, within the step in which it does (row 32)."""
        if (limit := self._intensity) is None:
            return
        now, times = self.scheduler.now, self._failures.setdefault(situation, deque())
        times.append(now)
        while times[0] < now - limit.window:
            times.popleft()
        if len(times) > limit.failures + STORMY:
            self.breach(13, f"{situation} has failed {len(times)} times in {limit.window} s")

    def _serves(self, situation: str) -> None:
        """Law 14: no body begins that rests on what was read to fail for as long as its monitor may take. Law 13: nor
        one of what has failed too often.
        """
        if situation in self._stormy:
            self.breach(13, f"{situation} is served, which has failed too often")
        if self._side is None:
            return
        for assumption in self._side.reactor.journal.state.committed.rests_on.get(situation, ()):
            read = self._read.get(assumption)
            if read is None or read.failing_since is None:
                continue
            since = self.scheduler.now - read.failing_since
            if since > PERIOD * caution_of(assumption).fails + LATE:
                self.breach(14, f"{situation} is served, and {assumption} was read to fail for {since:.1f} s")

    def _believes(self, assumption: str, *, failing: bool) -> None:
        """Law 14: what is not known does not fail (row 25), and what flaps costs a change in a hold-off (row 26)."""
        if self._failing.get(assumption, False) == failing:
            return
        self._failing[assumption] = failing
        if (read := self._read.get(assumption)) is None:
            return
        caution, now = caution_of(assumption), self.scheduler.now
        if failing and read.latest.count(False) < caution.fails:
            self.breach(14, f"{assumption} is told to fail, of {list(read.latest)}")
        if assumption in CAUTIONS and now - self._changed.get(assumption, -1e9) < caution.hold_off - LATE:
            since = now - self._changed[assumption]
            self.breach(14, f"{assumption} is told to change {since:.1f} s after the last time")
        self._changed[assumption] = now

    # -- what the planner hears

    def new(self, listener: Session, perception: Perception) -> bool:
        """Is this one to be acted on? Numbered without gaps, of the content that was given (law 10).

        A planner that begins anew may hear once more what the one before it had heard; the same one hears it once.
        """
        incarnation, ends = listener.peer, (listener.incarnation, listener.peer)
        if perception.number <= self._told.get(ends, 0):
            self.breach(10, f"perception {perception.number} is given twice")
        self._told[ends] = perception.number
        last = self.heard[1] if self.heard[0] == incarnation else 0
        if perception.number <= last:
            return False
        if perception.number != last + 1:
            self.breach(10, f"perception {perception.number} after {last}")
        given = self.gave[incarnation]
        wanted = given[perception.number - 1] if perception.number <= len(given) else None
        if wanted is None or (wanted.kind, wanted.subject, wanted.cause, wanted.count) != (
            perception.kind, perception.subject, perception.cause, perception.count
        ):  # fmt: skip
            self.breach(10, f"perception {perception.number} is {perception}, given was {wanted}")
        self.heard = (incarnation, perception.number)
        return True

    # -- adaptations

    def applied(self, adaptation: Adaptation) -> None:
        """Law 9: what is applied was asked for by the planner whose turn it is, as it is, and not yet answered."""
        key: Key = (adaptation.epoch, adaptation.id)
        asked = self.book.pending.get(key)
        if asked is None or asked.adaptation != adaptation:
            what = "nobody asked for" if key not in self.book.issued else "was answered before, or altered"
            self.breach(9, f"adaptation {key} was applied, which {what}")

    def agreed(self, side: ReactorSide | None) -> bool:
        """There is a reactor, no answer was wrong, and if none is missing both books agree."""
        for wrong in self.book.wrong:
            self.breach(9, wrong)
        if side is None or not side.life.alive or side.session is None:
            self.breach(17, "there is no reactor")
            return False
        if not self.book.pending and (problem := self.book.difference(side.reactor.journal.state.committed)):
            self.breach(11, problem)
        return True

    def arrived(self, what: str, before: int, side: ReactorSide | PlannerSide) -> None:
        """Law 17: of what one side has had to say the first so many have come to the other."""
        unacknowledged = 0 if side.session is None else side.session.unacknowledged
        if (come := len(side.sent) - unacknowledged) < before:
            self.breach(17, f"{before - come} {what} are on the way, and have been for a while")

    def informed(self, side: ReactorSide | None) -> None:
        """Law 17: the planner knows why something is disabled, also if it or the reactor began anew since."""
        if side is None or side.session is None or side.reactor.halted:
            return
        for assumption in side.reactor.failed:
            resting = side.reactor.resting_on(assumption)
            self.totals["failures to be known"] += bool(resting)
            if resting and not assumption.startswith(CALM) and not self.believed.get(assumption):
                self.breach(17, f"{list(resting)} are disabled by {assumption}, and the planner was not told")

    def at_rest(self, side: ReactorSide | None) -> None:
        """Law 17: faults have ceased and the planner answered; everything is resolved, and both books agree."""
        if not self.agreed(side):
            return
        assert side is not None
        reactor = side.reactor
        if self.book.pending or reactor.transactions.under_way:
            self.breach(17, f"adaptations {list(self.book.pending)} are not resolved")
        if reactor.failed or reactor.halted or list(reactor.situations.held):
            held = [s.name for s in reactor.situations.held]
            halted = ", and it is halted" if reactor.halted else ""
            self.breach(17, f"{held} are held back, {list(reactor.failed)} are thought to fail{halted}")
        for name in [s.name for s in reactor.situations if s.queue and not s.blocked]:
            self.breach(17, f"{name} is asserted and waits, and nothing holds it back")
        retired = [(r.label, r.situation) for r in reactor.transactions.retired]
        if retired and not any(_may_serve(reactor.situations, n, s) for n, s in retired):
            self.breach(17, f"reactions {[n for n, _ in retired]} were retired, serve nothing, and are still there")
        for assumption in (a for a, failing in self.believed.items() if failing):
            self.breach(17, f"{assumption} holds again, and the planner was not told")
        if self._last_beat is None or self.scheduler.now - self._last_beat > BEAT + LATE:
            self.breach(12, "the reaction that beats is not heard")


def _may_serve(situations: Situations, label: int, situation: str | None) -> bool:
    """Is there an instance still that this retired reaction may have to serve?"""
    last = situations.versions.served(label, situation)[1] if situation else inf
    return situation is not None and last < inf and situations.has_older(situation, int(last))
