"""The definitions that a running executer knows: loaded and unloaded at any time, selected by name and value.

A call asks its `Definition` for the clause that applies to the values of its arguments; clauses with constants in
their heads are found by a dictionary of those constants, so that ten thousand reactions `P[n] = …` are selected from
as fast as one. A clause is compiled when it is first called. What a strand runs stays as it was, whatever is loaded or
unloaded meanwhile.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence

import msgspec

from planner_reactor.errors import InputError
from planner_reactor.rs.terms import Parameter, Schema, Value
from planner_reactor.runtime.strands import Instruction


class Code(msgspec.Struct, frozen=True):
    """A compiled body: where it begins, and what its frame holds beyond the arguments."""

    entry: Instruction
    blank: tuple[Value, ...]


Compile = Callable[[Schema, bool], Code]


class Clause:
    """One schema. Compiled twice at most: with its results exported, and without (then its tail calls are tails)."""

    __slots__ = ("_compile", "_exporting", "plain_code", "schema")

    def __init__(self, schema: Schema, compile_schema: Compile) -> None:
        self.schema = schema
        self._compile = compile_schema
        self.plain_code: Code | None = None
        self._exporting: Code | None = None

    def plain(self) -> Code:
        if (code := self.plain_code) is None:
            code = self.plain_code = self._compile(self.schema, False)
        return code

    def exporting(self) -> Code:
        if (code := self._exporting) is None:
            code = self._exporting = self._compile(self.schema, True)
        return code


class Definition:
    """All clauses of one name."""

    __slots__ = ("_by_constants", "name", "only", "only_arity")

    def __init__(self, name: str) -> None:
        self.name = name
        self._by_constants: dict[tuple[int, tuple[int, ...]], dict[tuple[Value, ...], Clause]] = {}
        self.only: Clause | None = None
        self.only_arity = -1

    def __bool__(self) -> bool:
        return bool(self._by_constants)

    def select(self, values: Sequence[Value]) -> Clause | None:
        """The clause that applies to these values, or None."""
        count = len(values)
        if count == self.only_arity:
            return self.only
        for (arity, positions), clauses in self._by_constants.items():
            if arity == count and (clause := clauses.get(tuple([values[p] for p in positions]))) is not None:
                return clause
        return None

    def add(self, clause: Clause) -> None:
        pattern, constants = _pattern(clause.schema)
        clauses = self._by_constants.setdefault(pattern, {})
        if constants in clauses:
            raise InputError(f"{self.name}: two clauses have the same head")
        clauses[constants] = clause
        if len(clauses) == 1:
            self._find_only()

    def remove(self, schema: Schema) -> bool:
        pattern, constants = _pattern(schema)
        clauses = self._by_constants.get(pattern, {})
        if constants not in clauses:
            return False
        del clauses[constants]
        if not clauses:
            del self._by_constants[pattern]
            self._find_only()
        return True

    def _find_only(self) -> None:
        """If nothing is to be selected by value, selecting is one comparison."""
        self.only, self.only_arity = None, -1
        if len(self._by_constants) == 1:
            [((arity, positions), clauses)] = self._by_constants.items()
            if not positions:
                [self.only] = clauses.values()
                self.only_arity = arity


class Definitions:
    """Definitions by name. Names may be called before they are defined."""

    __slots__ = ("_by_name", "_compile")

    def __init__(self, compile_schema: Compile) -> None:
        self._by_name: dict[str, Definition] = {}
        self._compile = compile_schema

    def named(self, name: str) -> Definition:
        if (found := self._by_name.get(name)) is None:
            found = self._by_name.setdefault(name, Definition(name))  # two threads may ask
        return found

    def compiled(self, schema: Schema, *, now: bool) -> Clause:
        """This clause, to be loaded; compiled `now`, or when it is first called. May be called from any thread."""
        clause = Clause(schema, self._compile)
        if now:
            clause.plain()
        return clause

    def load(self, schemas: Iterable[Schema | Clause]) -> None:
        """Add these clauses: all of them, or none if one clashes with what is there."""
        added: list[Schema] = []
        try:
            for given in schemas:
                clause = given if isinstance(given, Clause) else Clause(given, self._compile)
                self.named(clause.schema.name).add(clause)
                added.append(clause.schema)
        except InputError:
            self.unload(added)
            raise

    def unload(self, schemas: Iterable[Schema]) -> None:
        for schema in schemas:
            self.named(schema.name).remove(schema)

    @property
    def names(self) -> tuple[str, ...]:
        return tuple(name for name, definition in self._by_name.items() if definition)


def _pattern(schema: Schema) -> tuple[tuple[int, tuple[int, ...]], tuple[Value, ...]]:
    if len(schema.head) == 1 and not isinstance(only := schema.head[0], Parameter):  # as reactions have
        return (1, (0,)), (only.value,)
    places = tuple(i for i, h in enumerate(schema.head) if not isinstance(h, Parameter))
    constants = tuple(h.value for h in schema.head if not isinstance(h, Parameter))
    return (len(schema.head), places), constants
