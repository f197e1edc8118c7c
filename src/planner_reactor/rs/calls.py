"""Checks on calls: does the process exist, and is it given what it expects?

Arguments of basic processes have kinds (`vocabulary`); those of definitions have the kind of what their
parameters are used for (`uses`). Only what the text shows is refused: a name where a number is expected, a
number where a name is.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Literal, TypeAlias

from planner_reactor.errors import Diagnostic
from planner_reactor.rs.linking import Linked, error
from planner_reactor.rs.printer import show, show_head
from planner_reactor.rs.terms import (
    Apply,
    Call,
    Expression,
    Negative,
    Number,
    Operation,
    Symbol,
    Text,
    Variable,
)
from planner_reactor.rs.uses import Flows, flows, parameter_kind, sinks_of
from planner_reactor.rs.vocabulary import Kind, Signature

Nature: TypeAlias = Literal["number", "name", "truth value", "unknown"]
"""What the text shows of an expression's value."""

SHOWN = 5
"""How many clauses a message names."""

NOT_NUMBERS: frozenset[Nature] = frozenset({"name", "truth value"})
NOT_NAMES: frozenset[Nature] = frozenset({"number", "truth value"})
NUMBERS: frozenset[Kind] = frozenset({"number", "instance", "label"})
EXPECTED: dict[Kind, str] = {
    "number": "a number",
    "instance": "the number of an instance, as SIT returns it,",
    "label": "a label (a number)",
    "port": "the name of a port",
    "situation": "the name of a situation",
    "assumption": "the name of an assumption",
    "symbol": "a name",
}


def check_calls(linked: Linked) -> Iterator[Diagnostic]:
    """Errors "unknown-process", "argument-count", "result-count", "no-clause", "argument-kind" and
    "unknown-function"."""
    known = flows(linked)
    for number in linked.focus:
        for call in linked.facts[number].calls:
            if call.name in linked.signatures:
                yield from _basic(linked.signatures[call.name], call)
            elif linked.clauses(call.name):
                yield from _defined(linked, call)
            elif call.name not in linked.families:
                hint = linked.nearest(call.name, linked.names, linked.signatures)
                yield error(call.place, "unknown-process", f"unknown process {call.name}", hint)
            yield from _arguments(linked, known, number, call)


def _basic(signature: Signature, call: Call) -> Iterator[Diagnostic]:
    given, named = len(call.arguments), len(call.results)
    if not signature.takes(given):
        most = len(signature.inputs)
        takes = f"{most - signature.optional} to {most}" if signature.optional else f"{most}"
        takes = f"at least {takes}" if signature.open_inputs else takes
        yield _count(call, "argument", f"takes {takes}", given, signature.usage())
    if not signature.returns(named):
        least = len(signature.results)
        returns = f"at least {least}" if signature.open_results else f"{least}"
        yield _count(call, "result", f"returns {returns}", named, signature.usage())


def _defined(linked: Linked, call: Call) -> Iterator[Diagnostic]:
    clauses = linked.clauses(call.name)
    first = linked.schemas[clauses[0]]  # all clauses have the form of the first, or `clauses` says so
    given, named = len(call.arguments), len(call.results)
    if not linked.targets(call):
        if given != len(first.head):
            yield _count(call, "argument", f"takes {len(first.head)}", given, show_head(first))
        else:
            there_are = [show_head(linked.schemas[number]) for number in clauses[:SHOWN]]
            hint = f"there are {', '.join(there_are)}{', …' if len(clauses) > SHOWN else ''}"
            asked = show(Call(call.name, call.arguments))
            yield error(call.place, "no-clause", f"no clause applies to {asked}", hint)
    if named not in (0, len(first.results)):
        yield _count(call, "result", f"returns {len(first.results)}", named, show_head(first))


def _count(call: Call, what: str, takes: str, given: int, usage: str) -> Diagnostic:
    so_many = f"{given} {'given' if what == 'argument' else 'named'}"
    message = f"{call.name} {takes} {what}{'' if takes.endswith(' 1') else 's'}, {so_many}"
    return error(call.place, f"{what}-count", message, f"expected {usage}")


def _arguments(linked: Linked, known: Flows, number: int, call: Call) -> Iterator[Diagnostic]:
    signature = linked.signatures.get(call.name)
    for position, argument in enumerate(call.arguments):
        if not isinstance(argument, Symbol | Number | Text | Variable):
            yield from _inside(linked, number, call, argument)
        if isinstance(argument, Variable):
            continue
        if signature is not None:
            kind = signature.kind(position)
        else:
            kind = parameter_kind(linked, sinks_of(linked, known, call, position))
        if kind != "any" and _nature(argument) in (NOT_NUMBERS if kind in NUMBERS else NOT_NAMES):
            yield from _misfit(linked, number, call, argument, EXPECTED[kind])


def _inside(linked: Linked, number: int, call: Call, expression: Expression) -> Iterator[Diagnostic]:
    """What is wrong within an expression."""
    match expression:
        case Apply(function, arguments, place):
            if function not in linked.functions:
                hint = linked.nearest(function, linked.functions) or "functions come from the host"
                yield error(place or call.place, "unknown-function", f"unknown function {function}", hint)
            for argument in arguments:
                yield from _inside(linked, number, call, argument)
        case Negative(operand):
            yield from _number_needed(linked, number, call, operand)
        case Operation(sign, left, right):
            for operand in (left, right):
                if sign in "+-*/":
                    yield from _number_needed(linked, number, call, operand)
                else:
                    yield from _inside(linked, number, call, operand)


def _number_needed(linked: Linked, number: int, call: Call, operand: Expression) -> Iterator[Diagnostic]:
    yield from _inside(linked, number, call, operand)
    if _nature(operand) in NOT_NUMBERS:
        yield from _misfit(linked, number, call, operand, EXPECTED["number"])


def _misfit(linked: Linked, number: int, call: Call, argument: Expression, expected: str) -> Iterator[Diagnostic]:
    place, hint = call.place, ""
    if isinstance(argument, Symbol):
        binders = linked.facts[number].binders
        if argument.name in binders:
            return  # a result out of its scope: `bindings` says so
        place = argument.place or place
        hint = linked.nearest(argument.name, linked.schemas[number].parameters, binders)
        hint = hint or f"no parameter or result is called {argument.name}"
        message = f"{argument.name} is a symbol where {expected} is expected"
    else:
        message = f"{show(argument)} is a {_described(argument)} where {expected} is expected"
    yield error(place, "argument-kind", message, hint)


def _nature(expression: Expression) -> Nature:
    match expression:
        case Number() | Negative() | Operation("+" | "-" | "*" | "/"):
            return "number"
        case Symbol() | Text():
            return "name"
        case Operation():
            return "truth value"
        case _:
            return "unknown"


def _described(expression: Expression) -> str:
    return "string" if isinstance(expression, Text) else _nature(expression)
