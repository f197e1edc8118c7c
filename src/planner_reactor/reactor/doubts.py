"""What may not be told before the journal is known again (law 8).

A COMMIT that could be appended and not synced leaves nobody knowing whether it is on the disk: a crash may bring it
back. The adaptation is not applied, and it is not refused either, as far as the planner is told, until the journal has
been begun anew without it. Should the reactor crash before, what it says of the versions that stand is the answer.

So it is with everything that came to nothing: who was told so may ask for something else, and if the power went before
the id is known to be spent, the same adaptation could come once more, and be applied.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from planner_reactor.link.messages import Adaptation, PerceptionKind
from planner_reactor.reactor.journal import Decided

if TYPE_CHECKING:
    from planner_reactor.reactor.reactor import Reactor

AGAIN = 1.0
"""Seconds after which the journal is tried again."""

UNREADABLE = frozenset({"text", "mode"})
"""Reasons of refusing what no planner that is right can have meant."""


class Doubts:
    """Tells what came to nothing, and holds it back while the journal is not trusted."""

    def __init__(self, reactor: Reactor) -> None:
        self._reactor = reactor
        self._waiting: list[Callable[[], object]] = []

    def spend(self, refused: Adaptation, reason: str) -> bool:
        """The id of what is refused at once is spent, durably; False if it cannot be, or is already.

        A later planner's time begins with what is refused of it too, unless that could not even be read.
        """
        reactor, committed = self._reactor, self._reactor.journal.state.committed
        if refused.epoch < committed.epoch or committed.spent(refused.epoch, refused.id):
            return False
        if refused.epoch > committed.epoch and reason in UNREADABLE:
            return False
        reactor.transactions.revoke(refused.epoch)
        reactor.journal.note(Decided(refused.id, "refused", reactor.scheduler.now, refused.epoch))
        return True

    def tell(
        self, kind: PerceptionKind, adaptation: Adaptation, cause: str, *message: str, doubtful: bool = True
    ) -> None:
        """Tell the planner what became of an adaptation."""

        def told() -> None:
            self._reactor.perceive(kind, str(adaptation.id), cause=cause, values=message, epoch=adaptation.epoch)

        self.settle(told, doubtful=doubtful)

    def settle(self, told: Callable[[], object], *, doubtful: bool) -> None:
        """Call `told`; what is doubtful as soon as the journal is known to hold what its state says.

        That something has to wait is told at once.
        """
        if self._reactor.journal.trusted or not doubtful:
            told()
            return
        self._waiting.append(told)
        if len(self._waiting) == 1:
            self._reactor.perceive("error", "journal", cause="the disk takes nothing")
            self._reactor.scheduler.call_after(AGAIN, self._try)

    def _try(self) -> None:
        scheduler = self._reactor.scheduler
        if not self._reactor.journal.renew(scheduler.now):
            scheduler.call_after(AGAIN, self._try)
            return
        waiting, self._waiting = self._waiting, []
        for told in waiting:
            told()
