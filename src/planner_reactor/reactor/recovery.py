"""A reactor begins again on what its journal says (R §5.3, law 8; docs/reactor.md, "The journal").

The last committed structure comes to life, uninhibited: reactions that serve situations first, then those that assert
them. Situations, bodies and drains were ended by the crash: the world is sensed anew. Adaptations that were begun and
not decided came to nothing, and the planner is told; assumptions that had failed fail until they are sensed to hold.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from planner_reactor.errors import InputError, RSError
from planner_reactor.reactor.journal import Decided, Recovery
from planner_reactor.rs.loading import load
from planner_reactor.rs.reactions import Reaction, reaction_of
from planner_reactor.rs.terms import STOP, Call, Number, Process, Program, cond
from planner_reactor.rs.vocabulary import BUILT_IN
from planner_reactor.runtime import Root

RESTARTED = "restarted"
"""The cause of refusing what was under way when the reactor was stopped."""

if TYPE_CHECKING:
    from planner_reactor.reactor.reactor import Reactor


def restore(reactor: Reactor, recovery: Recovery, equation: Program) -> Root:
    """Bring the committed structure to life in a reactor that has just been started; the root that does it."""
    journal = reactor.journal
    reactions = _reactions(reactor, equation)
    committed = journal.state.committed
    reactor.executer.load([r.schema for r in reactions])
    reactor.loaded(reactions, {r.label: committed.versions.get(r.situation or "", 0) for r in reactions})
    reactor.assumptions.restored()
    reactor.readings.restored()
    for adaptation in journal.state.open:
        journal.note(Decided(adaptation.id, "refused", reactor.scheduler.now, adaptation.epoch))
        reactor.perceive("adaptation_refused", str(adaptation.id), cause=RESTARTED, epoch=adaptation.epoch)
    reactor.trace.record("restored", labels=sorted(committed.clauses), lost=recovery.lost, damaged=recovery.damaged)
    standing = tuple(sorted(committed.versions.items()))
    reactor.perceive("restarted", "damaged" if recovery.damaged else "sound", values=standing)
    return reactor.executer.start_process(_script(reactions), name="restoration")


def _reactions(reactor: Reactor, equation: Program) -> tuple[Reaction, ...]:
    """The reactions of the journal, those that assert what others serve last."""
    text = "\n".join(reactor.journal.state.committed.clauses.values())
    try:
        program = load(
            text,
            file="<journal>",
            signatures={**BUILT_IN, **reactor.host.signatures},
            functions=reactor.host.functions,
            given=equation,
        )
    except RSError as problem:
        raise InputError(f"the journal was written with another host: {problem}") from None
    found = [r for r in map(reaction_of, program.schemas) if r is not None]
    return tuple(sorted(found, key=lambda r: (r.situation is None and not r.monitors, r.label)))


def _script(reactions: tuple[Reaction, ...]) -> Process:
    posts = [Call("POST", (Number(r.label),)) for r in reactions]
    return cond(*posts) if posts else STOP
