"""The value of an expression: what an argument means once names are bound (R §4.1, parameters of schemas).

Arithmetic is on numbers, ordering on two numbers or two strings, `==` and `/=` on any two values; a host's
pure functions may be applied. A symbol is its own name. Whatever cannot be evaluated raises
`EvaluationError`: for the process that wanted the value this is an abort with cause "error", never a crash.
Integers and strings are bounded and results finite, also those of functions, so that no text can make a value that
eats the memory. Nothing here binds a name: see `scope`.
"""

from __future__ import annotations

import operator
from collections.abc import Callable, Mapping
from math import isfinite
from typing import Any

from planner_reactor.errors import PlannerReactorError, nearest
from planner_reactor.rs.terms import (
    Apply,
    Expression,
    Negative,
    Number,
    Operation,
    Symbol,
    Text,
    Value,
    Variable,
)
from planner_reactor.rs.unknowns import Applied, Symbolic, equal

LARGEST_INTEGER_BITS = 256
"""Integers beyond this size are an error; floats beyond their range are too."""

LONGEST_STRING = 1 << 16
"""Characters; a function of the host that returns more has failed. `twice` doubles a string at every round."""


class EvaluationError(PlannerReactorError, ValueError):
    """An expression that has no value: wrong operands, a division by zero, a function that failed."""


class Unbound(EvaluationError, LookupError):
    """A variable that no process has bound (its binder aborted, or lost a `#`)."""

    def __init__(self, name: str) -> None:
        self.name = name
        super().__init__(f"{name} is not bound")


def evaluate(
    expression: Expression, environment: Mapping[str, Value], functions: Mapping[str, Callable[..., Value]]
) -> Value:
    """The value of `expression` where `environment` binds its variables; raises `EvaluationError` or
    `Unbound`."""
    match expression:
        case Variable(name):
            try:
                return environment[name]
            except KeyError:
                raise Unbound(name) from None
        case Symbol(name):
            return name
        case Number(value):
            return value
        case Text(text):
            return text
        case Negative(operand):
            return _arithmetic("-", 0, evaluate(operand, environment, functions))
        case Operation(sign, left, right):
            return _operation(sign, evaluate(left, environment, functions), evaluate(right, environment, functions))
        case Apply(function, arguments):
            return applied(function, [evaluate(a, environment, functions) for a in arguments], functions)


def same(left: Value, right: Value) -> bool:
    """Are two values equal? `1 == 1.0`, but a truth value equals no number."""
    if isinstance(left, Symbolic) or isinstance(right, Symbolic):
        return equal(left, right)
    if isinstance(left, bool) is not isinstance(right, bool):
        return False
    try:
        return bool(left == right)
    except Exception as error:
        raise EvaluationError(f"{left!r} and {right!r} cannot be compared: {error}") from error


def is_number(value: Value) -> bool:
    """Is this a number of the language? Truth values are not; an unknown may be one."""
    return isinstance(value, int | float | Symbolic) and not isinstance(value, bool)


_ARITHMETIC: Mapping[str, Callable[[Any, Any], Any]] = {
    "+": operator.add,
    "-": operator.sub,
    "*": operator.mul,
    "/": operator.truediv,
}
_ORDERING: Mapping[str, Callable[[Any, Any], bool]] = {
    "<": operator.lt,
    "<=": operator.le,
    ">": operator.gt,
    ">=": operator.ge,
}


def _operation(sign: str, left: Value, right: Value) -> Value:
    if sign in _ARITHMETIC:
        return _arithmetic(sign, left, right)
    if sign == "==":
        return same(left, right)
    if sign == "/=":
        return not same(left, right)
    if (is_number(left) and is_number(right)) or (isinstance(left, str) and isinstance(right, str)):
        return _ORDERING[sign](left, right)
    raise EvaluationError(f"{sign} orders two numbers or two strings, not {left!r} and {right!r}")


def _arithmetic(sign: str, left: Value, right: Value) -> int | float:
    if not (is_number(left) and is_number(right)):
        raise EvaluationError(f"{sign} needs numbers, not {left!r} and {right!r}")
    try:
        result: int | float = _ARITHMETIC[sign](left, right)
    except ZeroDivisionError:
        raise EvaluationError(f"{left!r} is divided by zero") from None
    except OverflowError:
        raise EvaluationError(f"{left!r} {sign} {right!r} is too large") from None
    if isinstance(result, float) and not isfinite(result):
        raise EvaluationError(f"{left!r} {sign} {right!r} is not a finite number")
    _check_size(sign, result)
    return result


def _check_size(maker: str, value: Value) -> None:
    if isinstance(value, int) and value.bit_length() > LARGEST_INTEGER_BITS:
        raise EvaluationError(f"{maker} makes an integer of more than {LARGEST_INTEGER_BITS} bits")
    if isinstance(value, str) and len(value) > LONGEST_STRING:
        raise EvaluationError(f"{maker} makes a string of more than {LONGEST_STRING} characters")


def applied(name: str, arguments: list[Value], functions: Mapping[str, Callable[..., Value]]) -> Value:
    """What a function of the host makes of these; `EvaluationError` if it fails or is not there."""
    function = functions.get(name)
    if function is None:
        hint = nearest(name, functions)
        raise EvaluationError(f"no function {name} is registered" + (f", {hint}" if hint else ""))
    if any(isinstance(argument, Symbolic) for argument in arguments):
        return Applied(name, tuple(arguments))
    try:
        result = function(*arguments)
    except Exception as error:
        raise EvaluationError(f"{name}({', '.join(map(repr, arguments))}) failed: {error}") from error
    _check_size(name, result)
    return result
