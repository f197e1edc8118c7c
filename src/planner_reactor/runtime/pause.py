"""Where a strand of a root stands that has used up its turns at one instant: it goes on a quantum later.

Semantics.md, STREAM: the budget aborts the nearest enclosing body, never a root, whose next round waits one
quantum.
"""

from __future__ import annotations

from collections.abc import Callable

from planner_reactor.runtime.scheduler import Entry, Scheduler
from planner_reactor.runtime.strands import NOWHERE, Instruction, Strand


class Pause:
    """A leaf put in place of the instruction that is to go on."""

    __slots__ = ("_onward", "_resume", "_scheduler")
    silent = False
    where = NOWHERE
    resting = False

    def __init__(
        self, scheduler: Scheduler, resume: Callable[[Strand, Instruction], None], onward: Instruction
    ) -> None:
        self._scheduler = scheduler
        self._resume = resume
        self._onward = onward

    def run(self, strand: Strand) -> Instruction | None:
        return self._onward

    def elapsed(self, entry: Entry) -> None:
        if self.awaits(entry):
            self._resume(entry[1], self._onward)

    def awaits(self, entry: Entry) -> bool:
        return entry[1].link is entry

    def cancel(self, strand: Strand) -> None:
        strand.link = None
        self._scheduler.withdrawn()
