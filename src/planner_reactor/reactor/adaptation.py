"""Safe adaptation as a transaction (R §5.5, docs/reactor.md).

An adaptation becomes a process in RS that runs beside the reactor, with a root of its own that owns what it inhibits:

    DRAIN[top] : … : KILL[old] : … : POST[new] : … : UNINHIBIT[top]

top-down for what goes, bottom-up for what comes. Every KILL is known beforehand to be legal once the drains have ended,
so nothing waits after the first change: up to there the whole can still be taken back (its deadline passed), from there
on it is applied within the instant.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from math import isinf
from typing import Literal

from planner_reactor.errors import RefusedError
from planner_reactor.link.messages import Adaptation
from planner_reactor.link.surgeries import drained, surgery
from planner_reactor.rs.reactions import Reaction, drain_script
from planner_reactor.rs.terms import Process
from planner_reactor.runtime import Executer, Root, Scheduler, Timer

LONGEST = 600.0
"""Seconds after which an adaptation whose bound cannot be computed is given up."""

State = Literal["draining", "applied", "timed_out"]


@dataclass(slots=True, eq=False)
class Transaction:
    """One admitted adaptation: its new reactions, its script, and how it goes."""

    adaptation: Adaptation
    reactions: tuple[Reaction, ...]
    received: float
    bound: float
    limit: float = LONGEST
    state: State = "draining"
    root: Root | None = None
    timer: Timer | None = None
    surgery: float = 0.0  # when the first reaction was removed or added
    kills: list[int] = field(default_factory=list)  # done
    adds: list[int] = field(default_factory=list)  # done

    @property
    def situations(self) -> tuple[str, ...]:
        """Every situation that it changes or removes, top-down."""
        changed = tuple(change.situation for change in self.adaptation.changes)
        return (*changed, *(s for s in self.adaptation.removed if s not in changed))


def script(adaptation: Adaptation) -> Process:
    """The adaptation as a process (mode `drain`)."""
    return drain_script(surgery(adaptation))


class Transactions:
    """The adaptations under way. `finished` is called with each as it is applied or given up."""

    def __init__(self, executer: Executer, scheduler: Scheduler, finished: Callable[[Transaction], None]) -> None:
        self._executer = executer
        self._scheduler = scheduler
        self._finished = finished
        self._by_root: dict[Root, Transaction] = {}
        self.seen: set[int] = set()
        self.epoch = 0

    @property
    def under_way(self) -> tuple[Transaction, ...]:
        return tuple(self._by_root.values())

    @property
    def pending_situations(self) -> frozenset[str]:
        return frozenset(s for t in self.under_way for s in t.situations)

    def begin(self, adaptation: Adaptation, reactions: tuple[Reaction, ...], bound: float) -> Transaction:
        """Load the definitions and start the script; it is applied, or taken back, from here on by itself."""
        deadline = adaptation.deadline if adaptation.deadline is not None else bound
        transaction = Transaction(adaptation, reactions, self._scheduler.now, bound)
        self.seen.add(adaptation.id)
        self.epoch = adaptation.epoch
        self._executer.load([r.schema for r in reactions])
        transaction.limit = LONGEST if isinf(deadline) else deadline
        transaction.timer = self._scheduler.call_after(transaction.limit, lambda: self._expire(transaction))
        transaction.root = self._executer.start_process(script(adaptation), name=f"adaptation {adaptation.id}")
        self._by_root[transaction.root] = transaction
        return transaction

    def changed(self, label: int, *, added: bool) -> bool:
        """A reaction was added or removed: was it one of the scripts that did it?"""
        for transaction in self._by_root.values():
            wanted = transaction.adaptation.adds if added else transaction.adaptation.kills
            if label in wanted:
                if not (transaction.kills or transaction.adds):
                    transaction.surgery = self._scheduler.now
                (transaction.adds if added else transaction.kills).append(label)
                return True
        return False

    def ended(self, root: Root) -> None:
        """A root of the executer has ended: if it was a script, its transaction is over."""
        transaction = self._by_root.get(root)
        if transaction is not None:
            # what the last POST adds comes to life within this step: it is over when the step is
            self._executer.after_step(lambda: self._close(root, transaction))

    def _close(self, root: Root, transaction: Transaction) -> None:
        del self._by_root[root]
        if transaction.timer is not None:
            transaction.timer.cancel()
        transaction.state = "applied" if root.outcome == "stop" else "timed_out"
        if transaction.state == "timed_out":
            self._executer.unload([r.schema for r in transaction.reactions])
        self._finished(transaction)

    def _expire(self, transaction: Transaction) -> None:
        """Its bound has passed: the drains are let go, nothing has changed."""
        if transaction.root is not None and transaction.root.outcome is None and not transaction.kills:
            self._executer.kill(transaction.root)


def refuse_unsafe_kills(adaptation: Adaptation, killed: tuple[Reaction, ...]) -> None:
    """Every reaction killed must be at rest once the drains have ended, or the transaction could stop half-way."""
    held = set(drained(adaptation))
    for reaction in killed:
        if reaction.situation is not None:
            if reaction.situation not in held:
                raise RefusedError("structure", f"P[{reaction.label}] is killed, {reaction.situation} is not drained")
        elif not reaction.monitors and not (reaction.asserts and held.issuperset(reaction.asserts)):
            raise RefusedError(
                "structure", f"P[{reaction.label}] is no monitor and asserts more than is drained: it may be at work"
            )
