"""How a reactor begins, is stopped, and begins again (R §5.3; laws 8 and 15; docs/reactor.md, "The journal", "Halt").

It begins on what its journal says. The stop button aborts everything, and only an explicit reset releases it: neither a
crash nor the reactor itself does.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from planner_reactor.reactor.journal import Halted, Recovery, Started, State
from planner_reactor.reactor.recovery import restore
from planner_reactor.rs.terms import Call, Program
from planner_reactor.runtime import Root

if TYPE_CHECKING:
    from planner_reactor.reactor.reactor import Reactor

AT_REST = Call("NIL")


class Life:
    """The root that a reactor is, and the one that brings its committed structure back."""

    def __init__(self, reactor: Reactor, equation: Program) -> None:
        self._reactor = reactor
        self._equation = equation
        self._restoration: Root | None = None

    @property
    def halted(self) -> bool:
        """Was the stop button pressed, and not yet released?"""
        return self._reactor.journal.state.committed.halted

    @property
    def restoring(self) -> bool:
        """Is what the journal says still coming to life?"""
        return self._restoration is not None and self._restoration.outcome is None

    def start(self) -> Root:
        """Begin to act, on what the journal says."""
        reactor = self._reactor
        recovery = reactor.journal.recover()
        fresh = reactor.journal.state == State()
        reactor.journal.write(Started(reactor.scheduler.now))
        if self.halted:
            reactor.assumptions.restored()  # what is noticed meanwhile bears on what is known
            return reactor.executer.start_process(AT_REST, name="halted")
        return self._begun(None if fresh else recovery)

    def halt(self) -> Root:
        """Everything is aborted, each basic process with its `abandon`; nothing acts."""
        reactor = self._reactor
        reactor.journal.note(Halted(True, reactor.scheduler.now))
        reactor.trace.record("halted")
        reactor.transactions.halt()
        for root in list(reactor.executer.roots):
            reactor.executer.kill(root)
        reactor.perceive("halted", "stop")
        return reactor.executer.start_process(AT_REST, name="halted")

    def reset(self) -> Root:
        """Begin again on the committed structure; `DiskError` if the journal cannot say so."""
        reactor = self._reactor
        reactor.journal.write(Halted(False, reactor.scheduler.now))
        reactor.trace.record("reset")
        reactor.executer.kill(reactor.root)
        return self._begun(Recovery(reactor.journal.state))

    def _begun(self, recovery: Recovery | None) -> Root:
        root = self._reactor.executer.start("REACTOR")
        if recovery is not None:
            self._restoration = restore(self._reactor, recovery, self._equation)
        return root
