"""The instructions that bring `|`, `&`, `#` and `::` to life, and those that end their parts.

A fork makes one strand for each part; they share the frame, since siblings bind different names (static check), except
that the bodies of `::` have a copy each. The strand that met the fork goes on when it is decided: `|` and `&` with
their last part (N4, N4'), `#` by a verdict of the kernel (N5), `::` when its head has aborted and all bodies have
ended (N8).
"""

from __future__ import annotations

from typing import Any

from planner_reactor.runtime.instructions import enter, label_of
from planner_reactor.runtime.kernel import Kernel
from planner_reactor.runtime.outcomes import Guards, OpensBody
from planner_reactor.runtime.strands import FORKED, NOWHERE, UNBOUND, WOKEN, Fork, Instruction, Strand, Where
from planner_reactor.runtime.values import Tuples

Exports = tuple[tuple[tuple[int, int], ...], ...]
"""For each part of a `#`: which slots of its own go to which slots outside, should it win."""

Guard = tuple[int, Guards, Tuples]
"""Which part of a `#` is its guard, the control that it is, and its label."""


class ForkParts:
    """Begin the parts of a `|`, `&` or `#`. `first`: the outcome of `|` or `&` before any part has ended."""

    __slots__ = ("ab", "decisive", "exports", "first", "guard", "kernel", "ok", "parts", "where")
    silent = True

    def __init__(
        self,
        kernel: Kernel,
        parts: tuple[Instruction, ...],
        *,
        ok: Instruction,
        ab: Instruction,
        first: bool,
        decisive: bool,
        where: Where,
        exports: Exports = (),
        guard: Guard | None = None,
    ) -> None:
        self.kernel = kernel
        self.parts = parts
        self.ok = ok
        self.ab = ab
        self.first = first
        self.decisive = decisive  # is it a `#`?
        self.where = where
        self.exports = exports
        self.guard = guard

    def run(self, strand: Strand) -> Instruction | None:
        kernel = self.kernel
        count = len(self.parts)
        if kernel.live + count > kernel.budgets.processes:
            return kernel.crowded(strand, self.ab)
        kernel.live += count
        fork = open_fork(self, strand, first=self.first, decisive=self.decisive)
        frame, parts, silent = strand.frame, fork.parts, kernel.silent
        for index, entry in enumerate(self.parts):
            part = strand.child(entry, frame, fork, index)
            parts.append(part)
            silent.append(part)
        fork.live = count
        kernel.due = True
        if self.guard is not None:
            self._set_guard(strand, fork)
        return None

    def _set_guard(self, strand: Strand, fork: Fork) -> None:
        assert self.guard is not None
        index, control, arguments = self.guard
        has_value, label = label_of(arguments, strand)
        if not has_value:
            return
        strands = fork.strands()
        for part in strands:
            part.guard = label
        guarding = strands[index]
        guarding.state = WOKEN  # from now on it waits there: it is cancelled should it never have its turn
        self.kernel.ready.append(guarding)
        control.guard_set(label, guarding, tuple(strands[:index] + strands[index + 1 :]))


def open_fork(instruction: ForkParts | ForkSpawn, strand: Strand, *, first: bool, decisive: bool) -> Fork:
    outer = strand.fork
    depth = 0 if outer is None else outer.depth
    fork = Fork(instruction, strand, depth + 1 if decisive else depth, ok=first)
    strand.pc = instruction
    strand.state = FORKED
    strand.link = fork
    return fork


class PartEnd:
    """A part of `|` or `&` has ended with this outcome; a stop `settles` the outcome of `|`, an abort that of `&`."""

    __slots__ = ("kernel", "ok", "settles")
    silent = True
    where = NOWHERE

    def __init__(self, kernel: Kernel, *, ok: bool, settles: bool) -> None:
        self.kernel = kernel
        self.ok = ok
        self.settles = settles

    def run(self, strand: Strand) -> Instruction | None:
        fork = strand.fork
        assert fork is not None
        fork.parts[strand.index] = None
        if self.settles:
            fork.ok = self.ok
        if not self.ok and (fork.cause is None or strand.index < fork.cause[0]):
            fork.cause = (strand.index, strand.cause)
        end_part(self.kernel, fork, strand)
        return None


def end_part(kernel: Kernel, fork: Fork, strand: Strand) -> None:
    """A strand of a fork is over; with the last one the fork is."""
    fork.live -= 1
    kernel.live -= 1
    strand.release()
    if not fork.live:
        kernel.joined(fork, fork.ok, fork.cause[1] if fork.cause else "failed")


class RivalEnd:
    """A part of `#` has ended with this outcome: the kernel decides when all is quiet (N5)."""

    __slots__ = ("kernel", "ok")
    silent = True
    where = NOWHERE

    def __init__(self, kernel: Kernel, *, ok: bool) -> None:
        self.kernel = kernel
        self.ok = ok

    def run(self, strand: Strand) -> Instruction | None:
        fork = strand.fork
        assert fork is not None
        kernel = self.kernel
        fork.parts[strand.index] = None
        fork.ended.append((strand.index, self.ok, strand.cause))
        kernel.live -= 1
        strand.release()
        kernel.undecided(fork)
        return None


class ForkSpawn:
    """Begin `A::B`: a head that runs A; each time A stops it spawns a B."""

    __slots__ = ("ab", "exports", "head", "kernel", "ok", "where")
    silent = True

    def __init__(self, kernel: Kernel, *, ok: Instruction, ab: Instruction, where: Where) -> None:
        self.kernel = kernel
        self.head: Instruction = self
        self.ok = ok
        self.ab = ab
        self.where = where
        self.exports: Exports = ()

    def run(self, strand: Strand) -> Instruction | None:
        kernel = self.kernel
        if kernel.live >= kernel.budgets.processes:
            return kernel.crowded(strand, self.ab)
        kernel.live += 1
        fork = open_fork(self, strand, first=False, decisive=False)
        fork.head = self.head
        head = strand.child(self.head, strand.frame, fork, 0)
        fork.parts.append(head)
        fork.live = 1
        kernel.silent.append(head)
        kernel.due = True
        return None


class SpawnBody:
    """A of `A::B` has stopped: a B with these bindings, and A again with fresh ones."""

    __slots__ = ("body", "close", "kernel", "opener", "slot", "slots", "where")
    silent = True

    def __init__(self, kernel: Kernel, slot: int, where: Where) -> None:
        self.kernel = kernel
        self.slots: tuple[int, ...] = ()
        self.body: Instruction = self
        self.close: Any = None  # an instruction, if it opens bodies
        self.opener: OpensBody | None = None
        self.slot = slot
        self.where = where

    def run(self, strand: Strand) -> Instruction | None:
        kernel = self.kernel
        fork = strand.fork
        assert fork is not None
        frame = strand.frame
        if kernel.live < kernel.budgets.processes:
            self._spawn(strand, fork)
        else:
            kernel.note("crowded", root=strand.root.name)
        for slot in self.slots:
            frame[slot] = UNBOUND
        strand.value = None
        kernel.queue(strand, fork.head)
        return None

    def _spawn(self, head: Strand, fork: Fork) -> None:
        kernel = self.kernel
        fork.spawned += 1
        fork.live += 1
        kernel.live += 1
        body = head.child(self.body, head.frame.copy(), fork, fork.spawned)
        fork.bodies[body.index] = body
        kernel.silent.append(body)
        kernel.due = True
        if self.opener is not None:
            enter(kernel, body, self.opener, head.value, self.slot, self.close)


class BodyEnd:
    """A body of `::` has ended: it is merged away (the outcome of `::` is that of `|` over all of them)."""

    __slots__ = ("kernel", "ok")
    silent = True
    where = NOWHERE

    def __init__(self, kernel: Kernel, *, ok: bool) -> None:
        self.kernel = kernel
        self.ok = ok

    def run(self, strand: Strand) -> Instruction | None:
        fork = strand.fork
        assert fork is not None
        del fork.bodies[strand.index]
        fork.ok = fork.ok or self.ok
        end_part(self.kernel, fork, strand)
        return None


class HeadEnd:
    """A of `A::B` has aborted: the loop ends with its last body."""

    __slots__ = ("kernel",)
    silent = True
    where = NOWHERE

    def __init__(self, kernel: Kernel) -> None:
        self.kernel = kernel

    def run(self, strand: Strand) -> Instruction | None:
        fork = strand.fork
        assert fork is not None
        fork.parts[0] = None
        fork.cause = (0, strand.cause)
        end_part(self.kernel, fork, strand)
        return None
