"""Has every variable a value when it is used? An analysis of definite binding (N1 to N10 of `semantics`).

For a process it computes which names are surely bound when it stops and when it aborts; `None` stands for
"never ends so", from which everything follows. The rules are those of `evolves`, read for names instead of
bindings:

    P;Q   goes on however P ended     P:Q   Q starts only if P stopped    ~P    swaps
    P|Q   stops if one part stops     P&Q   stops if every part stops     P#Q   only the first to end binds
    A:;B, A::B  end only by the abort of A, and leave what that A bound

An ASSERT that aborts still returns the values of its instance; other processes bind nothing when they abort.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import TypeAlias

from planner_reactor.errors import Diagnostic, Place, nearest
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

Bound: TypeAlias = frozenset[str] | None
"""The names that are surely bound; None where control never comes."""

Ends: TypeAlias = tuple[Bound, Bound]
"""What is bound when a process stops, and when it aborts."""

NOTHING: frozenset[str] = frozenset()


def check_bindings(linked: Linked) -> Iterator[Diagnostic]:
    """Errors "unbound" and warnings "may-be-unbound"."""
    unknown: Ends = (None, None)
    ends = solve(linked.calls_in_focus, unknown, lambda n, known: _Walk(linked, known, n).schema_ends())
    for number in linked.focus:
        walk = _Walk(linked, ends, number)
        stops, _ = walk.schema_ends()
        yield from walk.findings
        yield from _results(linked, number, stops)


def _results(linked: Linked, number: int, stops: Bound) -> Iterator[Diagnostic]:
    schema = linked.schemas[number]
    leaving = _leaving(schema.body) if schema.results else NOTHING
    for name in schema.results:
        if name not in leaving:
            hint = nearest(name, leaving) or "results are bound as in IN[p]<x>, and leave no body of a loop"
            yield error(schema.place, "unbound", f"nothing in {schema.name} binds its result {name}", hint)
        elif stops is not None and name not in stops:
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

    def schema_ends(self) -> Ends:
        """How the whole definition ends; only its results leave it."""
        stops, aborts = self.ends(self._schema.body, frozenset(self._schema.parameters))
        results = frozenset(self._schema.results)
        return (None if stops is None else stops & results, None if aborts is None else aborts & results)

    def ends(self, process: Process, scope: Bound) -> Ends:
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
                all_stops, all_aborts = zip(*(self.ends(p, scope) for p in parts), strict=True)
                return _at_least_one(all_stops, all_aborts), _and(*all_aborts)
            case All(parts):
                all_stops, all_aborts = zip(*(self.ends(p, scope) for p in parts), strict=True)
                return _and(*all_stops), _at_least_one(all_aborts, all_stops)
            case Disable(parts):
                all_stops, all_aborts = zip(*(self.ends(p, scope) for p in parts), strict=True)
                return _or(*all_stops), _or(*all_aborts)
            case Not(body):
                stops, aborts = self.ends(body, scope)
                return aborts, stops
            case Loop(condition, body) | Spawn(condition, body):
                stops, aborts = self.ends(condition, scope)
                self.ends(body, _and(scope, stops))
                return None, aborts
            case If(test, then, otherwise):
                stops, aborts = self.ends(test, scope)
                then_stops, then_aborts = self.ends(then, _and(scope, stops))
                else_stops, else_aborts = self.ends(otherwise, _and(scope, aborts))
                return (
                    _or(_and(stops, then_stops), _and(aborts, else_stops)),
                    _or(_and(stops, then_aborts), _and(aborts, else_aborts)),
                )

    def _seq(self, parts: tuple[Process, ...], scope: Bound) -> Ends:
        bound: Bound = NOTHING
        for part in parts[:-1]:
            bound = _and(bound, _or(*self.ends(part, _and(scope, bound))))
        stops, aborts = self.ends(parts[-1], _and(scope, bound))
        return _and(bound, stops), _and(bound, aborts)

    def _cond(self, parts: tuple[Process, ...], scope: Bound) -> Ends:
        bound: Bound = NOTHING
        aborted: Bound = None
        for part in parts:
            stops, aborts = self.ends(part, _and(scope, bound))
            aborted = _or(aborted, _and(bound, aborts))
            bound = _and(bound, stops)
        return bound, aborted

    def _call(self, call: Call) -> Ends:
        named = frozenset(call.results)
        signature = self._linked.signatures.get(call.name)
        if signature is not None:
            on_abort = named if call.name == "ASSERT" else NOTHING
            outcomes = signature.outcomes
            return (named if "stop" in outcomes else None), (on_abort if "abort" in outcomes else None)
        targets = self._linked.targets(call)
        if not targets:
            return named, NOTHING
        stops, aborts = zip(*(self._returned(call, target) for target in targets), strict=True)
        return _or(*stops), _or(*aborts)

    def _returned(self, call: Call, target: int) -> Ends:
        """What one clause binds, under the names that the call gives to its results."""
        names = dict(zip(self._linked.schemas[target].results, call.results, strict=False))
        stops, aborts = self._known[target]
        return (
            None if stops is None else frozenset(names[n] for n in stops if n in names),
            None if aborts is None else frozenset(names[n] for n in aborts if n in names),
        )

    def _uses(self, call: Call, scope: Bound) -> None:
        for name in names(call.arguments):
            place = name.place or call.place
            if isinstance(name, Variable) and scope is not None and name.name not in scope:
                message, hint = f"{name.name} may be unbound here", _binder(self._binders.get(name.name))
                self.findings.append(warning(place, "may-be-unbound", message, hint))
            elif isinstance(name, Symbol) and name.name in self._binders:
                bound_at = self._binders[name.name]
                where = f" at {bound_at.line}:{bound_at.column}" if bound_at else ""
                hint = f"the result {name.name} bound{where} does not reach this place"
                self.findings.append(error(place, "unbound", f"{name.name} is not bound here", hint))


def _leaving(process: Process) -> frozenset[str]:
    """The names that a process may bind for what follows it."""
    match process:
        case Call(_, _, results):
            return frozenset(results)
        case Loop(condition, _) | Spawn(condition, _):
            return _leaving(condition)
        case _:
            return frozenset().union(*map(_leaving, operands(process)))


def _and(*bounds: Bound) -> Bound:
    """What is bound where all of these are."""
    found: frozenset[str] = NOTHING
    for bound in bounds:
        if bound is None:
            return None
        found |= bound
    return found


def _or(*bounds: Bound) -> Bound:
    """What is bound where one of these is, nobody knows which."""
    possible = [b for b in bounds if b is not None]
    return possible[0].intersection(*possible[1:]) if possible else None


def _at_least_one(so: Sequence[Bound], other: Sequence[Bound]) -> Bound:
    """What is bound when all parts have ended, at least one of them so (their names are disjoint)."""
    able = [i for i, bound in enumerate(so) if bound is not None]
    if not able:
        return None
    always = [_or(a, b) for a, b in zip(so, other, strict=True)]
    if len(able) == 1:
        always[able[0]] = so[able[0]]
    return _and(*always)


def _binder(place: Place | None) -> str:
    return f"what binds it{f', at {place.line}:{place.column},' if place else ''} may abort or lose a `#`"
