"""The commonest adaptation is right whatever the reactions do: one situation's reactions exchanged for others (R §5.5).

Of a slice (`slicing`) whose surgery does this and no more nothing has to be explored in mode drain. With s the first
that is held:

    held      s, then situations that go: each is asserted by reactions of those before it, and s alone from outside
    kills     every reaction that is there, each serving one that is held
    adds      reactions of s and of situations that are new, children first; what is asserted is served by one of them
    bodies    end by themselves: what may be repeated for ever is no part of them, nor is what disables or senses

Why it is right. The drains come one after the other. A drained situation has no instance in service, and what asserts
the next has ended with it; a body ends because all that it waits for is basic, or further down (*bounded*). So each
KILL meets a reaction at rest (*safe*), nothing waits after the drains (*atomic*), and what is held has no caller within
that is not drained before (*local*). What is new is asserted by the new reactions of s alone, which serve nothing until
UNINHIBIT, the last step: nobody is served by old and new (*consistent*). A test explores every slice of a family of
these, and of what is nearly one (docs/decisions/0047).
"""

from __future__ import annotations

from planner_reactor.analysis.slicing import Slice
from planner_reactor.rs.reactions import Reaction, reaction_of
from planner_reactor.rs.terms import (
    ABORT,
    STOP,
    All,
    Call,
    Cond,
    Disable,
    If,
    Loop,
    Not,
    Par,
    Process,
    Seq,
    Symbol,
    operands,
)

_ASSERTS = ("ASSERT", "REASSERT")
_PLAIN = (All, Cond, Disable, If, Not, Par, Seq)


def is_exchange(part: Slice) -> bool:
    """Is this all that the surgery of a slice does?"""
    surgery = part.surgery
    found = [reaction_of(schema) for schema in part.schemas]
    reactions = {r.label: r for r in found if r is not None}
    if not surgery.held or surgery.migrated or len(reactions) != len(part.schemas):
        return False
    if not all(_ends(reaction) for reaction in reactions.values()):
        return False
    old = [reactions[n] for n in part.present]
    new = [reactions[n] for n in surgery.adds if n in reactions and n not in part.present]
    return (
        {*surgery.kills} == {*part.present}
        and len(old) + len(new) == len(reactions)
        and len(new) == len(surgery.adds)
        and {*part.asked} <= {surgery.held[0]}
        and surgery.removed == surgery.held[1:]
        and _goes(part, old)
        and _comes(part, new)
    )


def _goes(part: Slice, old: list[Reaction]) -> bool:
    """Does all that is there serve what is held, and assert only what is drained after it?"""
    turn = {situation: n for n, situation in enumerate(part.surgery.held)}
    return {r.situation for r in old} == {*turn} and all(
        name in turn and turn[name] > turn[r.situation or ""] for r in old for name in r.asserts
    )


def _comes(part: Slice, new: list[Reaction]) -> bool:
    """Does what comes serve the first that is held and what is new, children first?"""
    surgery = part.surgery
    first, served = surgery.held[0], set[str | None]()
    for reaction in new:
        if not served.issuperset(reaction.asserts) or first in reaction.asserts:
            return False
        served.add(reaction.situation)
    last = [n for n, r in enumerate(new) if r.situation == first]
    return bool(last) and served == {*surgery.named} - {*surgery.removed} and not served & {*surgery.removed}


def _ends(reaction: Reaction) -> bool:
    """Is it `SIT[s]<k> :; (~(… : SUCCEED[s, k]) : FAIL[s, k])`, or a stub, and does each instance come to an end?"""
    match reaction.schema.body:
        case Loop(Call("SIT", (Symbol(name),), ("k",)), Seq((Call("Works"), Call("FAIL", (Symbol(failed), _))))):
            return name == failed == reaction.situation
        case Loop(
            Call("SIT", (Symbol(name),), ("k",)),
            Cond((Not(Cond((*parts, Call("SUCCEED", (Symbol(done), _))))), Call("FAIL", (Symbol(failed), _)))),
        ):
            return name == done == failed == reaction.situation and all(map(_is_plain, parts))
        case _:
            return False


def _is_plain(process: Process) -> bool:
    """Does it only work and assert, once or until that succeeds?"""
    if isinstance(process, Call):
        return process in (STOP, ABORT) or process.name == "Works" or process.name in _ASSERTS
    return isinstance(process, _PLAIN) and all(map(_is_plain, operands(process)))
