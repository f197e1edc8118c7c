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

from collections.abc import Iterable, Iterator, Mapping
from contextlib import ExitStack, contextmanager

from msgspec.structs import replace

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
    resolver = _Resolver(dict.fromkeys(schema.parameters, schema.place), schema.place, depth)
    resolver.head(schema)
    try:
        body, _ = resolver.process(schema.body, 1)
    except _TooDeep:
        return schema, [_too_deep(schema.place, depth)]
    return replace(schema, body=body), resolver.findings


def resolve_process(process: Process, *, bound: Iterable[str], depth: int) -> tuple[Process, list[Diagnostic]]:
    """The same for a process alone, within which the names in `bound` are variables."""
    resolver = _Resolver(dict.fromkeys(bound), None, depth)
    try:
        resolved, _ = resolver.process(process, 1)
    except _TooDeep:
        return process, [_too_deep(None, depth)]
    return resolved, resolver.findings


def _too_deep(place: Place | None, depth: int) -> Diagnostic:
    hint = "give an inner part a name and a definition of its own"
    return Diagnostic(place or NOWHERE, "error", "too-deep", f"a term more than {depth} levels deep", hint)


class _TooDeep(Exception):
    """The term is deeper than its budget."""


class _Resolver:
    """One walk over a process. `scope` holds the names in scope where the walk stands, each with the place that
    binds it; since no name is bound twice in one scope, leaving a scope is taking its names out again."""

    def __init__(self, scope: dict[str, Place | None], where: Place | None, deepest: int) -> None:
        self.findings: list[Diagnostic] = []
        self._scope = scope
        self._where = where
        self._deepest = deepest

    def head(self, schema: Schema) -> None:
        """Parameters and results: each name once."""
        seen: set[str] = set()
        for name in (*schema.parameters, *schema.results):
            if name in seen:
                message = f"{name} stands twice in the head of {schema.name}"
                self._wrong(schema.place, "rebound", message, RENAME)
            seen.add(name)

    def process(self, process: Process, depth: int) -> tuple[Process, Names]:
        """The process with its variables, and the names that it binds for what follows it."""
        if depth > self._deepest:
            raise _TooDeep
        match process:
            case Call(name, arguments, results, place):
                bound = self._results(results, place) if results else NO_NAMES
                if not arguments:
                    return process, bound
                resolved = tuple([self._expression(a, depth + 1) for a in arguments])
                return Call(name, resolved, results, place), bound
            case Seq(parts) | Cond(parts):
                sequence, bound = self._sequence(parts, depth)
                return type(process)(tuple(sequence)), bound
            case Par(parts) | All(parts) | Disable(parts):
                siblings, bound = self._siblings(parts, depth)
                return type(process)(tuple(siblings)), bound
            case Not(body):
                body, bound = self.process(body, depth + 1)
                return Not(body), bound
            case Loop(condition, body) | Spawn(condition, body):
                condition, bound = self.process(condition, depth + 1)
                with self._within(bound):
                    body, _ = self.process(body, depth + 1)
                return type(process)(condition, body), bound
            case If(test, then, otherwise):
                test, bound = self.process(test, depth + 1)
                with self._within(bound):
                    then, of_then = self.process(then, depth + 1)
                    otherwise, of_otherwise = self.process(otherwise, depth + 1)
                return If(test, then, otherwise), {**bound, **of_otherwise, **of_then}

    def _sequence(self, parts: tuple[Process, ...], depth: int) -> tuple[list[Process], Names]:
        resolved: list[Process] = []
        bound: dict[str, Place | None] = {}
        with ExitStack() as scopes:
            for part in parts:
                part, names = self.process(part, depth + 1)
                resolved.append(part)
                bound.update(names)
                if names:
                    scopes.enter_context(self._within(names))
        return resolved, bound

    def _siblings(self, parts: tuple[Process, ...], depth: int) -> tuple[list[Process], Names]:
        resolved: list[Process] = []
        bound: dict[str, Place | None] = {}
        for part in parts:
            part, names = self.process(part, depth + 1)
            resolved.append(part)
            for name, place in names.items():
                if name in bound:
                    hint = f"{_bound_at(bound[name])}; parts that run side by side bind different names"
                    self._wrong(place, "clash", f"{name} is bound by two parts that run side by side", hint)
                bound[name] = place
        return resolved, bound

    @contextmanager
    def _within(self, names: Names) -> Iterator[None]:
        """The scope of these names."""
        entered = [name for name in names if name not in self._scope]
        self._scope.update((name, names[name]) for name in entered)
        yield
        for name in entered:
            del self._scope[name]

    def _results(self, results: tuple[str, ...], place: Place | None) -> Names:
        bound: dict[str, Place | None] = {}
        for name in results:
            if name in bound:
                self._wrong(place, "rebound", f"{name} stands twice among these results", RENAME)
            elif name in self._scope:
                message = f"{name} is bound again within its scope"
                self._wrong(place, "rebound", message, _bound_at(self._scope[name]))
            bound[name] = place
        return bound

    def _expression(self, expression: Expression, depth: int) -> Expression:
        if depth > self._deepest:
            raise _TooDeep
        match expression:
            case Symbol(name, place):
                return Variable(name, place) if name in self._scope else expression
            case Negative(operand):
                return Negative(self._expression(operand, depth + 1))
            case Operation(sign, left, right):
                return Operation(sign, self._expression(left, depth + 1), self._expression(right, depth + 1))
            case Apply(function, arguments, place):
                return Apply(function, tuple([self._expression(a, depth + 1) for a in arguments]), place)
            case _:
                return expression

    def _wrong(self, place: Place | None, code: str, message: str, hint: str) -> None:
        self.findings.append(Diagnostic(place or self._where or NOWHERE, "error", code, message, hint))


RENAME = "choose another name"


def _bound_at(place: Place | None) -> str:
    return f"it is bound at {place.line}:{place.column} already" if place else "it is bound already"
