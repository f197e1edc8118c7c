"""Has every variable a value when it is used? An analysis of definite binding (N1 to N10 of `semantics`).

For a process it computes which names are surely bound when it stops and when it aborts, by the rules of
`evolves` read for names instead of bindings:

    P;Q   goes on however P ended     P:Q   Q starts only if P stopped    ~P    swaps
    P|Q   stops if one part stops     P&Q   stops if every part stops     P#Q   only the first to end binds
    A:;B, A::B  end only by the abort of A, and leave what that A bound

A set of names is an integer with a bit for each name, so that `|` joins what is surely bound here *and*
there, and `&` leaves what is surely bound here *or* there, nobody knows which. NEVER, all bits, stands where
control never comes: everything holds there. An ASSERT that aborts still returns the values of its instance;
other processes bind nothing when they abort.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import reduce
from operator import and_, or_
from typing import TypeAlias

from planner_reactor.errors import Diagnostic, Place
from planner_reactor.rs.facts import names
from planner_reactor.rs.graphs import solve
from planner_reactor.rs.linking import Linked, error, warning
from planner_reactor.rs.terms import (
    All,
    Call,
    Cond,
    Disable,
    If,
    Loop,
    Not,
    Par,
    Process,
    Seq,
    Spawn,
    Symbol,
    Variable,
    operands,
)

NOTHING = 0
NEVER = -1

Ends: TypeAlias = tuple[int, int]
"""What is surely bound when a process stops, and when it aborts; of a definition, a bit for each of its
results."""


def check_bindings(linked: Linked) -> Iterator[Diagnostic]:
    """Errors "unbound" and warnings "may-be-unbound"."""
    unknown: Ends = (NEVER, NEVER)
    ends = solve(linked.calls_in_focus, unknown, lambda n, known: _Walk(linked, known, n).of_results())
    for number in linked.focus:
        walk = _Walk(linked, ends, number)
        stops, _ = walk.of_results()
        yield from walk.findings
        yield from _results(linked, number, stops)


def _results(linked: Linked, number: int, stops: int) -> Iterator[Diagnostic]:
    schema = linked.schemas[number]
    leaving = set(_leaving(schema.body)) if schema.results else set()
    for position, name in enumerate(schema.results):
        if name not in leaving:
            hint = linked.nearest(name, leaving)
            hint = hint or "results are bound as in IN[p]<x>, and leave no body of a loop"
            yield error(schema.place, "unbound", f"nothing in {schema.name} binds its result {name}", hint)
        elif not stops >> position & 1:
            message = f"{name} may be unbound when {schema.name} stops"
            hint = _binder(linked.facts[number].binders[name])
            yield warning(schema.place, "may-be-unbound", message, hint)


class _Walk:
    """One pass over a definition, given how the definitions that it calls end."""

    def __init__(self, linked: Linked, known: Mapping[int, Ends], number: int) -> None:
        self.findings: list[Diagnostic] = []
        self._linked = linked
        self._known = known
        self._schema = linked.schemas[number]
        self._binders = linked.facts[number].binders
        mentioned = dict.fromkeys((*self._schema.parameters, *self._binders, *self._schema.results))
        self._bits = {name: 1 << position for position, name in enumerate(mentioned)}

    def of_results(self) -> Ends:
        """How the whole definition ends."""
        stops, aborts = self.ends(self._schema.body, self._set(self._schema.parameters))
        return self._positions(stops), self._positions(aborts)

    def ends(self, process: Process, scope: int) -> Ends:
        """What `process` itself binds when it starts where `scope` is bound."""
        match process:
            case Call():
                self._uses(process, scope)
                return self._call(process)
            case Seq(parts):
                return self._seq(parts, scope)
            case Cond(parts):
                return self._cond(parts, scope)
            case Par(parts):
                stops, aborts = zip(*(self.ends(p, scope) for p in parts), strict=True)
                return _at_least_one(stops, aborts), reduce(or_, aborts)
            case All(parts):
                stops, aborts = zip(*(self.ends(p, scope) for p in parts), strict=True)
                return reduce(or_, stops), _at_least_one(aborts, stops)
            case Disable(parts):
                stops, aborts = zip(*(self.ends(p, scope) for p in parts), strict=True)
                return reduce(and_, stops), reduce(and_, aborts)
            case Not(body):
                stop, abort = self.ends(body, scope)
                return abort, stop
            case Loop(condition, body) | Spawn(condition, body):
                stop, abort = self.ends(condition, scope)
                self.ends(body, scope | stop)
                return NEVER, abort
            case If(test, then, otherwise):
                stop, abort = self.ends(test, scope)
                then_stop, then_abort = self.ends(then, scope | stop)
                else_stop, else_abort = self.ends(otherwise, scope | abort)
                return (stop | then_stop) & (abort | else_stop), (stop | then_abort) & (abort | else_abort)

    def _seq(self, parts: tuple[Process, ...], scope: int) -> Ends:
        bound = NOTHING
        for part in parts[:-1]:
            stop, abort = self.ends(part, scope | bound)
            bound |= stop & abort
        stop, abort = self.ends(parts[-1], scope | bound)
        return bound | stop, bound | abort

    def _cond(self, parts: tuple[Process, ...], scope: int) -> Ends:
        bound, aborted = NOTHING, NEVER
        for part in parts:
            stop, abort = self.ends(part, scope | bound)
            aborted &= bound | abort
            bound |= stop
        return bound, aborted

    def _call(self, call: Call) -> Ends:
        named = self._set(call.results)
        signature = self._linked.signatures.get(call.name)
        if signature is not None:
            on_abort = named if call.name == "ASSERT" else NOTHING
            outcomes = signature.outcomes
            return (named if "stop" in outcomes else NEVER), (on_abort if "abort" in outcomes else NEVER)
        targets = self._linked.targets(call)
        if not targets:
            return named, NOTHING
        stop = reduce(and_, (self._known[target][0] for target in targets))
        abort = reduce(and_, (self._known[target][1] for target in targets))
        return self._named(call, stop), self._named(call, abort)

    def _set(self, names: Iterable[str]) -> int:
        return reduce(or_, (self._bits[name] for name in names), NOTHING)

    def _positions(self, bound: int) -> int:
        """From the names of this definition to the positions of its results."""
        if bound == NEVER:
            return NEVER
        return reduce(or_, (1 << i for i, r in enumerate(self._schema.results) if bound & self._bits[r]), 0)

    def _named(self, call: Call, positions: int) -> int:
        """From the positions of a definition's results to the names that a call gives them."""
        if positions == NEVER:
            return NEVER
        return self._set(name for i, name in enumerate(call.results) if positions >> i & 1)

    def _uses(self, call: Call, scope: int) -> None:
        for name in names(call.arguments):
            place = name.place or call.place
            if isinstance(name, Variable) and not scope & self._bits.get(name.name, 0):
                message, hint = f"{name.name} may be unbound here", _binder(self._binders.get(name.name))
                self.findings.append(warning(place, "may-be-unbound", message, hint))
            elif isinstance(name, Symbol) and name.name in self._binders:
                bound_at = self._binders[name.name]
                where = f" at {bound_at.line}:{bound_at.column}" if bound_at else ""
                hint = f"the result {name.name} bound{where} does not reach this place"
                self.findings.append(error(place, "unbound", f"{name.name} is not bound here", hint))


def _leaving(process: Process) -> Iterator[str]:
    """The names that a process may bind for what follows it."""
    match process:
        case Call(_, _, results):
            yield from results
        case Loop(condition, _) | Spawn(condition, _):
            yield from _leaving(condition)
        case _:
            for part in operands(process):
                yield from _leaving(part)


def _at_least_one(so: Sequence[int], other: Sequence[int]) -> int:
    """What is bound when all parts have ended, at least one of them so (their names are disjoint)."""
    able = [i for i, bound in enumerate(so) if bound != NEVER]
    if not able:
        return NEVER
    always = [one & another for one, another in zip(so, other, strict=True)]
    if len(able) == 1:
        always[able[0]] = so[able[0]]
    return reduce(or_, always)


def _binder(place: Place | None) -> str:
    return f"what binds it{f', at {place.line}:{place.column},' if place else ''} may abort or lose a `#`"
