"""Names given a value: a symbol of a text, such as the constant `t0` of X §5, becomes a number or an unknown.

A text may leave constants open (`Delay[t0]`): whoever runs or analyses it says what they are. Only symbols are
replaced, unless `kind` is Variable: then it is what parameters and earlier results stand for.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TypeAlias

from msgspec.structs import replace

from planner_reactor.rs.terms import (
    Apply,
    Call,
    Expression,
    If,
    Loop,
    Negative,
    Not,
    Number,
    Operation,
    Process,
    Program,
    Schema,
    Spawn,
    Symbol,
    Text,
    Value,
    Variable,
)
from planner_reactor.rs.unknowns import Applied, Sum

Given: TypeAlias = Mapping[str, Value]
"""What the names stand for."""

Kind: TypeAlias = type[Symbol] | type[Variable]


def with_values(program: Program, given: Given) -> Program:
    """The program with these symbols replaced by what they stand for."""
    return Program(
        Schema(s.name, s.head, s.results, process_with_values(s.body, given), s.place) for s in program.schemas
    )


def process_with_values(process: Process, given: Given, kind: Kind = Symbol) -> Process:
    match process:
        case Call(name, arguments, results, place):
            return Call(name, tuple(expression_with_values(a, given, kind) for a in arguments), results, place)
        case Not(body):
            return Not(process_with_values(body, given, kind))
        case Loop(condition, body) | Spawn(condition, body):
            return type(process)(process_with_values(condition, given, kind), process_with_values(body, given, kind))
        case If(test, then, otherwise):
            return If(*(process_with_values(part, given, kind) for part in (test, then, otherwise)))
        case _:
            return replace(process, parts=tuple(process_with_values(part, given, kind) for part in process.parts))


def expression_with_values(expression: Expression, given: Given, kind: Kind = Symbol) -> Expression:
    match expression:
        case Symbol(name) | Variable(name) if isinstance(expression, kind) and name in given:
            return constant(given[name])
        case Negative(operand):
            return Negative(expression_with_values(operand, given, kind))
        case Operation(sign, left, right):
            sides = (expression_with_values(side, given, kind) for side in (left, right))
            return Operation(sign, *sides)
        case Apply(function, arguments, place):
            return Apply(function, tuple(expression_with_values(a, given, kind) for a in arguments), place)
        case _:
            return expression


def constant(value: object) -> Expression:
    """The expression with this value, which prints as one: unknowns as their names, sums and functions as they are
    made up. Whatever else is no string stands where a number would."""
    match value:
        case str():
            return Symbol(value) if value.isidentifier() else Text(value)
        case Sum(parts, number):
            terms = [(_times(part, abs(factor)), factor < 0) for part, factor in parts]
            terms += [(Number(abs(number)), number < 0)] if number else []
            terms.sort(key=lambda found: found[1])
            first, negative = terms[0]
            made: Expression = Negative(first) if negative else first
            for term, negative in terms[1:]:
                made = Operation("-" if negative else "+", made, term)
            return made
        case Applied("*" | "/" as sign, (left, right)):
            return Operation(sign, constant(left), constant(right))
        case Applied(function, arguments):
            return Apply(function, tuple(map(constant, arguments)))
    return Number(value)  # type: ignore[arg-type]


def _times(part: object, factor: int | float) -> Expression:
    return constant(part) if factor == 1 else Operation("*", Number(factor), constant(part))
