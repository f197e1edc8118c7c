"""Which names are bound, and where (`semantics`, Syntax; R §4.1: in-parameters and out-results).

A name bound by a parameter or by a result is a `Variable`, any other a `Symbol`. Results reach

    rightwards through `;` and `:`,  from the condition of a loop into its body and out of the loop,
    from the test of an `if` into both branches,

and nowhere else: not to the siblings of `|` `&` `#`, not out of the body of a loop. The parts of `|` `&` `#`
bind different names; the branches of an `if` may bind the same; no name is bound twice where it is already in
scope. Whether a variable has a value when it is used is for `bindings`. Terms that are too deep are refused
here.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace

from planner_reactor.errors import Diagnostic, Place
from planner_reactor.rs.terms import (
    All,
    Apply,
    Call,
    Cond,
    Disable,
    Expression,
    If,
    Loop,
    Negative,
    Not,
    Operation,
    Par,
    Process,
    Schema,
    Seq,
    Spawn,
    Symbol,
    Variable,
)

Names = Mapping[str, Place | None]
"""Names in scope, each with the place that binds it."""

NO_NAMES: Names = {}
NOWHERE = Place(1, 1)


def resolve(schema: Schema, *, depth: int) -> tuple[Schema, list[Diagnostic]]:
    """The schema with its variables told from its symbols, and what is wrong with its names."""
    resolver = _Resolver(schema.place or NOWHERE, depth)
    resolver.head(schema)
    try:
        body, _ = resolver.process(schema.body, dict.fromkeys(schema.parameters, schema.place), 1)
    except _TooDeep:
        return schema, [_too_deep(schema.place, depth)]
    return replace(schema, body=body), resolver.findings


def resolve_process(
    process: Process, *, bound: Iterable[str], depth: int
) -> tuple[Process, list[Diagnostic]]:
    """The same for a process alone, within which the names in `bound` are variables."""
    resolver = _Resolver(NOWHERE, depth)
    try:
        resolved, _ = resolver.process(process, dict.fromkeys(bound), 1)
    except _TooDeep:
        return process, [_too_deep(None, depth)]
    return resolved, resolver.findings


def _too_deep(place: Place | None, depth: int) -> Diagnostic:
    hint = "give an inner part a name and a definition of its own"
    return Diagnostic(place or NOWHERE, "error", "too-deep", f"a term more than {depth} levels deep", hint)


class _TooDeep(Exception):
    """The term is deeper than its budget."""


class _Resolver:
    def __init__(self, where: Place, deepest: int) -> None:
        self.findings: list[Diagnostic] = []
        self._where = where
        self._deepest = deepest

    def wrong(self, place: Place | None, code: str, message: str, hint: str = "") -> None:
        self.findings.append(Diagnostic(place or self._where, "error", code, message, hint))

    def head(self, schema: Schema) -> None:
        """Parameters and results: each name once."""
        seen: set[str] = set()
        for name in (*schema.parameters, *schema.results):
            if name in seen:
                message = f"{name} stands twice in the head of {schema.name}"
                self.wrong(schema.place, "rebound", message, RENAME)
            seen.add(name)

    def process(self, process: Process, scope: Names, depth: int) -> tuple[Process, Names]:
        """The process with its variables, and the names that it binds for what follows it."""
        if depth > self._deepest:
            raise _TooDeep
        match process:
            case Call(name, arguments, results, place):
                bound = self._results(results, place, scope) if results else NO_NAMES
                if not arguments:
                    return process, bound
                resolved = tuple([self._expression(a, scope, depth + 1) for a in arguments])
                return Call(name, resolved, results, place), bound
            case Seq(parts) | Cond(parts):
                sequence, bound = self._sequence(parts, scope, depth)
                return type(process)(sequence), bound
            case Par(parts) | All(parts) | Disable(parts):
                siblings, bound = self._siblings(parts, scope, depth)
                return type(process)(siblings), bound
            case Not(body):
                body, bound = self.process(body, scope, depth + 1)
                return Not(body), bound
            case Loop(condition, body) | Spawn(condition, body):
                condition, bound = self.process(condition, scope, depth + 1)
                body, _ = self.process(body, {**scope, **bound}, depth + 1)
                return type(process)(condition, body), bound
            case If(test, then, otherwise):
                test, bound = self.process(test, scope, depth + 1)
                inside = {**scope, **bound}
                then, of_then = self.process(then, inside, depth + 1)
                otherwise, of_otherwise = self.process(otherwise, inside, depth + 1)
                return If(test, then, otherwise), {**bound, **of_otherwise, **of_then}

    def _sequence(
        self, parts: tuple[Process, ...], scope: Names, depth: int
    ) -> tuple[tuple[Process, ...], Names]:
        resolved: list[Process] = []
        bound = NO_NAMES
        for part in parts:
            part, names = self.process(part, {**scope, **bound} if bound else scope, depth + 1)
            resolved.append(part)
            bound = {**bound, **names} if names else bound
        return tuple(resolved), bound

    def _siblings(
        self, parts: tuple[Process, ...], scope: Names, depth: int
    ) -> tuple[tuple[Process, ...], Names]:
        resolved: list[Process] = []
        bound: dict[str, Place | None] = {}
        for part in parts:
            part, names = self.process(part, scope, depth + 1)
            resolved.append(part)
            for name, place in names.items():
                if name in bound:
                    hint = f"{_bound_at(bound[name])}; parts that run side by side bind different names"
                    self.wrong(place, "clash", f"{name} is bound by two parts that run side by side", hint)
                bound[name] = place
        return tuple(resolved), bound

    def _results(self, results: tuple[str, ...], place: Place | None, scope: Names) -> Names:
        bound: dict[str, Place | None] = {}
        for name in results:
            if name in bound:
                self.wrong(place, "rebound", f"{name} stands twice among these results", RENAME)
            elif name in scope:
                message = f"{name} is bound again within its scope"
                self.wrong(place, "rebound", message, _bound_at(scope[name]))
            bound[name] = place
        return bound

    def _expression(self, expression: Expression, scope: Names, depth: int) -> Expression:
        if depth > self._deepest:
            raise _TooDeep
        match expression:
            case Symbol(name, place):
                return Variable(name, place) if name in scope else expression
            case Negative(operand):
                return Negative(self._expression(operand, scope, depth + 1))
            case Operation(sign, left, right):
                return Operation(
                    sign, self._expression(left, scope, depth + 1), self._expression(right, scope, depth + 1)
                )
            case Apply(function, arguments, place):
                resolved = tuple([self._expression(a, scope, depth + 1) for a in arguments])
                return Apply(function, resolved, place)
            case _:
                return expression


RENAME = "choose another name"


def _bound_at(place: Place | None) -> str:
    return f"it is bound at {place.line}:{place.column} already" if place else "it is bound already"
