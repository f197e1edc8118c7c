"""A planner begins anew on a reactor that stands: what it is told, and what a repeated adaptation is answered (law 6).

The reactor gives each planner that enquires an epoch of its own, which is durable before it is told, and from then on
refuses the planners before it (row 7 of the fault model). What they have under way and is not committed is taken back,
so that what is told is what stands.

An adaptation that comes once more, because its outcome was lost with an incarnation of either side, changes nothing:
the outcome is told again.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from planner_reactor.errors import DiskError, RefusedError
from planner_reactor.link.messages import Adaptation, Enquiry, Standing
from planner_reactor.reactor.journal import Claimed

if TYPE_CHECKING:
    from planner_reactor.reactor.reactor import Reactor


def standing(reactor: Reactor, enquiry: Enquiry) -> Standing:
    """The reactor as it stands. `RefusedError` (reason disk) if the new epoch cannot be made durable."""
    epoch = reactor.journal.state.committed.epoch + 1
    try:
        reactor.journal.write(Claimed(epoch, reactor.scheduler.now))
    except DiskError as problem:
        raise RefusedError("disk", f"epoch {epoch} cannot be made durable: {problem}") from problem
    reactor.transactions.revoke(epoch)
    committed = reactor.journal.state.committed
    reactor.trace.record("planner_began", epoch=epoch, enquirer=enquiry.enquirer)
    return Standing(
        enquirer=enquiry.enquirer,
        epoch=epoch,
        clauses=dict(committed.clauses),
        versions=dict(committed.versions),
        rests_on=dict(committed.rests_on),
        adopted=committed.adopted,
        failed=committed.failed,
        given_up=committed.given_up,
        highest_label=committed.highest_label,
        halted=committed.halted,
    )


def repeated(reactor: Reactor, adaptation: Adaptation) -> bool:
    """Is it one that is under way or was applied? The outcome of the first is that of both, and is told again."""
    key = adaptation.epoch, adaptation.id
    under_way = any((t.adaptation.epoch, t.adaptation.id) == key for t in reactor.transactions.under_way)
    applied = reactor.journal.state.committed.was_applied(adaptation)
    if not (under_way or applied):
        return False
    reactor.trace.record("adaptation_repeated", id=adaptation.id)
    if not under_way:
        reactor.perceive("adaptation_applied", str(adaptation.id), epoch=adaptation.epoch)
    return True
