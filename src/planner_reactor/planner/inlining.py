"""Definitions written into the reaction that uses them: an adaptation holds reactions and nothing else (R §5.3).

A derived action stands for a text such as `LOOK[p] = IN[s1]<v> :; OUT[p, v]`, whose parameters are the ports that it is
connected to. In a reaction its body takes the place of the call, with those ports, and with names of its own, `v1`,
`v2`, …, for what it reads: parts that run side by side bind different names.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache

from msgspec.structs import replace

from planner_reactor.errors import InputError
from planner_reactor.rs.terms import (
    Apply,
    Call,
    Expression,
    If,
    Loop,
    Negative,
    Not,
    Operation,
    Parameter,
    Process,
    Schema,
    Spawn,
    Variable,
    calls,
)


class Inliner:
    """Writes definitions into one reaction."""

    def __init__(self) -> None:
        self._names = 0

    def process(self, text: str, arguments: tuple[Expression, ...]) -> Process:
        """The body of the definition in this text, with these arguments."""
        schema = definition(text)
        if len(schema.head) != len(arguments):
            raise InputError(f"{schema.name} is used with {len(arguments)} ports, its text has {len(schema.head)}")
        given: dict[str, Expression] = {}
        for head, argument in zip(schema.head, arguments, strict=True):
            if isinstance(head, Parameter):
                given[head.name] = argument
        for call in calls(schema.body):
            for name in call.results:
                if name not in given:
                    self._names += 1
                    given[name] = Variable(f"v{self._names}")
        return _written(schema.body, given)


@lru_cache(256)
def definition(text: str) -> Schema:
    """The one definition in a text, which must not call itself; InputError if it is not like that."""
    from planner_reactor.rs.parser import parse_program  # most domains have no such actions

    schemas = parse_program(text, file="<action>").schemas
    if len(schemas) != 1 or any(call.name == schemas[0].name for call in calls(schemas[0].body)):
        raise InputError(f"an action is written as one definition that does not call itself, not as {text.strip()}")
    return schemas[0]


def _written(process: Process, given: Mapping[str, Expression]) -> Process:
    """The process with its names replaced, without places: it stands in another text now."""
    match process:
        case Call(name, arguments, results):
            own = tuple(named.name for result in results if isinstance(named := given[result], Variable))
            return Call(name, tuple(_expressed(argument, given) for argument in arguments), own)
        case Not(body):
            return Not(_written(body, given))
        case Loop(condition, body) | Spawn(condition, body):
            return type(process)(_written(condition, given), _written(body, given))
        case If(test, then, otherwise):
            return If(_written(test, given), _written(then, given), _written(otherwise, given))
        case _:
            return replace(process, parts=tuple(_written(part, given) for part in process.parts))


def _expressed(expression: Expression, given: Mapping[str, Expression]) -> Expression:
    match expression:
        case Variable(name):
            return given.get(name, expression)
        case Negative(operand):
            return Negative(_expressed(operand, given))
        case Operation(sign, left, right):
            return Operation(sign, _expressed(left, given), _expressed(right, given))
        case Apply(function, arguments):
            return Apply(function, tuple(_expressed(argument, given) for argument in arguments))
        case _:
            return expression
