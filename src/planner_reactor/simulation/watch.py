"""What is asserted after every event: laws that the reactor cannot ask by itself, and the ledgers between two sides.

`reactor/laws.py` asks thirteen laws of one reactor. Here are those that span crashes or need both sides: 3 (by what the
world saw), 9, 10 (with content), 12, 15 (by what the world saw), 17, and the ledgers of adaptations, perceptions and
commands. 16 is asked by running a case twice.
"""

from __future__ import annotations

from collections import Counter

from planner_reactor.link.messages import Adaptation, Perception
from planner_reactor.reactor.laws import Violation
from planner_reactor.runtime import Scheduler
from planner_reactor.simulation.books import Book, Key
from planner_reactor.simulation.sides import ReactorSide
from planner_reactor.simulation.workshop import BEAT

LATE = 0.5
"""Seconds by which a beat may be late: one round that waits its quantum, and rounding."""


class Watch:
    """Collects violations of one run. `commands` counts the commands of the present incarnation."""

    def __init__(self, scheduler: Scheduler, book: Book) -> None:
        self.scheduler = scheduler
        self.book = book
        self.violations: list[Violation] = []
        self.commands: Counter[str] = Counter()
        self.totals: Counter[str] = Counter()
        self.heard = (0, 0)  # incarnation of the reactor and number of the last perception acted on
        self.gave: dict[int, list[Perception]] = {}  # incarnation → what it gave to the link
        self.late_versions = 0
        self._versions: dict[tuple[str, int], int] = {}
        self._last_beat: float | None = None

    def breach(self, law: int, message: str) -> None:
        self.violations.append(Violation(law, self.scheduler.now, message))

    # -- one incarnation of the reactor

    def began(self, side: ReactorSide) -> None:
        self.commands = side.drivers.counts
        self._versions.clear()
        self._last_beat = None
        side.reactor.laws.ledgers.append(lambda: self._unbalanced(side))

    def over(self, side: ReactorSide) -> None:
        """Its violations and counts are ours."""
        if (problem := self._unbalanced(side)) or (problem := "live commands" if side.drivers.live else ""):
            self.breach(11, f"at the end of an incarnation: {problem}")
        self.violations += side.reactor.laws.violations
        self.totals.update({f"commands {what}": n for what, n in side.drivers.counts.items()})
        self.totals.update({f"adaptations {what}": n for what, n in side.reactor.counts.items()})

    def _unbalanced(self, side: ReactorSide) -> str:
        counts = side.drivers.counts
        ended = counts["done"] + counts["failed"] + counts["abandoned"]
        if counts["sent"] != ended + len(side.drivers.live):
            return f"commands: {dict(counts)}, {len(side.drivers.live)} live"
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

    def pause(self) -> None:
        """It does not act by right."""
        self._last_beat = None

    # -- what the planner hears

    def new(self, incarnation: int, perception: Perception) -> bool:
        """Is this one to be acted on? Numbered without gaps, of the content that was given (law 10)."""
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

    def at_rest(self, side: ReactorSide | None, owed: int) -> None:
        """Law 17: faults have ceased and the planner answered; everything is resolved, and both books agree."""
        for wrong in self.book.wrong:
            self.breach(9, wrong)
        if side is None or not side.life.alive or side.session is None:
            self.breach(17, "there is no reactor")
            return
        reactor = side.reactor
        if self.book.pending or reactor.transactions.under_way:
            self.breach(17, f"adaptations {list(self.book.pending)} are not resolved")
        if reactor.failed or list(reactor.situations.held):
            held = [s.name for s in reactor.situations.held]
            self.breach(17, f"{held} are held back, {list(reactor.failed)} are thought to fail")
        if owed or len(side.perceptions):
            self.breach(17, f"{owed} messages and {len(side.perceptions)} perceptions are on the way")
        if not self.book.pending and (problem := self.book.difference(reactor.journal.state.committed)):
            self.breach(11, problem)
        if self._last_beat is None or self.scheduler.now - self._last_beat > BEAT + LATE:
            self.breach(12, "the reaction that beats is not heard")
