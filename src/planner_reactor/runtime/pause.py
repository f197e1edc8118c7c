"""What waits for time: the face of such a leaf, and the one that a budget puts in place of a root's next round.

Semantics.md, STREAM: a budget of turns aborts the nearest enclosing body, never a root, whose next round waits one
quantum.
"""

from __future__ import annotations

from typing import Protocol

from planner_reactor.runtime.strands import NOWHERE, Instruction, Strand


class Passing(Instruction, Protocol):
    """A leaf that stops when its time has passed."""

    @property
    def ok(self) -> Instruction: ...

    def observe(self, strand: Strand) -> None:
        """Tell the observer of the step with which it ends."""


class Withdrawing(Protocol):
    """What the kernel does when a strand that waits for time is aborted."""

    def withdraw(self, strand: Strand) -> None: ...


class Pause:
    """Stands where a strand of a root has used up its turns of one instant; no step that an observer sees."""

    __slots__ = ("_kernel", "ok")
    silent = False
    where = NOWHERE
    resting = False

    def __init__(self, kernel: Withdrawing, onward: Instruction) -> None:
        self._kernel = kernel
        self.ok = onward

    def run(self, strand: Strand) -> Instruction | None:
        return self.ok

    def observe(self, strand: Strand) -> None:
        """Nothing has happened."""

    def cancel(self, strand: Strand) -> None:
        self._kernel.withdraw(strand)
