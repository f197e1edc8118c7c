"""Safe adaptation as a transaction (R §5.5, docs/reactor.md).

An adaptation becomes a process in RS that runs beside the reactor, with a root of its own that owns what it inhibits:

    drain      DRAIN[top] : … : COMMIT[id] : KILL[old] : … : POST[new] : … : UNINHIBIT[top]
    wait       the same, with WAITINHIBIT in place of DRAIN
    versions   COMMIT[id] : RETIRE[old] : … : RENEW[s] : … : POST[new] : …        and then, apart, what was retired goes

top-down for what goes, bottom-up for what comes. COMMIT makes it durable. Every KILL is known beforehand to be legal
once the drains have ended, so nothing waits after COMMIT: up to there the whole can still be taken back (its deadline
has passed, the disk is full), from there on it is applied within the instant.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial
from math import inf, isinf
from typing import Literal

from msgspec.structs import replace

from planner_reactor.errors import DiskError, RefusedError
from planner_reactor.link.messages import Adaptation
from planner_reactor.link.surgeries import drained, surgery
from planner_reactor.reactor.committed import Committed, remember
from planner_reactor.reactor.contention import refuse_contention
from planner_reactor.reactor.journal import Begun, Decided, Journal
from planner_reactor.reactor.preparing import Prepared
from planner_reactor.reactor.reactions import Reactions
from planner_reactor.reactor.waiting import refuse_waiting_for_itself
from planner_reactor.rs.reactions import (
    Reaction,
    drain_script,
    removal_script,
    rests_when_drained,
    versions_script,
    wait_script,
)
from planner_reactor.rs.terms import Process, Value
from planner_reactor.runtime import Executer, Root, Scheduler, Timer

ROUNDING = 1e-6
"""Seconds by which the clock may be past a deadline that is met: sums are rounded."""

LONGEST = 600.0
"""Seconds after which an adaptation whose bound cannot be computed is given up."""

State = Literal["draining", "committed", "applied", "refused", "timed_out"]


@dataclass(slots=True, eq=False)
class Transaction:
    """One admitted adaptation: its new reactions, its script, and how it goes."""

    adaptation: Adaptation
    reactions: tuple[Reaction, ...]
    killed: tuple[Reaction, ...]
    before: Committed  # the structure that it changes
    received: float
    bound: float
    needed: int  # processes, as its reactions come to life
    limit: float = LONGEST
    state: State = "draining"
    root: Root | None = None
    timer: Timer | None = None
    surgery: float = inf  # when it was committed, or the first reaction was removed or added
    kills: list[int] = field(default_factory=list)  # done
    adds: list[int] = field(default_factory=list)  # done
    reason: str = ""  # why it came to nothing, if its deadline is not why: a word
    problem: str = ""  # and a sentence

    @property
    def deadline(self) -> float:
        """The instant, seconds, after which nothing of it is committed any more."""
        return self.received + self.limit

    @property
    def situations(self) -> tuple[str, ...]:
        """Every situation that it changes or removes, top-down."""
        changed = tuple(change.situation for change in self.adaptation.changes)
        return (*changed, *(s for s in self.adaptation.removed if s not in changed))


def script(adaptation: Adaptation, killed: tuple[Reaction, ...]) -> Process:
    """The adaptation as a process, in its mode."""
    plan = replace(surgery(adaptation), number=adaptation.id)
    match adaptation.mode:
        case "drain":
            return drain_script(plan)
        case "wait":
            return wait_script(plan)
        case "versions":
            return versions_script(plan, killed)


class Transactions:
    """The adaptations under way. `finished` is called with each as it is applied or given up."""

    def __init__(
        self, executer: Executer, scheduler: Scheduler, journal: Journal, finished: Callable[[Transaction], None]
    ) -> None:
        self._executer = executer
        self._scheduler = scheduler
        self._journal = journal
        self._finished = finished
        self._by_root: dict[Root, Transaction] = {}
        self.under_way: tuple[Transaction, ...] = ()
        self._removals: deque[Transaction] = deque()
        self._removing: tuple[Root, Transaction] | None = None

    @property
    def pending_situations(self) -> frozenset[str]:
        return frozenset(s for t in self.under_way for s in t.situations)

    def staying(self, epoch: int) -> tuple[Transaction, ...]:
        """What is under way, and would not be revoked by an adaptation of this epoch."""
        return tuple([t for t in self.under_way if t.adaptation.epoch >= epoch or t.state != "draining"])

    def examine(
        self,
        prepared: Prepared,
        killed: tuple[Reaction, ...],
        present: Reactions,
        disabled: Callable[[str], object],
    ) -> None:
        """Could it stop half-way, be in the way of another, or wait for itself? `RefusedError` if so."""
        adaptation = prepared.adaptation
        refuse_unsafe_kills(adaptation, killed)
        if staying := self.staying(adaptation.epoch):
            going = {reaction.label for transaction in staying for reaction in transaction.killed}
            coming = [reaction for transaction in staying for reaction in transaction.reactions]
            refuse_contention(tuple(prepared.reactions.values()), killed, present, coming, going)
        under_way = [transaction.adaptation for transaction in self.under_way]
        refuse_waiting_for_itself(adaptation, present, under_way, self.retired, disabled)

    @property
    def retired(self) -> list[Reaction]:
        """The reactions that were retired, and may not have gone yet."""
        removing = () if self._removing is None else (self._removing[1],)
        return [reaction for t in (*removing, *self._removals) for reaction in t.killed]

    def begin(self, prepared: Prepared, killed: tuple[Reaction, ...], bound: float) -> Transaction:
        """Load the definitions and start the script; it is applied, or taken back, from here on by itself.

        `RefusedError` (reason disk) if the journal cannot take it.
        """
        adaptation, now = prepared.adaptation, self._scheduler.now
        before = self._journal.state.committed
        remember(adaptation.definitions, prepared.clauses)
        try:
            self._journal.write(Begun(adaptation, now), sync=False)
        except DiskError as problem:
            raise RefusedError("disk", f"it cannot be made durable: {problem}") from problem
        reactions = tuple([prepared.reactions[label] for label in adaptation.adds])
        transaction = Transaction(adaptation, reactions, killed, before, now, bound, prepared.needed)
        deadline = adaptation.deadline if adaptation.deadline is not None else bound
        self._executer.load(prepared.compiled)
        transaction.limit = LONGEST if isinf(deadline) else deadline
        transaction.timer = self._scheduler.call_after(transaction.limit, lambda: self._expire(transaction))
        transaction.root = self._executer.start_process(
            script(adaptation, killed), name=f"adaptation {adaptation.id}"
        )
        self._by_root[transaction.root] = transaction
        self.under_way = tuple(self._by_root.values())
        return transaction

    def commit(self, number: int) -> Transaction | None:
        """COMMIT[number]: the journal says that it is applied, before anything of it is.

        None if it cannot, or if its bound has passed: a loop that was held up comes here before the timer is told.
        """
        for transaction in self.under_way:
            if transaction.adaptation.id == number and transaction.state == "draining" and not transaction.reason:
                if self._scheduler.now > transaction.deadline + ROUNDING:
                    return None
                if (needed := transaction.needed) > self._executer.room:
                    transaction.reason = "budget"
                    transaction.problem = f"it may need {needed} processes, there is room for {self._executer.room}"
                    return None
                try:
                    epoch = transaction.adaptation.epoch
                    self._journal.write(Decided(number, "applied", self._scheduler.now, epoch))
                except DiskError as problem:
                    transaction.reason = "disk"
                    transaction.problem = f"it cannot be made durable: {problem}"
                    return None
                transaction.state, transaction.surgery = "committed", self._scheduler.now
                return transaction
        return None

    def changed(self, label: int, *, added: bool) -> bool:
        """A reaction was added, removed or retired: was it one of the scripts that did it?"""
        for transaction in self._by_root.values():
            if transaction.reason:  # it is being taken back, and does nothing
                continue
            wanted = transaction.adaptation.adds if added else transaction.adaptation.kills
            if label in wanted:
                transaction.surgery = min(transaction.surgery, self._scheduler.now)
                (transaction.adds if added else transaction.kills).append(label)
                return True
        return False

    def left(self, label: Value) -> None:
        """A reaction ends by itself: who is to kill it would find nothing to kill, and is taken back before that."""
        for transaction in self._by_root.values():
            if label in transaction.adaptation.kills and transaction.state == "draining" and not transaction.reason:
                transaction.reason = "labels"
                transaction.problem = f"P[{label}], which it kills, has ended by itself meanwhile"
                self._executer.after_step(partial(self._expire, transaction))

    def ended(self, root: Root) -> None:
        """A root of the executer has ended: if it was a script, its transaction is over."""
        transaction = self._by_root.get(root)
        if transaction is not None:
            # what the last POST adds comes to life within this step: it is over when the step is
            self._executer.after_step(lambda: self._close(root, transaction))
        elif self._removing is not None and root is self._removing[0]:
            self._removing = None
            self._executer.after_step(self._remove)

    def _close(self, root: Root, transaction: Transaction) -> None:
        del self._by_root[root]
        self.under_way = tuple(self._by_root.values())
        if transaction.timer is not None:
            transaction.timer.cancel()
        if root.outcome == "stop" or transaction.state == "committed":
            transaction.state = "applied"  # so the journal says: what a halt cut short comes to life with the reset
            if transaction.adaptation.mode == "versions" and root.outcome == "stop":
                self._removals.append(transaction)
                self._remove()
        else:
            transaction.state = "refused" if transaction.reason else "timed_out"
            adaptation, now = transaction.adaptation, self._scheduler.now
            self._journal.note(Decided(adaptation.id, transaction.state, now, adaptation.epoch))
            self._executer.unload([r.schema for r in transaction.reactions])
        self._finished(transaction)

    def _expire(self, transaction: Transaction) -> None:
        """Its bound has passed: the drains are let go, nothing has changed."""
        if transaction.root is not None and transaction.root.outcome is None and transaction.state == "draining":
            self._executer.kill(transaction.root)

    def revoke(self, epoch: int) -> None:
        """Planners before this epoch have no say any more: what of theirs still drains is taken back."""
        for transaction in self.under_way:
            if transaction.adaptation.epoch < epoch and transaction.state == "draining":
                transaction.reason, transaction.problem = "epoch", f"a planner of epoch {epoch} has taken over"
                self._expire(transaction)

    def halt(self) -> None:
        """The stop button: what is under way comes to nothing, and nothing is removed any more."""
        for transaction in self.under_way:
            transaction.reason, transaction.problem = "halted", "the reactor was halted"
        self._removals.clear()

    def _remove(self) -> None:
        """What was retired goes in the order of the adaptations: an older parent may still assert what is removed."""
        if self._removing is None and self._removals:
            transaction = self._removals.popleft()
            removal = removal_script(surgery(transaction.adaptation), transaction.killed)
            root = self._executer.start_process(removal, name=f"removal {transaction.adaptation.id}")
            self._removing = root, transaction


def refuse_unsafe_kills(adaptation: Adaptation, killed: tuple[Reaction, ...]) -> None:
    """Every reaction killed must be at rest once the drains have ended, or the transaction could stop half-way."""
    held = set(drained(adaptation))
    for reaction in killed:
        if reaction.situation is not None:
            if reaction.situation not in held:
                raise RefusedError("structure", f"P[{reaction.label}] is killed, {reaction.situation} is not drained")
        elif not reaction.monitors and adaptation.mode != "drain":
            why = "it has no versions" if adaptation.mode == "versions" else "it may assert again before it is killed"
            raise RefusedError(
                "structure", f"P[{reaction.label}] serves no situation: {why}, expected mode drain"
            )
        elif not reaction.monitors and not (reaction.asserts and held.issuperset(reaction.asserts)):
            raise RefusedError(
                "structure", f"P[{reaction.label}] is no monitor and asserts more than is drained: it may be at work"
            )
        elif not reaction.monitors and not rests_when_drained(reaction.schema.body):
            raise RefusedError(
                "structure", f"P[{reaction.label}] does more in its body than assert: it may be at work"
            )
