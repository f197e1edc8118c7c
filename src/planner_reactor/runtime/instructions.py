"""The silent instructions: calls, returns, rounds, and the ends of what they began.

`;` `:` `~` and `if` need none: they are compiled into where a process goes on when it stops (`ok`) and when it aborts
(`ab`). A call that is no tail call pushes one tuple; a tail call and a round push none, so that they run in constant
space. What forks is in `forks`.
"""

from __future__ import annotations

import msgspec

from planner_reactor.rs.expressions import EvaluationError
from planner_reactor.rs.terms import Value
from planner_reactor.runtime.definitions import Definition
from planner_reactor.runtime.kernel import Kernel
from planner_reactor.runtime.killing import close
from planner_reactor.runtime.outcomes import OpensBody
from planner_reactor.runtime.strands import NOWHERE, UNBOUND, Body, Instruction, Strand, Where
from planner_reactor.runtime.values import Frames, Tuples


class Fail:
    """An abort that no process caused: ABORT, and the abort that `~` makes of a stop."""

    __slots__ = ("ab",)
    silent = True
    where = NOWHERE

    def __init__(self, ab: Instruction) -> None:
        self.ab = ab

    def run(self, strand: Strand) -> Instruction | None:
        strand.cause = "failed"
        return self.ab


class Arguments(msgspec.Struct, frozen=True):
    """What goes into a call, and the slots that its results go to."""

    frames: Frames
    count: int
    targets: tuple[int, ...]


class Call:
    """N7. `N_e<y> = [body[e/z]]_{r→y}`: a call that returns here."""

    __slots__ = ("ab", "count", "definition", "failed", "frames", "kernel", "ok", "targets", "where")
    silent = True

    def __init__(
        self,
        kernel: Kernel,
        definition: Definition,
        passed: Arguments,
        failed: Instruction,
        *,
        ok: Instruction,
        ab: Instruction,
    ) -> None:
        self.kernel = kernel
        self.definition = definition
        self.frames = passed.frames
        self.count = passed.count
        self.targets = passed.targets
        self.ok = ok
        self.ab = ab
        self.failed = failed
        self.where = failed.where

    def run(self, strand: Strand) -> Instruction | None:
        try:
            frame = self.frames(strand.frame)
        except EvaluationError:
            return self.failed
        definition = self.definition
        clause = definition.only if definition.only_arity == self.count else definition.select(frame)
        if clause is None:
            return self.failed
        stack = strand.stack
        depth = 0 if stack is None else stack[3]
        kernel = self.kernel
        if depth > kernel.budgets.depth:
            kernel.zeno = self.where.within
            strand.cause = "budget"
            return self.ab
        code = clause.exporting() if self.targets else clause.plain_code or clause.plain()
        strand.stack = (stack, strand.frame, self, depth + 1)
        frame.extend(code.blank)
        strand.frame = frame
        return code.entry


class TailCall:
    """N6. `[r>T]_{} = [T]_{}`: a call in whose place nothing is left to do."""

    __slots__ = ("count", "definition", "failed", "frames", "where")
    silent = True

    def __init__(self, definition: Definition, passed: Arguments, failed: Instruction) -> None:
        self.definition = definition
        self.frames = passed.frames
        self.count = passed.count
        self.failed = failed
        self.where = failed.where

    def run(self, strand: Strand) -> Instruction | None:
        try:
            frame = self.frames(strand.frame)
        except EvaluationError:
            return self.failed
        definition = self.definition
        clause = definition.only if definition.only_arity == self.count else definition.select(frame)
        if clause is None:
            return self.failed
        code = clause.plain_code or clause.plain()
        if code.blank:
            frame += code.blank
        strand.frame = frame
        return code.entry


class Return:
    """The end of a definition's body: the declared results, and nothing else, go to the caller."""

    __slots__ = ("ok", "results")
    silent = True
    where = NOWHERE

    def __init__(self, results: tuple[int, ...], *, ok: bool) -> None:
        self.ok = ok
        self.results = results

    def run(self, strand: Strand) -> Instruction | None:
        stack = strand.stack
        assert stack is not None
        rest, frame, call, _ = stack
        if call.targets:
            inner = strand.frame
            for slot, target in zip(self.results, call.targets, strict=False):
                if slot >= 0 and inner[slot] is not UNBOUND:
                    frame[target] = inner[slot]
        strand.stack = rest
        strand.frame = frame
        return call.ok if self.ok else call.ab


class RootEnd:
    """The end of a root."""

    __slots__ = ("kernel", "ok", "results")
    silent = True
    where = NOWHERE

    def __init__(self, kernel: Kernel, results: tuple[tuple[str, int], ...], *, ok: bool) -> None:
        self.kernel = kernel
        self.results = results
        self.ok = ok

    def run(self, strand: Strand) -> Instruction | None:
        frame = strand.frame
        root = strand.root
        root.results = {name: frame[slot] for name, slot in self.results if frame[slot] is not UNBOUND}
        self.kernel.ended(root, strand, ok=self.ok)
        return None


class Round:
    """N8. `A:;B = A : ([B]_{} ; (A:;B))`: B has ended, however; A again, with fresh results."""

    __slots__ = ("head", "slots", "where")
    silent = True

    def __init__(self, where: Where) -> None:
        self.slots: tuple[int, ...] = ()
        self.head: Instruction = self
        self.where = where

    def run(self, strand: Strand) -> Instruction | None:
        if self.slots:
            frame = strand.frame
            for slot in self.slots:
                frame[slot] = UNBOUND
        return self.head


class Again:
    """N8 for `SIT :; B`. Its beginning stands in the frame: code that leads to itself would be cyclic garbage."""

    __slots__ = ("held", "slots", "where")
    silent = True

    def __init__(self, held: int, where: Where) -> None:
        self.held = held
        self.slots: tuple[int, ...] = ()
        self.where = where

    def run(self, strand: Strand) -> Instruction | None:
        frame = strand.frame
        for slot in self.slots:
            frame[slot] = UNBOUND
        head: Instruction = frame[self.held]  # type: ignore[assignment]  # nothing else is ever there
        return head


class CloseBody:
    """The end of what follows a control that opens bodies. What cuts a body off forgets `bound`, the slots it binds."""

    __slots__ = ("bound", "kernel", "ok", "onward", "slot")
    silent = True
    where = NOWHERE

    def __init__(
        self, kernel: Kernel, slot: int, onward: Instruction, *, ok: bool, bound: tuple[int, ...] = ()
    ) -> None:
        self.kernel = kernel
        self.slot = slot
        self.onward = onward
        self.ok = ok
        self.bound = bound

    def run(self, strand: Strand) -> Instruction | None:
        body = strand.frame[self.slot]
        if not isinstance(body, Body):  # nothing was delivered: what follows it ran without a body
            return self.onward
        strand.frame[self.slot] = UNBOUND
        leave(strand, body)
        kernel = self.kernel
        close(kernel, body, "stop" if self.ok else "abort")
        if kernel.due:
            kernel.queue(strand, self.onward)
            return None
        return self.onward


def enter(kernel: Kernel, strand: Strand, opener: OpensBody, context: object, slot: int, close: Instruction) -> None:
    """A body begins in this strand."""
    body = Body(context, strand.body, strand, opener, close)
    strand.frame[slot] = body
    strand.body = strand.meter = body
    kernel.bodies += 1
    opener.opened(strand, body)


def leave(strand: Strand, body: Body) -> None:
    strand.body = body.parent
    strand.meter = body.parent or strand.root


def label_of(arguments: Tuples, strand: Strand) -> tuple[bool, Value]:
    """The label of a guard: (whether it has a value, the value)."""
    try:
        return True, arguments(strand.frame)[0]
    except EvaluationError:
        return False, None
