"""The reactor's laws, asked after every event (docs/reactor.md, "The reactor's laws").

Each law is a method that looks at the reactor as it stands, or at what has just happened, and gives a sentence for
every breach. They use nothing that the reactor uses to keep them: counts are kept apart. Laws 1 to 7, 10, 11, 13 and
14 are asked here; 16 (same seed, same trace) is a claim about two runs.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Mapping
from typing import Any, Protocol

import msgspec

from planner_reactor.link.channels import PerceptionChannel
from planner_reactor.reactor.adaptation import Transaction, Transactions
from planner_reactor.reactor.situations import Situations, named
from planner_reactor.runtime import Scheduler

CHECKED = (1, 2, 3, 4, 5, 6, 7, 10, 11, 13, 14)
GRACE = 1e-6


class Watched(Protocol):
    """What the laws look at: a reactor."""

    scheduler: Scheduler
    situations: Situations
    transactions: Transactions
    perceptions: PerceptionChannel
    failed: dict[str, float]

    @property
    def counts(self) -> Mapping[str, int]: ...

    def version_of_label(self, label: int | None) -> int: ...

    def is_live_owner(self, owner: Hashable) -> bool: ...

    def resting_on(self, assumption: str) -> tuple[str, ...]: ...

    def over_budget(self) -> str | None: ...


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
        self._applied: set[int] = set()
        self._added: set[int] = set()  # labels that came to life and whose adaptation has not been looked at yet
        self._promised: list[Transaction] = []  # applied in this step: what they add must be there at its end
        self._served_by: dict[int, int] = {}  # instance → version that served it
        self._asserted = self._ended = 0
        self._perceived = 0
        self._epoch = 0
        self._broken: set[tuple[int, str]] = set()

    def breach(self, law: int, message: str) -> None:
        """Record a breach, once for each message as long as it lasts."""
        if (law, message) not in self._broken:
            self._broken.add((law, message))
            self.violations.append(Violation(law, self._reactor.scheduler.now, message))

    # -- what has happened

    def happened(self, kind: str, fields: dict[str, Any]) -> None:
        """One notice of the reactor."""
        watch = _WATCHES.get(kind)
        if watch is not None:
            watch(self, fields)

    def _asserts(self, fields: dict[str, Any]) -> None:
        self._asserted += 1

    def _adds(self, fields: dict[str, Any]) -> None:
        self._added.add(fields["label"])

    def _completes(self, fields: dict[str, Any]) -> None:
        self._ended += 1
        self._served_by.pop(fields["instance"], None)

    def _enters(self, fields: dict[str, Any]) -> None:
        """Law 3, consistent: an instance sees one version."""
        version = self._reactor.version_of_label(fields["guard"])
        first = self._served_by.setdefault(fields["instance"], version)
        if version != first:
            self.breach(
                3, f"instance {fields['instance']} of {fields['situation']} saw versions {first} and {version}"
            )

    def _leaves(self, fields: dict[str, Any]) -> None:
        """Law 2, safe: no reaction in service is interrupted."""
        if fields["cut"]:
            self.interruptions += 1
            self.breach(2, f"a body of instance {fields['instance']} of {fields['situation']} was cut off")

    def applied(self, transaction: Transaction, versions: dict[str, int]) -> None:
        """Laws 1, 4, 6 and 7 of a transaction that has just ended well; `versions` are those before it."""
        adaptation = transaction.adaptation
        self._late(transaction)
        self._half(transaction)
        self._promised.append(transaction)
        if left := [label for label in adaptation.kills if label not in transaction.kills]:
            self.breach(1, f"adaptation {adaptation.id} was applied without killing {left}")
        if adaptation.id in self._applied:
            self.breach(6, f"adaptation {adaptation.id} was applied twice")
        self._applied.add(adaptation.id)
        if adaptation.epoch < self._epoch:
            self.breach(7, f"epoch {adaptation.epoch} after {self._epoch}")
        self._epoch = adaptation.epoch
        for change in adaptation.changes:
            if change.base != versions[change.situation]:
                self.breach(
                    7, f"{change.situation} was at version {versions[change.situation]}, not at {change.base}"
                )

    # -- how things stand

    def check(self) -> None:
        """Ask every law about the present state: cheap enough to be asked after each event."""
        self._atomic()
        self._bounded()
        self._owned()
        self._perceptions()
        self._balanced()
        self._finite()
        self._disabled()

    def _atomic(self) -> None:
        """Law 1: of an adaptation everything is there or nothing; what goes, goes first."""
        for transaction in self._promised:
            adds = set(transaction.adaptation.adds)
            if missing := sorted(adds - self._added):
                self.breach(1, f"adaptation {transaction.adaptation.id} was applied without adding {missing}")
            self._added -= adds
        self._promised.clear()
        for transaction in self._reactor.transactions.under_way:
            self._half(transaction)
            if transaction.adds and len(transaction.kills) < len(transaction.adaptation.kills):
                self.breach(1, f"adaptation {transaction.adaptation.id} added reactions beside those that it removes")

    def _half(self, transaction: Transaction) -> None:
        begun = transaction.kills or transaction.adds
        if begun and self._reactor.scheduler.now > transaction.surgery + GRACE:
            self.breach(1, f"adaptation {transaction.adaptation.id} was half applied for some time")

    def _bounded(self) -> None:
        """Law 4: an adaptation under way is within its bound."""
        for transaction in self._reactor.transactions.under_way:
            self._late(transaction)

    def _late(self, transaction: Transaction) -> None:
        if self._reactor.scheduler.now > transaction.received + transaction.limit + GRACE:
            self.breach(4, f"adaptation {transaction.adaptation.id} exceeds its bound of {transaction.limit} s")

    def _owned(self) -> None:
        """Law 5: every inhibition has exactly one live owner."""
        for situation in self._reactor.situations.held:
            for inhibition in situation.inhibitions:
                if not self._reactor.is_live_owner(inhibition.owner):
                    self.breach(5, f"{situation.name} is inhibited by {named(inhibition.owner)}, which is gone")

    def _perceptions(self) -> None:
        """Law 10: numbered without gaps, at least once."""
        channel = self._reactor.perceptions
        if channel.sent != channel.taken + len(channel):
            self.breach(10, f"{channel.sent} perceptions sent, {channel.taken} taken, {len(channel)} waiting")

    def _balanced(self) -> None:
        """Law 11: all ledgers balance."""
        live = len(self._reactor.situations.instances)
        if self._asserted != self._ended + live:
            self.breach(11, f"instances: {self._asserted} asserted, {self._ended} ended, {live} live")
        counts = self._reactor.counts
        settled = counts["applied"] + counts["refused"] + counts["timed_out"]
        if counts["received"] != settled + len(self._reactor.transactions.under_way):
            self.breach(11, f"adaptations: {counts}")
        for ledger in self.ledgers:
            if problem := ledger():
                self.breach(11, problem)

    def _finite(self) -> None:
        """Law 13: instances and processes stay within their budgets."""
        if (problem := self._reactor.over_budget()) is not None:
            self.breach(13, problem)

    def _disabled(self) -> None:
        """Law 14: what rests on a failed assumption is disabled."""
        for assumption in self._reactor.failed:
            for situation in self._reactor.resting_on(assumption):
                if not self._reactor.situations.is_disabled(situation, assumption):
                    self.breach(14, f"{situation} rests on {assumption}, which has failed, and is not disabled")


_WATCHES: dict[str, Callable[[Laws, dict[str, Any]], None]] = {
    "added": Laws._adds,
    "asserted": Laws._asserts,
    "completed": Laws._completes,
    "entered": Laws._enters,
    "left": Laws._leaves,
}
