"""What names are used for: which constants reach which arguments of basic processes, through any number of
calls.

A parameter handed on to `IN` as its port is itself used as a port; `flows` finds this for all definitions at
once. `uses` then collects, for each *sink* (an argument of a basic process), the constants that reach it, and
whether other values may. The checks of kinds, ports and situations rest on this. Expressions other than plain
names are only known when the program runs.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import TypeAlias

from planner_reactor.errors import Place
from planner_reactor.rs.graphs import solve
from planner_reactor.rs.linking import Linked, value_of
from planner_reactor.rs.terms import (
    Apply,
    Call,
    Expression,
    Negative,
    Operation,
    Parameter,
    Symbol,
    Variable,
)
from planner_reactor.rs.vocabulary import Kind

Sink: TypeAlias = tuple[str, int]
"""A basic process, or an operator of arithmetic, and the position of one of its arguments."""

ARITHMETIC: Sink = ("+", 0)

Flows: TypeAlias = Mapping[int, Mapping[str, frozenset[Sink]]]
"""For each definition and each of its parameters, the sinks that it reaches."""


@dataclass(slots=True)
class Uses:
    """The constants that reach each sink, with a place, and the sinks that other values reach."""

    constants: dict[Sink, dict[str, Place | None]] = field(default_factory=dict)
    open_sinks: set[Sink] = field(default_factory=set)

    def of(self, sinks: Iterable[Sink]) -> dict[str, Place | None]:
        """The constants that reach any of these sinks."""
        found: dict[str, Place | None] = {}
        for sink in sinks:
            found = {**self.constants.get(sink, {}), **found}
        return found


def flows(linked: Linked) -> Flows:
    """Where the parameters of each definition go. Arguments of kind "any" are not followed."""
    nothing: Mapping[str, frozenset[Sink]] = {}
    return solve(linked.calls_in_focus, nothing, lambda number, known: _flow(linked, number, known))


def uses(linked: Linked, *, among: Collection[int]) -> Uses:
    """What reaches the sinks from the definitions `among`. Those that no other of them calls are called from
    outside, with any arguments."""
    known = flows(linked)
    called = {t for number in among for t in linked.calls[number] if t != number}
    found = Uses()
    for number in among:
        parameters = linked.schemas[number].parameters
        for call, position, argument in _arguments(linked, number):
            sinks = sinks_of(linked, known, call, position)
            value = value_of(argument)
            if isinstance(value, str):
                place = argument.place if isinstance(argument, Symbol) else call.place
                for sink in sinks:
                    found.constants.setdefault(sink, {}).setdefault(value, place)
            elif not (isinstance(argument, Variable) and argument.name in parameters and number in called):
                found.open_sinks.update(sinks)
    return found


def parameter_kind(linked: Linked, sinks: Collection[Sink]) -> Kind:
    """The kind that all these sinks agree on, or "any"."""
    kinds = {_kind(linked, sink) for sink in sinks}
    return kinds.pop() if len(kinds) == 1 else "any"


def sinks_of(linked: Linked, known: Flows, call: Call, position: int) -> frozenset[Sink]:
    """The sinks that an argument of this call reaches."""
    signature = linked.signatures.get(call.name)
    if signature is not None:
        is_any = signature.kind(position) == "any"
        return frozenset() if is_any else frozenset({(call.name, position)})
    found: frozenset[Sink] = frozenset()
    for target in linked.targets(call):
        head = linked.schemas[target].head[position]
        if isinstance(head, Parameter):
            found |= known[target].get(head.name, frozenset())
    return found


def _flow(linked: Linked, number: int, known: Flows) -> Mapping[str, frozenset[Sink]]:
    found: dict[str, frozenset[Sink]] = dict.fromkeys(linked.schemas[number].parameters, frozenset())
    for call, position, argument in _arguments(linked, number):
        if isinstance(argument, Variable) and argument.name in found:
            found[argument.name] |= sinks_of(linked, known, call, position)
        for name in _calculated(argument):
            if name in found:
                found[name] |= {ARITHMETIC}
    return found


def _arguments(linked: Linked, number: int) -> Iterator[tuple[Call, int, Expression]]:
    for call in linked.facts[number].calls:
        for position, argument in enumerate(call.arguments):
            yield call, position, argument


def _calculated(expression: Expression) -> Iterator[str]:
    """The variables that arithmetic is done on."""
    match expression:
        case Negative(operand):
            yield from _operands((operand,))
        case Operation("+" | "-" | "*" | "/", left, right):
            yield from _operands((left, right))
        case Operation(_, left, right):
            yield from _calculated(left)
            yield from _calculated(right)
        case Apply(_, arguments):
            for argument in arguments:
                yield from _calculated(argument)


def _operands(operands: tuple[Expression, ...]) -> Iterator[str]:
    for operand in operands:
        if isinstance(operand, Variable):
            yield operand.name
        yield from _calculated(operand)


def _kind(linked: Linked, sink: Sink) -> Kind:
    name, position = sink
    kind: Kind = "number" if sink == ARITHMETIC else linked.signatures[name].kind(position)
    return "number" if kind in ("instance", "label") else kind
