"""Names given a value: a symbol of a text, such as the constant `t0` of X §5, becomes a number or an unknown.

A text may leave constants open (`Delay[t0]`): whoever runs or analyses it says what they are. Only symbols are
replaced, never what a parameter or a result binds.
"""

from __future__ import annotations

from collections.abc import Mapping

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
)
from planner_reactor.rs.unknowns import Symbolic

Given = Mapping[str, "int | float | str | Symbolic"]
"""What the names stand for."""


def with_values(program: Program, given: Given) -> Program:
    """The program with these symbols replaced by what they stand for."""
    return Program(
        Schema(s.name, s.head, s.results, process_with_values(s.body, given), s.place) for s in program.schemas
    )


def process_with_values(process: Process, given: Given) -> Process:
    match process:
        case Call(name, arguments, results, place):
            return Call(name, tuple(expression_with_values(a, given) for a in arguments), results, place)
        case Not(body):
            return Not(process_with_values(body, given))
        case Loop(condition, body) | Spawn(condition, body):
            return type(process)(process_with_values(condition, given), process_with_values(body, given))
        case If(test, then, otherwise):
            return If(*(process_with_values(part, given) for part in (test, then, otherwise)))
        case _:
            return replace(process, parts=tuple(process_with_values(part, given) for part in process.parts))


def expression_with_values(expression: Expression, given: Given) -> Expression:
    match expression:
        case Symbol(name) if name in given:
            return constant(given[name])
        case Negative(operand):
            return Negative(expression_with_values(operand, given))
        case Operation(sign, left, right):
            return Operation(sign, expression_with_values(left, given), expression_with_values(right, given))
        case Apply(function, arguments, place):
            return Apply(function, tuple(expression_with_values(a, given) for a in arguments), place)
        case _:
            return expression


def constant(value: object) -> Expression:
    """The expression with this value. An unknown stands where a number would: it prints as its name."""
    return Text(value) if isinstance(value, str) else Number(value)  # type: ignore[arg-type]
