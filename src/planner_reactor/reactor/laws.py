"""The reactor's laws, asked after every event (docs/reactor.md, "The reactor's laws").

Each law is a method that looks at the reactor as it stands, or at what has just happened, and gives a sentence for
every breach. They use nothing that the reactor uses to keep them: counts are kept apart. Laws 1 to 8, 10, 11 and 13
to 15 are asked here; 16 (same seed, same trace) is a claim about two runs.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Mapping
from typing import Any, Protocol

import msgspec

from planner_reactor.link.channels import PerceptionChannel
from planner_reactor.reactor.adaptation import Transaction, Transactions
from planner_reactor.reactor.journal import Journal
from planner_reactor.reactor.persistent import Persistent
from planner_reactor.reactor.reactions import Reactions
from planner_reactor.reactor.readings import Readings
from planner_reactor.reactor.situations import Situations, named
from planner_reactor.reactor.versions import Lifetime
from planner_reactor.runtime import Executer, Scheduler

CHECKED = (1, 2, 3, 4, 5, 6, 7, 8, 10, 11, 13, 14, 15)
GRACE = 1e-6


class Watched(Protocol):
    """What the laws look at: a reactor."""

    scheduler: Scheduler
    executer: Executer
    situations: Situations
    transactions: Transactions
    perceptions: PerceptionChannel
    journal: Journal
    readings: Readings
    reactions: Reactions

    @property
    def failed(self) -> Mapping[str, float]: ...

    @property
    def counts(self) -> Mapping[str, int]: ...

    def lifetime(self, label: int | None) -> Lifetime | None: ...

    def is_live_owner(self, owner: Hashable) -> bool: ...

    def resting_on(self, assumption: str) -> tuple[str, ...]: ...

    def over_budget(self) -> str | None: ...

    def commands(self) -> int: ...

    @property
    def restoring(self) -> bool: ...

    @property
    def halted(self) -> bool: ...


class Violation(msgspec.Struct, frozen=True):
    """A law that was broken, when (seconds), and how."""

    law: int
    time: float
    message: str

    def __str__(self) -> str:
        return f"law {self.law} at {self.time:.3f} s: {self.message}"


class Laws:
    """Watches one reactor. `violations` holds every breach, in order."""

    def __init__(self, reactor: Watched) -> None:
        self._reactor = reactor
        self.violations: list[Violation] = []
        self.ledgers: list[Callable[[], str]] = []  # further ledgers: "" or what does not balance
        self.interruptions = 0
        self._disabled_since: dict[str, float] = {}
        self._retired: dict[int, tuple[str, int, tuple[str, ...]]] = {}  # label → what it serves still, and on what
        self.frozen = 0  # bodies that a FREEZE stopped, on demand
        self._applied: set[int] = set()  # ids above `_all_applied`, of the present epoch
        self._all_applied = 0
        self._unequal: set[int] = set()  # labels that run and are not in the journal, or the reverse
        self._written: Mapping[int, str] = {}
        self._added: set[int] = set()  # labels that came to life and whose adaptation has not been looked at yet
        self._promised: list[Transaction] = []  # applied in this step: what they add must be there at its end
        self._seen: dict[int, list[Lifetime]] = {}  # instance → of the reactions that served it
        self._asserted = self._ended = 0
        self._perceived = 0
        self._epoch = 0
        self._broken: set[tuple[int, str]] = set()

    def breach(self, law: int, message: str) -> None:
        """Record a breach, once for each message as long as it lasts."""
        if (law, message) not in self._broken:
            self._broken.add((law, message))
            self.violations.append(Violation(law, self._reactor.scheduler.now, message))

    # -- what has happened (`WATCHES`)

    def _asserts(self, fields: dict[str, Any]) -> None:
        """Law 4, bounded: what is drained gets nothing new, or it need never end."""
        self._asserted += 1
        if self._reactor.situations.named(fields["situation"]).drains:
            self.breach(4, f"instance {fields['instance']} of {fields['situation']} begins, which is drained")

    def _adds(self, fields: dict[str, Any]) -> None:
        self._added.add(fields["label"])

    def _queues(self, fields: dict[str, Any]) -> None:
        """Law 5: what waits is held back by somebody, who will let it go."""
        if not self._reactor.situations.named(fields["situation"]).blocked:
            self.breach(5, f"{fields['situation']} is asserted and waits, and nothing holds it back")

    def _completes(self, fields: dict[str, Any]) -> None:
        self._ended += 1
        self._seen.pop(fields["instance"], None)

    def _enters(self, fields: dict[str, Any]) -> None:
        """Law 3, consistent: an instance sees one version."""
        instance, life = fields["instance"], self._reactor.lifetime(fields["guard"])
        lives = self._seen.setdefault(instance, [])
        if life is not None and life not in lives:
            lives.append(life)
            if max(seen.first for seen in lives) > min(seen.last for seen in lives):
                self.breach(3, f"instance {instance} of {fields['situation']} saw two versions: {lives}")

    def _leaves(self, fields: dict[str, Any]) -> None:
        """Law 2, safe: no reaction in service is interrupted."""
        if fields["cut"] and not self._reactor.halted:
            self.interruptions += 1
            self.breach(2, f"a body of instance {fields['instance']} of {fields['situation']} was cut off")

    def _holds(self, fields: dict[str, Any]) -> None:
        if fields["because"] == "assumption":
            self._disabled_since.setdefault(fields["situation"], self._reactor.scheduler.now)

    def _retires(self, fields: dict[str, Any]) -> None:
        """Law 14: what a retired reaction may still serve, and what it rests on."""
        for transaction in self._reactor.transactions.under_way:
            for reaction in transaction.killed:
                if reaction.label == fields["label"] and (name := reaction.situation) is not None:
                    newest = self._reactor.situations.versions.newest(name)
                    self._retired[reaction.label] = name, newest, transaction.before.rests_on.get(name, ())

    def _removes(self, fields: dict[str, Any]) -> None:
        self._retired.pop(fields["label"], None)

    def _freezes(self, fields: dict[str, Any]) -> None:
        """Law 2: what stops a body in service is an explicit FREEZE, and it holds the situation meanwhile."""
        self.frozen += 1
        if not self._reactor.situations.named(fields["situation"]).inhibitions:
            self.breach(2, f"a body of {fields['situation']} was frozen, and nothing holds the situation")

    def applied(self, transaction: Transaction) -> None:
        """Laws 1, 4, 6, 7 and 8 of a transaction that has just ended well."""
        adaptation, versions = transaction.adaptation, transaction.before.versions
        self._in_time(transaction, self._reactor.scheduler.now)
        if not self._reactor.halted:  # what a halt cut short comes to life with the reset
            self._half(transaction)
            self._promised.append(transaction)
            if left := [label for label in adaptation.kills if label not in transaction.kills]:
                self.breach(1, f"adaptation {adaptation.id} was applied without killing {left}")
        if adaptation.epoch < self._epoch:
            self.breach(7, f"epoch {adaptation.epoch} after {self._epoch}")
        self._once(adaptation.epoch, adaptation.id)
        for change in adaptation.changes:
            if change.base != (version := versions.get(change.situation, 0)):
                self.breach(7, f"{change.situation} was at version {version}, not at {change.base}")
        if adaptation.id not in self._reactor.journal.state.committed.taken:
            self.breach(8, f"adaptation {adaptation.id} was applied and is not in the journal")

    def _once(self, epoch: int, number: int) -> None:
        """Law 6: an id is applied at most once. Each planner numbers from 1: few ids have to be remembered."""
        if epoch != self._epoch:
            self._epoch, self._all_applied = epoch, 0
            self._applied.clear()
        if number in self._applied or 0 < number <= self._all_applied:
            self.breach(6, f"adaptation {number} was applied twice")
        self._applied.add(number)
        while self._all_applied + 1 in self._applied:
            self._all_applied += 1
            self._applied.remove(self._all_applied)

    # -- how things stand

    def check(self) -> None:
        """Ask every law about the present state: cheap enough to be asked after each event.

        What a law says is looked at here; its method finds the words for a breach.
        """
        reactor = self._reactor
        under_way, situations = reactor.transactions.under_way, reactor.situations
        if self._promised:
            self._kept_promises()
        if under_way:
            self._atomic(under_way)
        if situations.held_by:
            self._owned()
        self._durable(under_way)
        channel = reactor.perceptions
        if channel.sent != channel.taken + len(channel):
            self._perceptions()
        if self._asserted != self._ended + len(situations.instances):
            self._instances()
        counts = reactor.counts
        if counts["received"] != counts["applied"] + counts["refused"] + counts["timed_out"] + len(under_way):
            self.breach(11, f"adaptations: {counts}")
        if self.ledgers:
            self._balanced()
        if (problem := reactor.over_budget()) is not None:  # law 13: instances and processes stay within their budgets
            self.breach(13, problem)
        if self._disabled_since or self._retired or reactor.failed:
            self._disabled()
        if reactor.readings.failing:
            self._disbelieved()
        if reactor.journal.state.committed.halted:
            self._halted()

    def _kept_promises(self) -> None:
        """Law 1: of an adaptation that was applied everything is there."""
        for transaction in self._promised:
            adds = set(transaction.adaptation.adds)
            if missing := sorted(adds - self._added):
                self.breach(1, f"adaptation {transaction.adaptation.id} was applied without adding {missing}")
            self._added -= adds
        self._promised.clear()

    def _atomic(self, under_way: tuple[Transaction, ...]) -> None:
        """Law 1: of an adaptation everything is there or nothing; what goes, goes first. Law 4: it is within its bound.

        A loop that was held up takes back what is late as it goes on.
        """
        now, attended = self._reactor.scheduler.now, self._reactor.scheduler.attended
        for transaction in under_way:
            if now > transaction.surgery + GRACE:
                self._half(transaction)
            if transaction.adds and len(transaction.kills) < len(transaction.adaptation.kills):
                self.breach(1, f"adaptation {transaction.adaptation.id} added reactions beside those that it removes")
            if attended > transaction.received + transaction.limit + GRACE:
                self._in_time(transaction, attended)

    def _half(self, transaction: Transaction) -> None:
        if self._reactor.scheduler.now > transaction.surgery + GRACE:
            self.breach(1, f"adaptation {transaction.adaptation.id} was half applied for some time")

    def _in_time(self, transaction: Transaction, now: float) -> None:
        """Law 4: an adaptation is applied, or taken back, within its bound."""
        if now > transaction.received + transaction.limit + GRACE:
            self.breach(4, f"adaptation {transaction.adaptation.id} exceeds its bound of {transaction.limit} s")

    def _owned(self) -> None:
        """Law 5: every inhibition has exactly one live owner."""
        alive: Hashable = None  # mostly one owns them all
        for situation in self._reactor.situations.held:
            for inhibition in situation.inhibitions:
                if inhibition.owner is alive:
                    continue
                if self._reactor.is_live_owner(inhibition.owner):
                    alive = inhibition.owner
                else:
                    self.breach(5, f"{situation.name} is inhibited by {named(inhibition.owner)}, which is gone")

    def _durable(self, under_way: tuple[Transaction, ...]) -> None:
        """Law 8: what runs is what the journal says, once no change is half-way."""
        for transaction in under_way:
            if transaction.state == "committed":
                return
        running, written = self._reactor.reactions, self._reactor.journal.state.committed.clauses
        concerned = running.touched()
        if written is not self._written:
            concerned |= self._rewritten(written)
        if not (concerned or self._unequal):
            return
        self._unequal = {label for label in self._unequal | concerned if (label in running) != (label in written)}
        if self._unequal and not self._reactor.restoring and not self._reactor.halted:
            self.breach(8, f"reactions {sorted(self._unequal)} run and are not in the journal, or the reverse")

    def _rewritten(self, written: Mapping[int, str]) -> set[int]:
        """The labels under which the journal may say something else than when this was asked last."""
        seen, self._written = self._written, written
        changed = seen.keys_changed_until(written) if isinstance(seen, Persistent) else None
        return {*seen, *written} if changed is None else changed

    def _perceptions(self) -> None:
        """Law 10: numbered without gaps, at least once."""
        channel = self._reactor.perceptions
        if channel.sent != channel.taken + len(channel):
            self.breach(10, f"{channel.sent} perceptions sent, {channel.taken} taken, {len(channel)} waiting")

    def _instances(self) -> None:
        """Law 11: what was asserted has ended, or is alive."""
        live = len(self._reactor.situations.instances)
        self.breach(11, f"instances: {self._asserted} asserted, {self._ended} ended, {live} live")

    def _balanced(self) -> None:
        """Law 11: all further ledgers balance."""
        for ledger in self.ledgers:
            if problem := ledger():
                self.breach(11, problem)

    def _disabled(self) -> None:
        """Law 14: what rests on a failed assumption is disabled."""
        for assumption in self._reactor.failed:
            for situation in self._reactor.resting_on(assumption):
                if not self._reactor.situations.is_disabled(situation, assumption):
                    self.breach(14, f"{situation} rests on {assumption}, which has failed, and is not disabled")
        for situation, since in list(self._disabled_since.items()):
            if self._reactor.situations.disabled_by(situation) is None:
                del self._disabled_since[situation]
            elif self._reactor.scheduler.now > since + GRACE and self._reactor.situations.awaited(situation):
                self.breach(14, f"{situation} is disabled, and its default reaction has not begun")
        for name, newest, assumptions in self._retired.values():
            if not self._reactor.failed.keys().isdisjoint(assumptions):
                for instance in self._reactor.situations.named(name).instances.values():
                    if instance.version <= newest and not instance.gone:
                        self.breach(14, f"instance {instance.number} of {name} is of an old version that rests on a "
                                        "failed assumption, and is not given up")  # fmt: skip

    def _disbelieved(self) -> None:
        """Law 14: what its sensor says to fail, as often as it takes, counts as failed."""
        for assumption in self._reactor.readings.disbelieved():
            self.breach(14, f"{assumption} was read to fail as often as it takes, and counts as holding")

    def _halted(self) -> None:
        """Law 15: after HALT no basic process runs and no situation is on, until a reset."""
        if running := self._reactor.commands():
            self.breach(15, f"{running} basic processes run though the reactor is halted")
        if not self._reactor.executer.killing and (on := self._reactor.situations.instances):
            self.breach(15, f"instances {sorted(on)} are on though the reactor is halted")


WATCHES: dict[str, Callable[[Laws, dict[str, Any]], None]] = {
    "added": Laws._adds,
    "asserted": Laws._asserts,
    "completed": Laws._completes,
    "entered": Laws._enters,
    "frozen": Laws._freezes,
    "inhibited": Laws._holds,
    "left": Laws._leaves,
    "queued": Laws._queues,
    "removed": Laws._removes,
    "retired": Laws._retires,
}
"""Which law looks at which notice of the reactor, with its fields."""
