"""Is anything of a reaction in service? What a guard may be killed over (R §5.5, rule KILL).

A reaction is at rest when each of its leaves waits in a control that says so (SIT, a queued ASSERT), or stands in the
condition of an outermost loop (it senses); a round of a loop, and a body, are in service.
"""

from __future__ import annotations

from planner_reactor.runtime.strands import FORKED, OUTSIDE, OVER, SENSING, Stack, Strand


def is_resting(strand: Strand) -> bool:
    """Is nothing below this strand in service?"""
    around = strand.fork.parent.body if strand.fork is not None else None
    pending = [(strand, OUTSIDE)]
    while pending:
        found, zone = pending.pop()
        if found.state == OVER:
            continue
        if found.body is not around:
            return False
        zone = zone or _zone(found)
        if found.state == FORKED:
            pending += [(part, zone) for part in found.link.strands()]
        elif zone != SENSING and not _rests(found):
            return False
    return True


def _rests(strand: Strand) -> bool:
    resting = getattr(strand.pc, "resting", False)
    return bool(resting(strand)) if callable(resting) else bool(resting)


def _zone(strand: Strand) -> int:
    """Where the strand stands: decided by the outermost call that is in a loop, else by its own instruction."""
    zones: list[int] = []
    stack: Stack | None = strand.stack
    while stack is not None:
        zones.append(stack[2].where.zone)
        stack = stack[0]
    return next((zone for zone in reversed(zones) if zone), strand.pc.where.zone)
