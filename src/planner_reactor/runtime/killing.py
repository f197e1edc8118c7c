"""Forced abort (N9): strands and all below them, in a fixed order and without recursion.

Components go left to right, a body in service is closed after its content. Every leaf that waits is told once
(`cancel`): ports are left, timers withdrawn, basic processes abandoned, controls take back what they began.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Protocol

from planner_reactor.runtime.strands import FORKED, OVER, UNBOUND, WAITING, WOKEN, Body, Instruction, Strand


class Books(Protocol):
    """What the kernel counts of the living, and where it queues those that go on."""

    live: int
    bodies: int

    def queue(self, strand: Strand, pc: Instruction) -> None: ...


def kill(books: Books, strands: Iterable[Strand]) -> None:
    """Abort these strands and all below them."""
    pending: list[Strand | Body] = list(strands)
    pending.reverse()
    while pending:
        item = pending.pop()
        if isinstance(item, Body):
            close(books, item, "killed")
        elif item.state != OVER:
            state, link = item.state, item.link
            item.state = OVER
            books.live -= 1
            pending += reversed(_opened(item))
            if state == FORKED:
                pending += reversed(link.strands())
            elif state in (WAITING, WOKEN):
                item.pc.cancel(item)  # type: ignore[attr-defined]  # only a leaf waits
            item.release()


def close(books: Books, body: Body, outcome: str) -> None:
    """A body is over: "stop", "abort" or "killed"."""
    books.bodies -= 1
    body.outcome = outcome
    body.opener.closed(body)
    body.release()


def cut_body(books: Books, body: Body, cause: str) -> None:
    """Abort a body in service from outside its own turn: what its strand waits for is taken back first."""
    strand = body.strand
    if strand.state in (WAITING, WOKEN):
        strand.pc.cancel(strand)  # type: ignore[attr-defined]  # only a leaf waits
    abort_body(books, body, cause)


def abort_body(books: Books, body: Body, cause: str) -> None:
    """Abort a body in service: its content is killed, and what it has bound is unbound, as with what loses a `#` (N5).

    Its strand goes on where the body's abort leads.
    """
    strand = body.strand
    if strand.state == FORKED:
        kill(books, strand.link.strands())
    for inner in _opened(strand):
        if inner is body:
            break
        close(books, inner, "killed")
    strand.body = body
    strand.frame = body.frame
    strand.stack = body.stack
    strand.link = None
    strand.cause = cause
    for slot in body.close.bound:  # type: ignore[attr-defined]  # what closes a body knows
        strand.frame[slot] = UNBOUND
    books.queue(strand, body.close)


def _opened(strand: Strand) -> list[Body]:
    """The bodies that this strand has opened, innermost first."""
    bodies: list[Body] = []
    body = strand.body
    while body is not None and body.strand is strand:
        bodies.append(body)
        body = body.parent
    return bodies
