"""How long what is in service may still take: the bound of an adaptation (R §5.5, *bounded*).

A number of seconds, from the age windows and limits that basic processes declare. A drained situation ends when its
bodies in service do: each runs to its end at most once more, since a REASSERT below a withdrawn instance gives up after
its child's next failure. A process without an end (an unanswered port, an endless loop) has no bound: `inf`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from math import inf

from planner_reactor.rs.terms import (
    All,
    Call,
    Cond,
    Disable,
    Expression,
    If,
    Loop,
    Not,
    Number,
    Par,
    Process,
    Program,
    Seq,
    Spawn,
    Symbol,
    Text,
)
from planner_reactor.rs.vocabulary import Signature

Served = Callable[[str], tuple[Process, ...]]
"""The bodies that may serve an instance of a situation."""


class Bounds:
    """Bounds of processes, given the program, the signatures of its leaves and what serves each situation."""

    def __init__(
        self,
        program: Program,
        signatures: Mapping[str, Signature],
        limits: Mapping[str, float],
        served: Served,
    ) -> None:
        self._program = program
        self._signatures = signatures
        self._limits = limits
        self._served = served
        self._situations: dict[str, float] = {}

    def situation(self, name: str) -> float:
        """Seconds in which every instance of this situation in service has ended, once it is drained."""
        if name not in self._situations:
            self._situations[name] = inf  # asserted from below itself: no bound
            self._situations[name] = max((self.process(body) for body in self._served(name)), default=0.0)
        return self._situations[name]

    def process(self, process: Process) -> float:
        """Seconds in which this process has ended."""
        match process:
            case Call():
                return self._call(process)
            case Seq(parts) | Cond(parts):
                return sum(self.process(p) for p in parts)
            case Par(parts) | All(parts):
                return max(self.process(p) for p in parts)
            case Disable(parts):
                return min(self.process(p) for p in parts)
            case Not(body):
                return self.process(body)
            case If(test, then, otherwise):
                return self.process(test) + max(self.process(then), self.process(otherwise))
            case Loop() | Spawn():
                return inf

    def _call(self, call: Call) -> float:
        match call.name, call.arguments:
            case ("ASSERT" | "REASSERT"), (Symbol(name) | Text(name), *_):
                return self.situation(name)
            case ("Delay" | "Term"), (amount,):
                return _number(amount)
            case "SUSPEND", (amount,):
                return _number(amount) / 1000
            case ("STOP" | "ABORT"), _:
                return 0.0
        if clauses := self._program.clauses(call.name):
            return max(self.process(schema.body) for schema in clauses)
        if (limit := self._limits.get(call.name)) is not None:
            return limit
        signature = self._signatures.get(call.name)
        return signature.window[1] if signature is not None and signature.window is not None else inf


def _number(expression: Expression) -> float:
    return float(expression.value) if isinstance(expression, Number) else inf
