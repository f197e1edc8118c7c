"""Basic processes while they run: a host's function, generator or coroutine behind the face of a `Control`.

Each run has at most one thing that it waits for (a signal, a time, or both) and one timer for its limit. It ends in
one of four ways: it returns, it raises, it outlives its limit, it is aborted from outside (N9); in the last two it is
abandoned, exactly once. What a host's code raises is an abort with cause error and an event in the trace, never more.
"""

from __future__ import annotations

from collections.abc import Callable
from types import CoroutineType, GeneratorType
from typing import Any

from planner_reactor.rs.expressions import is_number
from planner_reactor.rs.terms import Value
from planner_reactor.rs.vocabulary import Signature
from planner_reactor.runtime.apart import Workers, apart
from planner_reactor.runtime.host import BasicProcess
from planner_reactor.runtime.kernel import Kernel
from planner_reactor.runtime.leaves import Use
from planner_reactor.runtime.outcomes import STOPPED, Outcome
from planner_reactor.runtime.patience import HeldUp
from planner_reactor.runtime.scheduler import Timer
from planner_reactor.runtime.signals import Aborted, Signal, Within, sleep
from planner_reactor.runtime.strands import WAITING, Strand

ROUNDING = 1e-9
"""Seconds (or a fraction, if that is more) by which a process may outlive its limit: sums of delays are rounded."""


class Basic:
    """One registered process, as the executer sees it."""

    __slots__ = (
        "_abandon",
        "_checks",
        "_kernel",
        "_limit",
        "_low",
        "_nothing",
        "_routine",
        "name",
        "running",
        "signature",
    )
    opens_body = False
    guards = False
    resting = False
    announces = False

    def __init__(self, process: BasicProcess, kernel: Kernel, workers: Workers) -> None:
        self.signature: Signature = process.signature
        self.name = process.signature.name
        self.running = 0
        self._kernel = kernel
        blocks = process.blocking and not kernel.scheduler.clock.jumps
        self._routine = apart(process.routine, kernel.scheduler, workers) if blocks else process.routine
        self._abandon = process.abandon
        self._limit = process.limit
        self._low = process.signature.window[0] if process.signature.window else 0.0
        self._checks = tuple((i, _CHECKS[k]) for i, k in enumerate(process.signature.inputs) if k in _CHECKS)
        may_stop = not process.signature.results and "stop" in process.signature.outcomes
        self._nothing = STOPPED if may_stop and not self._low else None  # what returning None at once means

    def start(self, strand: Strand, arguments: tuple[Value, ...]) -> Outcome | None:
        for position, check in self._checks:
            if position < len(arguments) and not check(arguments[position]):
                self._kernel.note("mistake", name=self.name, place=str(strand.site), arguments=repr(arguments))
                return Outcome(False, cause="error")
        try:
            patience = self._kernel.patience
            begun = self._routine(*arguments) if patience is None else patience.call(self._routine, *arguments)
        except (Exception, HeldUp) as problem:
            return self._settled(self.raised(problem), strand, arguments)
        if begun is None and self._nothing is not None:
            return self._nothing
        if not isinstance(begun, _ROUTINES):
            return self._settled(self.returned(begun), strand, arguments)
        run = Run(self, strand, arguments, begun)
        outcome = run.go(None)
        if outcome is None:
            return None
        if self._low:
            run.hold(outcome)
            return None
        run.close()
        return outcome

    def cancel(self, strand: Strand) -> None:
        run: Run = strand.link
        run.abandon()

    def _settled(self, outcome: Outcome, strand: Strand, arguments: tuple[Value, ...]) -> Outcome | None:
        """An outcome at the very start: it stands, unless the age window has not begun."""
        if not self._low:
            return outcome
        Run(self, strand, arguments, None).hold(outcome)
        return None

    # -- for its runs

    def returned(self, value: object) -> Outcome:
        if value is None and self._nothing is not None:
            return self._nothing
        values: tuple[Value, ...] = value if isinstance(value, tuple) else () if value is None else (value,)
        if len(values) != len(self.signature.results):
            self._kernel.note("error", name=self.name, message=f"returned {len(values)} values, "
                              f"{len(self.signature.results)} are declared")  # fmt: skip
            return Outcome(False, cause="error")
        if "stop" not in self.signature.outcomes:
            self._kernel.note("error", name=self.name, message="stopped, which is not declared")
            return Outcome(False, cause="error")
        return Outcome(True, values)

    def raised(self, problem: BaseException) -> Outcome:
        if isinstance(problem, Aborted) and "abort" in self.signature.outcomes:
            self._kernel.note("aborted", name=self.name, message=str(problem))
            return Outcome(False, cause="failed")
        self._kernel.note("error", name=self.name, message=f"{type(problem).__name__}: {problem}")
        return Outcome(False, cause="error")


class Run:
    """One run of a basic process that did not end at its start."""

    __slots__ = ("_arguments", "_basic", "_begun", "_deadline", "_instant", "_routine", "_signal", "_strand", "_timed",
                 "_timer", "_turns", "over")  # fmt: skip

    def __init__(self, basic: Basic, strand: Strand, arguments: tuple[Value, ...], routine: Any) -> None:
        self._basic = basic
        self._strand = strand
        self._arguments = arguments
        self._routine = routine
        scheduler = basic._kernel.scheduler
        self._begun = scheduler.now
        self._signal: Signal | None = None
        self._timed = False  # waits for a signal, but only so long
        self._timer: Timer | None = None
        self._deadline: Timer | None = None
        self._instant = self._begun
        self._turns = 0  # at this instant
        self.over = False
        strand.link = self
        basic.running += 1

    def go(self, value: object) -> Outcome | None:
        """Let the host's code run to where it waits next; its outcome if that was its end."""
        try:
            patience = self._basic._kernel.patience
            routine = self._routine
            wanted = routine.send(value) if patience is None else patience.call(routine.send, value)
        except StopIteration as end:
            return self._basic.returned(end.value)
        except (Exception, HeldUp) as problem:
            return self._basic.raised(problem)
        return self._wait(wanted)

    def fired(self, value: object) -> None:
        """The signal that it waits for: go on soon, not inside whoever fires it."""
        self._signal = None
        if self._timer is not None:
            self._timer.cancel()
            self._timer = None
        self._basic._kernel.scheduler.soon(lambda: self._proceed(True if self._timed else value))

    def hold(self, outcome: Outcome) -> None:
        """The outcome is known, but the age window has not begun."""
        self._routine = None
        scheduler = self._basic._kernel.scheduler
        self._timer = scheduler.call_at(self._begun + self._basic._low, lambda: self._end(outcome))

    def abandon(self) -> None:
        """Aborted from outside, or too late."""
        self.close()
        if self._routine is not None:
            self._shielded(self._routine.close)
        if (abandon := self._basic._abandon) is not None:
            self._shielded(lambda: abandon(*self._arguments))

    def _shielded(self, call: Callable[[], object]) -> None:
        patience = self._basic._kernel.patience
        try:
            call() if patience is None else patience.call(call)
        except (Exception, HeldUp) as problem:
            self._basic.raised(problem)

    def _wait(self, wanted: object) -> Outcome | None:
        scheduler = self._basic._kernel.scheduler
        if self._deadline is None:
            limit = self._basic._limit
            self._deadline = scheduler.call_at(self._begun + limit + ROUNDING * max(1.0, limit), self._too_late)
        self._timed = False
        match wanted:
            case Signal():
                self._signal = wanted
                wanted.add(self)
            case Within(signal, seconds):
                self._signal = signal
                signal.add(self)
                self._timed = True
                self._timer = scheduler.call_after(seconds, self._time)
            case bool():
                return self._misused(wanted)
            case int() | float() | sleep():
                seconds = wanted.seconds if isinstance(wanted, sleep) else wanted
                if not seconds >= 0:
                    return self._misused(wanted)
                self._timer = scheduler.call_after(seconds, self._time)
            case _:
                return self._misused(wanted)
        return None

    def _misused(self, wanted: object) -> Outcome:
        self._shielded(self._routine.close)
        problem = TypeError(f"waits for {wanted!r}; expected a Signal, signal.within(seconds) or seconds")
        return self._basic.raised(problem)

    def _time(self) -> None:
        self._timer = None
        if self._signal is not None:
            self._signal.remove(self)
            self._signal = None
        self._proceed(False if self._timed else None)

    def _proceed(self, value: object) -> None:
        if self._overrun():
            return
        if not self.over and (outcome := self.go(value)) is not None:
            early = self._begun + self._basic._low - self._basic._kernel.scheduler.now
            if early > ROUNDING:
                self.hold(outcome)
            else:
                self._end(outcome)

    def _overrun(self) -> bool:
        """A host's code that waits for no time at all, again and again, uses up its turns like any other (Zeno)."""
        kernel = self._basic._kernel
        if self._instant != kernel.scheduler.now:
            self._instant, self._turns = kernel.scheduler.now, 0
        self._turns += 1
        if self.over or self._turns <= kernel.budgets.turns:
            return False
        kernel.zeno = self._basic.name
        kernel.note("zeno", name=self._basic.name, root=self._strand.root.name)
        self.abandon()
        self._end(Outcome(False, cause="budget"))
        return True

    def _too_late(self) -> None:
        self._deadline = None
        self._basic._kernel.note("limit", name=self._basic.name, seconds=self._basic._limit)
        self.abandon()
        self._end(Outcome(False, cause="error"))

    def _end(self, outcome: Outcome) -> None:
        self.close()
        strand = self._strand
        if strand.state == WAITING:
            leaf: Use = strand.pc  # type: ignore[assignment]  # basic processes are leaves of this kind
            strand.link = None
            onward = leaf.finish(strand, self._arguments, outcome)
            self._basic._kernel.resume(strand, onward)

    def close(self) -> None:
        """Wait for nothing any more."""
        if self.over:
            return
        self.over = True
        self._basic.running -= 1
        if self._signal is not None:
            self._signal.remove(self)
            self._signal = None
        for timer in (self._timer, self._deadline):
            if timer is not None:
                timer.cancel()
        self._timer = self._deadline = None


_ROUTINES = (GeneratorType, CoroutineType)
_CHECKS: dict[str, Callable[[Value], bool]] = {
    "number": is_number,
    "symbol": lambda value: isinstance(value, str),
}
