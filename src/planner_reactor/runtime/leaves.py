"""The leaves that the executer knows itself: tests, choices, delays, NIL; and the one that runs any `Control`.

Running a leaf is a step. A leaf whose arguments have no value is one step too, which aborts with cause `error`
(`Mistake`). Ports are in `ports`.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import msgspec

from planner_reactor.rs.expressions import EvaluationError, is_number
from planner_reactor.rs.terms import Expression, Number, Value
from planner_reactor.runtime.instructions import enter
from planner_reactor.runtime.kernel import Kernel
from planner_reactor.runtime.outcomes import STOPPED, Control, OpensBody, Outcome
from planner_reactor.runtime.strands import RUNNING, WAITING, Frame, Instruction, Strand, Where
from planner_reactor.runtime.values import Reader, Tuples


class Setting(msgspec.Struct, frozen=True, kw_only=True):
    """What every leaf is compiled with."""

    kernel: Kernel
    name: str
    where: Where
    terms: tuple[Expression, ...]
    slots: tuple[int, ...]  # of each term that is a variable; -1 for others
    arguments: Tuples
    readers: tuple[Reader, ...]  # of each term, for the leaves below
    targets: tuple[int, ...]
    ok: Instruction
    ab: Instruction

    @property
    def failed(self) -> Mistake:
        return Mistake(self.kernel, self.name, self.ab, self.where)


class Mistake:
    """A call whose arguments have no value, or that no clause answers: one step, which aborts (cause error)."""

    __slots__ = ("ab", "kernel", "name", "where")
    silent = False
    resting = False

    def __init__(self, kernel: Kernel, name: str, ab: Instruction, where: Where) -> None:
        self.kernel = kernel
        self.name = name
        self.ab = ab
        self.where = where

    def run(self, strand: Strand) -> Instruction | None:
        kernel = self.kernel
        kernel.steps += 1
        if kernel.observer is not None:
            kernel.tell((self.name, (), "ab", ()), self.where.site)
        strand.cause = "error"
        kernel.note("mistake", name=self.name, place=str(self.where.site), root=strand.root.name)
        return self.ab


class Test:
    """GTR, LST, Equal: stops if it holds, else aborts; at once. `holds` asks it of the frame."""

    __slots__ = ("ab", "arguments", "failed", "holds", "kernel", "name", "ok", "where")
    silent = False
    resting = False

    def __init__(self, setting: Setting, holds: Callable[[Frame], bool]) -> None:
        self.kernel = setting.kernel
        self.name = setting.name
        self.arguments = setting.arguments
        self.ok = setting.ok
        self.ab = setting.ab
        self.failed = setting.failed
        self.where = setting.where
        self.holds = holds

    def run(self, strand: Strand) -> Instruction | None:
        try:
            holds = self.holds(strand.frame)
        except EvaluationError:
            return self.failed.run(strand)
        kernel = self.kernel
        kernel.steps += 1
        if kernel.observer is not None:
            kernel.tell((self.name, self.arguments(strand.frame), "ok" if holds else "ab", ()), self.where.site)
        if holds:
            return self.ok
        strand.cause = "failed"
        return self.ab


class Ran:
    """Ran[l,h]<x>: a number between l and h, drawn from the scheduler's stream `Ran`."""

    __slots__ = ("setting",)
    silent = False
    resting = False

    def __init__(self, setting: Setting) -> None:
        self.setting = setting

    @property
    def where(self) -> Where:
        return self.setting.where

    def run(self, strand: Strand) -> Instruction | None:
        setting, kernel = self.setting, self.setting.kernel
        try:
            low, high = values = setting.arguments(strand.frame)
        except (EvaluationError, ValueError):
            return setting.failed.run(strand)
        kernel.steps += 1
        if not (is_number(low) and is_number(high)):
            observe(setting, values, ok=False)
            strand.cause = "error"
            return setting.ab
        drawn = kernel.scheduler.random("Ran").uniform(low, high)  # type: ignore[arg-type]
        for slot in setting.targets[:1]:
            strand.frame[slot] = drawn
        if kernel.observer is not None:
            kernel.tell((setting.name, values, "ok", (drawn,)), setting.where.site)
        return setting.ok


class Pass:
    """Delay, SUSPEND, Term: stops when its time has passed. `adapt` gives the age at which this one ends."""

    __slots__ = ("_adapt", "_age", "_fixed", "_scheduler", "_slot", "kernel", "ok", "setting", "where")
    silent = False
    resting = False

    def __init__(self, setting: Setting, adapt: Callable[[float, Kernel], float] | None = None) -> None:
        self.setting = setting
        self.kernel = setting.kernel
        self.ok = setting.ok
        self.where = setting.where
        self._adapt = adapt
        self._scheduler = setting.kernel.scheduler
        (self._age,) = setting.readers
        (term,) = setting.terms
        self._fixed = term.value if isinstance(term, Number) else None
        (self._slot,) = setting.slots

    def run(self, strand: Strand) -> Instruction | None:
        age: Any = self._fixed if self._slot < 0 else strand.frame[self._slot]
        if age.__class__ is not float and age.__class__ is not int:
            try:
                age = self._age(strand.frame)
            except EvaluationError:
                return self.setting.failed.run(strand)
            if not is_number(age):
                return self._ended(strand, ok=False)
        if self._adapt is not None:
            age = self._adapt(age, self.kernel)
        scheduler = self._scheduler
        when = scheduler.now + age
        if when <= scheduler.now:
            return self._ended(strand, ok=True)
        strand.pc = self
        strand.state = WAITING
        strand.link = entry = (self.kernel, strand)
        scheduler.wait(when, entry)
        return None

    def observe(self, strand: Strand) -> None:
        observe(self.setting, self.setting.arguments(strand.frame), ok=True)

    def cancel(self, strand: Strand) -> None:
        self.kernel.withdraw(strand)

    def _ended(self, strand: Strand, *, ok: bool) -> Instruction:
        """A step at once: no time was to pass, or the argument is no number."""
        setting = self.setting
        self.kernel.steps += 1
        observe(setting, setting.arguments(strand.frame), ok=ok)
        strand.cause = "" if ok else "error"
        return setting.ok if ok else setting.ab


def milliseconds(age: float, kernel: Kernel) -> float:
    return age / 1000


def at_most(age: float, kernel: Kernel) -> float:
    """Term[t] ends at any age up to t; in execution it is drawn at random, in analysis it is an interval."""
    return kernel.scheduler.random("Term").uniform(0.0, age) if age > 0 else 0.0


class Never:
    """NIL: neither stops nor aborts."""

    __slots__ = ("where",)
    silent = False
    resting = True

    def __init__(self, setting: Setting) -> None:
        self.where = setting.where

    def run(self, strand: Strand) -> Instruction | None:
        strand.pc = self
        strand.state = WAITING
        return None

    def cancel(self, strand: Strand) -> None:
        """Nothing to take back."""


class Use:
    """A leaf that runs a `Control`; if it opens a body, `slot` is where the frame keeps that body.

    Without a slot nothing follows it, and there is no body; before `::` the body is that of the spawned strand
    (`spawns`), which finds the context in `value`.
    """

    __slots__ = ("_announces", "_arguments", "_start", "ab", "close", "control", "kernel", "name", "ok",
                 "setting", "slot", "spawns", "targets", "where")  # fmt: skip
    silent = False

    def __init__(self, setting: Setting, control: Control) -> None:
        self.setting = setting
        self.kernel = setting.kernel
        self.name = setting.name
        self.targets = setting.targets
        self.ok = setting.ok
        self.ab = setting.ab
        self.where = setting.where
        self.control = control
        self.slot = -1
        self.close: Instruction | None = None
        self.spawns = False
        self._arguments = setting.arguments
        self._start = control.start
        self._announces = control.announces

    @property
    def resting(self) -> bool | Callable[[Strand], bool]:
        return self.control.resting

    @property
    def opens(self) -> bool:
        """Does something follow it, so that what it delivers gets a body?"""
        return self.slot >= 0

    def run(self, strand: Strand) -> Instruction | None:
        strand.pc = self
        try:
            values = self._arguments(strand.frame)
        except EvaluationError:
            return self.setting.failed.run(strand)
        kernel = self.kernel
        strand.state = WAITING
        outcome = self._start(strand, values)
        if outcome is None:
            if self._announces:
                kernel.steps += 1
                observe(self.setting, values, ok=True, status="wait")
            return None
        strand.state = RUNNING
        onward = self.finish(strand, values, outcome)
        if kernel.due:
            kernel.queue(strand, onward)
            return None
        return onward

    def finish(self, strand: Strand, values: tuple[Value, ...], outcome: Outcome) -> Instruction:
        """The process ends as a step of its own."""
        kernel = self.kernel
        kernel.steps += 1
        if kernel.observer is not None:
            kernel.tell((self.name, values, "ok" if outcome.ok else "ab", outcome.values), self.where.site)
        return self.ok if outcome is STOPPED and self.slot < 0 else self.take(strand, outcome)

    def take(self, strand: Strand, outcome: Outcome) -> Instruction:
        """Bind the results and begin the body, if one follows; where to go on."""
        strand.link = None
        frame = strand.frame
        for slot, value in zip(self.targets, outcome.values, strict=False):
            frame[slot] = value
        if not outcome.ok:
            strand.cause = outcome.cause or "failed"
            return self.ab
        if self.spawns:
            strand.value = outcome.context
        elif self.close is not None:
            opener: OpensBody = self.control  # type: ignore[assignment]  # it has a body to close
            enter(self.kernel, strand, opener, outcome.context, self.slot, self.close)
        return self.ok

    def cancel(self, strand: Strand) -> None:
        self.control.cancel(strand)


def observe(setting: Setting, values: tuple[Value, ...], *, ok: bool, status: str = "") -> None:
    """Tell the observer, if there is one, of a step without results."""
    if setting.kernel.observer is not None:
        setting.kernel.tell((setting.name, values, status or ("ok" if ok else "ab"), ()), setting.where.site)
