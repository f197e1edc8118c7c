"""How long what is in service may still take: the bound of an adaptation (R §5.5, *bounded*).

A number of seconds, from the age windows and limits that basic processes declare (what a process waits for a shared
resource is part of its window). The one home of bounds: the reactor sets its deadlines by it, `analysis.adaptations`
states it, and adaptations observed in runs are held against it.

A drain withdraws what is on. From then on a body only goes on to its end: a new ASSERT fails at once, one that waits
returns when the child's bodies have ended, and a REASSERT does not repeat it. So two things are asked of a process:

    fresh   it begins now, below a withdrawn instance        going   it has begun before, and may be anywhere in it

The answer is a `Latest`: the latest end by stop, by abort, and at all. What may go on for ever (a loop whose condition
may stop again, a port, a time that is worked out at run time) has no bound: `inf`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from functools import reduce
from math import inf
from typing import Protocol, TypeAlias

import msgspec

from planner_reactor.rs.expressions import EvaluationError, evaluate, is_number
from planner_reactor.rs.terms import (
    All,
    Call,
    Cond,
    Disable,
    Expression,
    If,
    Loop,
    Not,
    Par,
    Parameter,
    Process,
    Schema,
    Seq,
    Spawn,
    Symbol,
    Text,
    Value,
    Variable,
    calls,
)
from planner_reactor.rs.vocabulary import BUILT_IN, Signature

Served: TypeAlias = Callable[[str], tuple[Process, ...]]
"""The bodies that may serve an instance of a situation."""

Scope: TypeAlias = Mapping[str, Value]
"""Parameters whose values are known."""

NEVER = -inf
"""The time of an outcome that cannot be."""

DEEPEST = 60
"""Calls within calls that are followed: beyond, a definition is taken to call itself."""


class Definitions(Protocol):
    """What a name means: a program, or the reactions of a reactor."""

    def clauses(self, name: str) -> tuple[Schema, ...]: ...


class Latest(msgspec.Struct, frozen=True):
    """The latest end in seconds: by stop, by abort (`NEVER` if it cannot be), and at all (`inf`: it need not end)."""

    ok: float
    ab: float
    end: float


OVER = Latest(0.0, 0.0, 0.0)
STOPPED = Latest(0.0, NEVER, 0.0)
ABORTED = Latest(NEVER, 0.0, 0.0)
ENDLESS = Latest(inf, inf, inf)


class Bounds:
    """Bounds of processes, given the program, the signatures of its leaves and what serves each situation.

    `limits` are those of basic processes, where they are longer than the windows. `known` are bounds of situations
    (seconds), which are not worked out again.
    """

    def __init__(
        self,
        program: Definitions,
        signatures: Mapping[str, Signature],
        limits: Mapping[str, float],
        served: Served,
        known: Mapping[str, float] | None = None,
    ) -> None:
        self._program = program
        self._signatures = signatures
        self._limits = limits
        self._served = served
        self._situations = dict(known or {})
        self._calls: dict[tuple[object, ...], Latest] = {}
        self._depth = 0

    def drains(self, situations: Iterable[str]) -> float:
        """Seconds in which these situations have been drained, one after the other."""
        return sum(self.situation(name) for name in situations)

    def situation(self, name: str) -> float:
        """Seconds in which every instance of this situation in service has ended, once it is drained."""
        if name not in self._situations:
            self._situations[name] = inf  # asserted from below itself: no bound
            bodies = self._served(name)
            # an instance is complete when its descendants are, also those whose ASSERT a `#` has aborted
            below = [self.going(call).end for body in bodies for call in self._asserts(body)]
            self._situations[name] = max([self.going(body).end for body in bodies] + below, default=0.0)
        return self._situations[name]

    def going(self, process: Process, scope: Scope = {}) -> Latest:  # noqa: B006  # never changed
        """From wherever the process, begun before the drain, may be to its end."""
        match process:
            case Call(name="ASSERT" | "REASSERT", arguments=(Symbol(name) | Text(name), *_)):
                seconds = self.situation(name)
                return Latest(seconds, seconds, seconds)
            case Call(name="ASSERT" | "REASSERT"):
                return ENDLESS  # its situation is worked out at run time
            case Call():
                return self._called(process, scope, self.going)
            case Seq(parts) | Cond(parts):
                return either(*(self._from(process, n, scope) for n in range(len(parts))))
            case Par(parts) | All(parts):
                join = _any if isinstance(process, Par) else _all
                return reduce(join, [either(self.going(part, scope), OVER) for part in parts])
            case Disable(parts):
                return reduce(_first, [self.going(part, scope) for part in parts])
            case Not(body):
                return _swapped(self.going(body, scope))
            case If(test, then, otherwise):
                tested = _if(self.going(test, scope), self.fresh(then, scope), self.fresh(otherwise, scope))
                return either(tested, self.going(then, scope), self.going(otherwise, scope))
            case Loop(condition, body) | Spawn(condition, body):
                return self._loop(process, self.going(condition, scope), self.going(body, scope), scope)

    def _asserts(self, process: Process) -> Iterator[Call]:
        """Every ASSERT in it, and in what it calls."""
        waiting, seen = [process], set[str]()
        while waiting:
            for call in calls(waiting.pop()):
                if call.name in ("ASSERT", "REASSERT"):
                    yield call
                elif call.name not in seen:
                    seen.add(call.name)
                    waiting += [schema.body for schema in self._program.clauses(call.name)]

    def fresh(self, process: Process, scope: Scope = {}) -> Latest:  # noqa: B006  # never changed
        """From its beginning below a withdrawn instance to its end: every ASSERT in it fails at once."""
        match process:
            case Call(name="ASSERT" | "REASSERT"):
                return ABORTED
            case Call():
                return self._called(process, scope, self.fresh)
            case Seq() | Cond():
                return self._from(process, 0, scope, fresh=True)
            case Par(parts):
                return reduce(_any, [self.fresh(part, scope) for part in parts])
            case All(parts):
                return reduce(_all, [self.fresh(part, scope) for part in parts])
            case Disable(parts):
                return reduce(_first, [self.fresh(part, scope) for part in parts])
            case Not(body):
                return _swapped(self.fresh(body, scope))
            case If(test, then, otherwise):
                return _if(self.fresh(test, scope), self.fresh(then, scope), self.fresh(otherwise, scope))
            case Loop(condition, _) | Spawn(condition, _):
                return self._loop(process, self.fresh(condition, scope), None, scope)

    def _from(self, chain: Seq | Cond, at: int, scope: Scope, *, fresh: bool = False) -> Latest:
        """A chain of which this part begins, or is under way."""
        latest = (self.fresh if fresh else self.going)(chain.parts[at], scope)
        for part in chain.parts[at + 1 :]:
            after = self.fresh(part, scope)
            so_far = latest.end if isinstance(chain, Seq) else latest.ok
            aborted = NEVER if isinstance(chain, Seq) else latest.ab
            ended = latest.end if isinstance(chain, Cond) else NEVER
            latest = Latest(
                _sum(so_far, after.ok), max(aborted, _sum(so_far, after.ab)), max(ended, _sum(so_far, after.end))
            )
        return latest

    def _loop(self, loop: Loop | Spawn, now: Latest, under_way: Latest | None, scope: Scope) -> Latest:
        """N8: it ends by the abort of its condition alone; once that has aborted, when its bodies have ended."""
        again = self.fresh(loop.condition, scope)
        if again.ok != NEVER:
            return ENDLESS
        body = self.fresh(loop.body, scope).end if now.ok != NEVER else NEVER  # one round more
        last = max(_sum(now.ok, body), _sum(now.ok, again.end)) if isinstance(loop, Spawn) else \
            _sum(now.ok, _sum(body, again.end))  # fmt: skip
        if under_way is not None:
            last = max(last, under_way.end if isinstance(loop, Spawn) else _sum(under_way.end, again.end))
        end = max(now.end, last)
        return Latest(end if isinstance(loop, Spawn) else NEVER, end, end)

    # -- calls

    def _called(self, call: Call, scope: Scope, ask: Callable[[Process, Scope], Latest]) -> Latest:
        match call.name, call.arguments:
            case "STOP", _:
                return STOPPED
            case "ABORT", _:
                return ABORTED
            case ("Delay" | "Term"), (amount,):
                return _passing(amount, scope, 1.0)
            case "SUSPEND", (amount,):
                return _passing(amount, scope, 1000.0)
        clauses = self._program.clauses(call.name)
        return self._defined(call, clauses, scope, ask) if clauses else self._basic(call)

    def _basic(self, call: Call) -> Latest:
        """A basic process may abort by mistake at any age, a built-in one for want of a value."""
        own = self._signatures.get(call.name)
        signature = own or BUILT_IN.get(call.name)
        if signature is None:
            return ENDLESS
        seconds = signature.window[1] if signature.window is not None else inf
        seconds = max(seconds, self._limits.get(call.name, 0.0))
        aborts = "abort" in signature.outcomes or call.name not in BUILT_IN
        mistaken = 0.0 if any(isinstance(argument, Variable) for argument in call.arguments) else NEVER
        return Latest(seconds if "stop" in signature.outcomes else NEVER, seconds if aborts else mistaken, seconds)

    def _defined(
        self, call: Call, clauses: Iterable[Schema], scope: Scope, ask: Callable[[Process, Scope], Latest]
    ) -> Latest:
        values = tuple(_value(argument, scope) for argument in call.arguments)
        asked = (ask == self.going, call.name, repr(values))
        if asked in self._calls or self._depth >= DEEPEST:
            return self._calls.get(asked, ENDLESS)
        self._calls[asked] = ENDLESS  # it calls itself: no bound
        ways = [ABORTED]  # no clause may apply
        self._depth += 1
        for schema in clauses:
            heads = tuple(zip(schema.head, values, strict=False))
            if all(isinstance(head, Parameter) or value in (None, head.value) for head, value in heads):
                known = {h.name: value for h, value in heads if isinstance(h, Parameter) and value is not None}
                ways.append(ask(schema.body, known))
        self._depth -= 1
        self._calls[asked] = either(*ways)
        return self._calls[asked]


def either(*ways: Latest) -> Latest:
    """One of these, nobody knows which."""
    ok = ab = end = NEVER
    for way in ways:
        ok, ab, end = max(ok, way.ok), max(ab, way.ab), max(end, way.end)
    return Latest(ok, ab, end)


def _any(one: Latest, other: Latest) -> Latest:
    """N4. `|` has ended when both have, and stops if one stopped."""
    end = max(one.end, other.end)
    aborts = NEVER not in (one.ab, other.ab)
    stops = max(one.ok, other.ok) != NEVER
    return Latest(end if stops else NEVER, max(one.ab, other.ab) if aborts else NEVER, end)


def _all(one: Latest, other: Latest) -> Latest:
    """N4'. `&` is `|` with stop and abort swapped."""
    return _swapped(_any(_swapped(one), _swapped(other)))


def _first(one: Latest, other: Latest) -> Latest:
    """N5. The first to end decides."""
    ok = max(min(one.ok, other.end), min(other.ok, one.end))
    ab = max(min(one.ab, other.end), min(other.ab, one.end))
    return Latest(ok, ab, min(one.end, other.end))


def _swapped(way: Latest) -> Latest:
    """N3."""
    return Latest(way.ab, way.ok, way.end)


def _if(test: Latest, then: Latest, otherwise: Latest) -> Latest:
    """N10."""
    return Latest(
        max(_sum(test.ok, then.ok), _sum(test.ab, otherwise.ok)),
        max(_sum(test.ok, then.ab), _sum(test.ab, otherwise.ab)),
        max(test.end, _sum(test.ok, then.end), _sum(test.ab, otherwise.end)),
    )


def _sum(one: float, other: float) -> float:
    return NEVER if NEVER in (one, other) else one + other


def _passing(amount: Expression, scope: Scope, per_second: float) -> Latest:
    value = _value(amount, scope)
    if value is None:
        return ENDLESS
    if not is_number(value):
        return ABORTED
    seconds = max(0.0, float(value)) / per_second  # type: ignore[arg-type]  # is a number
    return Latest(seconds, NEVER, seconds)


def _value(expression: Expression, scope: Scope) -> Value:
    """Its value, or None if it is known only at run time."""
    try:
        return evaluate(expression, scope, {})
    except EvaluationError:
        return None
