"""What the calls of a program refer to: the ground on which the static checks stand.

A `Linked` program numbers the definitions of a program in their order and answers which of them a call may
select, given the constants among its arguments. Names of basic and built-in processes refer to their
signatures, whatever a text defines. An *open family* is a name X used as in equation (3) of R §5.3,
`ADD<k> :: (E[k] # X[k])`: its clauses are added while the program runs, so that there may be none yet.

A running program is checked anew with every addition. Only the added definitions, its `focus`, are then
looked at, and those that they lead to; what was there before cannot call what it did not know.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from functools import cached_property
from itertools import chain
from typing import TypeAlias

from planner_reactor.errors import Diagnostic, Place, RSError, nearest
from planner_reactor.rs.facts import Facts, facts_of
from planner_reactor.rs.graphs import reachable
from planner_reactor.rs.terms import (
    Call,
    Expression,
    Number,
    Parameter,
    Program,
    Schema,
    Symbol,
    Text,
    Value,
)
from planner_reactor.rs.vocabulary import Signature

UNKNOWN = object()
"""The value of an argument that is known only when the program runs."""

MOST_HINTS = 20
"""Looking for near names takes time."""

NOWHERE = Place(1, 1)
"""Where a term stands that was not read from a text."""

Calls: TypeAlias = Mapping[int, tuple[int, ...]]
"""Which definitions each definition calls, by number."""


class Linked:
    """A program with what its calls refer to."""

    def __init__(
        self,
        program: Program,
        signatures: Mapping[str, Signature],
        functions: Collection[str],
        *,
        given: int = 0,
        most_links: int = 1_000_000,
    ) -> None:
        """The first `given` definitions have been checked before. A call and a clause that it may select are
        a link."""
        self.schemas: tuple[Schema, ...] = program.schemas
        self.focus = range(given, len(self.schemas))
        self.signatures = signatures
        self.functions = functions
        self.facts: tuple[Facts, ...] = tuple(facts_of(schema.body) for schema in self.schemas)
        self.families = frozenset(name for facts in self.facts for name in facts.families)
        self._most_links = most_links
        self._hints = 0
        self._targets: dict[tuple[Value, ...], list[int]] = {}
        self._by_name: dict[str, list[int]] = {}
        self._by_constants: dict[tuple[Value, ...], list[int]] = {}
        self._general: dict[str, list[int]] = {}
        for number, schema in enumerate(self.schemas):
            self._by_name.setdefault(schema.name, []).append(number)
            key = constants(schema)
            if UNKNOWN in key:
                self._general.setdefault(schema.name, []).append(number)
            else:
                self._by_constants.setdefault(key, []).append(number)

    def clauses(self, name: str) -> list[int]:
        """All definitions of a name."""
        return self._by_name.get(name, [])

    @property
    def names(self) -> Collection[str]:
        """The names that the program defines."""
        return self._by_name.keys()

    def targets(self, call: Call) -> list[int]:
        """The definitions that this call may select, in their order; none for a basic or built-in process."""
        if call.name in self.signatures or call.name not in self._by_name:
            return []
        asked = (call.name, *map(value_of, call.arguments))
        found = self._targets.get(asked)
        if found is None:
            found = self._targets[asked] = self._select(call.name, asked)
        return found

    def _select(self, name: str, asked: tuple[Value, ...]) -> list[int]:
        if UNKNOWN in asked:
            return [n for n in self._by_name[name] if _may_accept(self.schemas[n], asked[1:])]
        general = [n for n in self._general.get(name, ()) if _may_accept(self.schemas[n], asked[1:])]
        return sorted(general + self._by_constants.get(asked, []))

    @cached_property
    def calls(self) -> Calls:
        """The call graph; raises `RSError` if it is too large to be checked."""
        found: dict[int, tuple[int, ...]] = {}
        links = 0
        for number, facts in enumerate(self.facts):
            found[number] = tuple(dict.fromkeys(t for call in facts.calls for t in self.targets(call)))
            links += len(found[number])
            if links > self._most_links:
                message = f"the calls of this program may select more than {self._most_links} clauses"
                raise RSError([error(self.schemas[number].place, "too-many-calls", message)])
        return found

    def nearest(self, name: str, *candidates: Iterable[str]) -> str:
        """`did you mean X?`, or nothing after so many that more would be no help."""
        self._hints += 1
        return nearest(name, sorted({*chain(*candidates)})) if self._hints <= MOST_HINTS else ""

    @cached_property
    def calls_in_focus(self) -> Calls:
        """The part of the call graph that the definitions in focus lead to."""
        if len(self.focus) == len(self.schemas):
            return self.calls
        return {number: self.calls[number] for number in sorted(reachable(self.calls, self.focus))}

    def place(self, number: int) -> Place:
        """Where a definition stands."""
        return self.schemas[number].place or NOWHERE


def constants(schema: Schema) -> tuple[Value, ...]:
    """The name and the constants of a head; a parameter is UNKNOWN."""
    return (schema.name, *(UNKNOWN if isinstance(h, Parameter) else h.value for h in schema.head))


def value_of(argument: Expression) -> Value:
    """The value of an argument as far as the text tells."""
    match argument:
        case Number(value):
            return value
        case Symbol(text) | Text(text):
            return text
        case _:
            return UNKNOWN


def _may_accept(schema: Schema, values: tuple[Value, ...]) -> bool:
    return len(schema.head) == len(values) and all(
        value is UNKNOWN or isinstance(head, Parameter) or head.value == value
        for head, value in zip(schema.head, values, strict=True)
    )


def error(place: Place | None, code: str, message: str, hint: str = "") -> Diagnostic:
    """A finding that stops a program from loading."""
    return Diagnostic(place or NOWHERE, "error", code, message, hint)


def warning(place: Place | None, code: str, message: str, hint: str = "") -> Diagnostic:
    """A finding that does not."""
    return Diagnostic(place or NOWHERE, "warning", code, message, hint)
