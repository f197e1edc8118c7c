"""What an RS program is made of: processes, expressions, schemas, programs.

A *process* is a term over the composition operators of R §4.2 (`;` `:` `|` `#` `~` `:;` `::`, with `&` and `if`
added by us). A *schema* names a process and gives it parameters and results (R Fig. 2); a *program* is a set of
schemas. All are immutable values: equality ignores where in a text they stood.

`Seq`, `Cond`, `Par`, `All` and `Disable` hold two or more parts; the first two associate to the right, so a `Seq`
never ends in a `Seq` (build them with `seq` and `cond`, which flatten). This module knows no text: see `parser`
and `printer`.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import TypeAlias

import msgspec

from planner_reactor.errors import Place
from planner_reactor.rs.unknowns import Symbolic, equal

Value: TypeAlias = object
"""A run-time value: a number, a string (symbols are their names), a boolean, or a host's own immutable object."""


# ---------------------------------------------------------------------------------------------- expressions


class Number(msgspec.Struct, frozen=True):
    value: int | float


class Text(msgspec.Struct, frozen=True):
    """A quoted string."""

    value: str


def _differs(own: object, other: object) -> bool:
    """`!=` of those that say themselves what `==` is: a struct's own would compare identities."""
    return not own == other  # noqa: SIM201  # that is what it is for


class Symbol(msgspec.Struct, frozen=True, eq=False):
    """A name that nothing binds: a constant, a port, a situation."""

    name: str
    place: Place | None = None

    def __eq__(self, other: object) -> bool:
        return type(other) is Symbol and self.name == other.name

    __ne__ = _differs

    def __hash__(self) -> int:
        return hash(self.name)


class Variable(msgspec.Struct, frozen=True, eq=False):
    """A name bound by a parameter or by the result of an earlier process."""

    name: str
    place: Place | None = None

    def __eq__(self, other: object) -> bool:
        return type(other) is Variable and self.name == other.name

    __ne__ = _differs

    def __hash__(self) -> int:
        return hash(self.name)


class Negative(msgspec.Struct, frozen=True):
    operand: Expression


class Operation(msgspec.Struct, frozen=True):
    """`+ - * /` on numbers, `== /= < <= > >=` on values."""

    operator: str
    left: Expression
    right: Expression


class Apply(msgspec.Struct, frozen=True, eq=False):
    """A pure function that the host registered, applied to arguments."""

    function: str
    arguments: tuple[Expression, ...]
    place: Place | None = None

    def __eq__(self, other: object) -> bool:
        return type(other) is Apply and (self.function, self.arguments) == (other.function, other.arguments)

    __ne__ = _differs

    def __hash__(self) -> int:
        return hash((self.function, self.arguments))


Expression: TypeAlias = Number | Text | Symbol | Variable | Negative | Operation | Apply


# ------------------------------------------------------------------------------------------------ processes


class Call(msgspec.Struct, frozen=True, eq=False):
    """`Name[arguments]<results>`: an instance of a schema, of a basic process or of a built-in one."""

    name: str
    arguments: tuple[Expression, ...] = ()
    results: tuple[str, ...] = ()
    place: Place | None = None

    def __eq__(self, other: object) -> bool:
        return type(other) is Call and (self.name, self.arguments, self.results) == (
            other.name,
            other.arguments,
            other.results,
        )

    __ne__ = _differs

    def __hash__(self) -> int:
        return hash((self.name, self.arguments, self.results))


class Seq(msgspec.Struct, frozen=True, cache_hash=True):
    """`P;Q`: Q follows P, however P ended."""

    parts: tuple[Process, ...]


class Cond(msgspec.Struct, frozen=True, cache_hash=True):
    """`P:Q`: Q follows P if P stopped."""

    parts: tuple[Process, ...]


class Par(msgspec.Struct, frozen=True, cache_hash=True):
    """`P|Q`: side by side; stops if at least one part stops."""

    parts: tuple[Process, ...]


class All(msgspec.Struct, frozen=True, cache_hash=True):
    """`P&Q`: side by side; stops only if every part stops."""

    parts: tuple[Process, ...]


class Disable(msgspec.Struct, frozen=True, cache_hash=True):
    """`P#Q`: side by side; the first part to end decides and the others are aborted."""

    parts: tuple[Process, ...]


class Not(msgspec.Struct, frozen=True, cache_hash=True):
    """`~P`: stop and abort swapped."""

    body: Process


class Loop(msgspec.Struct, frozen=True, cache_hash=True):
    """`A:;B`, synchronous recurrent: while A stops, do B."""

    condition: Process
    body: Process


class Spawn(msgspec.Struct, frozen=True, cache_hash=True):
    """`A::B`, asynchronous recurrent: whenever A stops, spawn a B and go on."""

    condition: Process
    body: Process


class If(msgspec.Struct, frozen=True, cache_hash=True):
    """`if C then P else Q`: C decides once."""

    test: Process
    then: Process
    otherwise: Process


Process: TypeAlias = Call | Seq | Cond | Par | All | Disable | Not | Loop | Spawn | If

STOP = Call("STOP")
ABORT = Call("ABORT")
NIL = Call("NIL")


def seq(*parts: Process) -> Process:
    """`P;Q;…`, flattened at its right end; one part alone is itself."""
    return _chain(Seq, parts)


def cond(*parts: Process) -> Process:
    """`P:Q:…`, flattened at its right end; one part alone is itself."""
    return _chain(Cond, parts)


def _chain(kind: type[Seq] | type[Cond], parts: tuple[Process, ...]) -> Process:
    if len(parts) == 1:
        return parts[0]
    last = parts[-1]
    return kind((*parts[:-1], *last.parts)) if isinstance(last, kind) else kind(parts)


def operands(process: Process) -> tuple[Process, ...]:
    """The processes that a process is directly composed of, left to right."""
    match process:
        case Call():
            return ()
        case Seq(parts) | Cond(parts) | Par(parts) | All(parts) | Disable(parts):
            return parts
        case Not(body):
            return (body,)
        case Loop(condition, body) | Spawn(condition, body):
            return (condition, body)
        case If(test, then, otherwise):
            return (test, then, otherwise)


def calls(process: Process) -> Iterator[Call]:
    """Every call in a process, left to right (no recursion: a term may be deep)."""
    waiting = [process]
    while waiting:
        term = waiting.pop()
        if isinstance(term, Call):
            yield term
        else:
            waiting.extend(reversed(operands(term)))


# ------------------------------------------------------------------------------------- schemas and programs


class Parameter(msgspec.Struct, frozen=True):
    """A formal parameter of a definition's head: a bare name."""

    name: str


Head: TypeAlias = Parameter | Number | Text


class Schema(msgspec.Struct, frozen=True, eq=False):
    """`name[head]<results> = body`. A constant in the head makes it a clause chosen by value (`SP[6] = …`)."""

    name: str
    head: tuple[Head, ...]
    results: tuple[str, ...]
    body: Process
    place: Place | None = None

    def __eq__(self, other: object) -> bool:
        return type(other) is Schema and (self.name, self.head, self.results, self.body) == (
            other.name,
            other.head,
            other.results,
            other.body,
        )

    __ne__ = _differs

    def __hash__(self) -> int:
        return hash((self.name, self.head, self.results, self.body))

    @property
    def parameters(self) -> tuple[str, ...]:
        return tuple(h.name for h in self.head if isinstance(h, Parameter))

    def accepts(self, values: tuple[Value, ...]) -> bool:
        """Does this clause apply to these argument values?"""
        if len(values) != len(self.head):
            return False
        return all(
            isinstance(h, Parameter) or h.value == v or (isinstance(v, Symbolic) and equal(v, h.value))
            for h, v in zip(self.head, values, strict=True)
        )


class Program:
    """An immutable set of schemas, in order of definition; `with_schemas` and `without` make another."""

    __slots__ = ("_by_name", "_schemas")

    def __init__(self, schemas: Iterable[Schema] = ()) -> None:
        self._schemas = tuple(schemas)
        by_name: dict[str, list[Schema]] = {}
        for schema in self._schemas:
            by_name.setdefault(schema.name, []).append(schema)
        self._by_name = {name: tuple(clauses) for name, clauses in by_name.items()}

    @property
    def schemas(self) -> tuple[Schema, ...]:
        return self._schemas

    @property
    def names(self) -> frozenset[str]:
        return frozenset(self._by_name)

    def clauses(self, name: str) -> tuple[Schema, ...]:
        return self._by_name.get(name, ())

    def select(self, name: str, values: tuple[Value, ...]) -> Schema | None:
        """The one clause that applies (that no two do is checked when a program is loaded), or None."""
        return next((s for s in self.clauses(name) if s.accepts(values)), None)

    def with_schemas(self, schemas: Iterable[Schema]) -> Program:
        return Program((*self._schemas, *schemas))

    def without(self, schemas: Iterable[Schema]) -> Program:
        gone = set(schemas)
        return Program(s for s in self._schemas if s not in gone)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Program) and self._schemas == other._schemas

    def __hash__(self) -> int:
        return hash(self._schemas)

    def __len__(self) -> int:
        return len(self._schemas)

    def __repr__(self) -> str:
        return f"Program({', '.join(sorted(self._by_name))})"
