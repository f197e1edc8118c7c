"""Expressions compiled to closures over a frame: what `rs.expressions.evaluate` says, faster.

The closures treat the commonest forms (constants, variables, `+` and `-` of a number) themselves and leave everything
else, every error included, to `evaluate`, so that there is one meaning of expressions. What has no value raises
`EvaluationError`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TypeAlias

from planner_reactor.rs.expressions import Unbound, evaluate
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
from planner_reactor.runtime.strands import UNBOUND, Frame

Functions: TypeAlias = Mapping[str, Callable[..., Value]]
Slots: TypeAlias = Callable[[str], int]
"""The slot of a variable in the frame; -1 if nothing binds it."""
Reader: TypeAlias = Callable[[Frame], Value]
Tuples: TypeAlias = Callable[[Frame], tuple[Value, ...]]
Frames: TypeAlias = Callable[[Frame], Frame]

CONSTANTS = (Number, Text, Symbol)
_SMALL = 1 << 200  # well below the bound on integers of `rs.expressions`


def reader(expression: Expression, slots: Slots, functions: Functions) -> Reader:
    """A closure that gives the value of the expression for a frame."""
    if expression.__class__ is Variable:  # the commonest
        return _variable(expression.name, slots(expression.name))
    match expression:
        case Number(value):
            return _constant(value)
        case Text(text) | Symbol(text):
            return _constant(text)
        case Variable(name):
            return _variable(name, slots(name))
        case Operation("+" | "-" as sign, Variable(name), Number(int(step))) if slots(name) >= 0:
            return _shifted(slots(name), step if sign == "+" else -step, _general(expression, slots, functions))
        case _:
            return _general(expression, slots, functions)


def tuples(expressions: tuple[Expression, ...], slots: Slots, functions: Functions) -> Tuples:
    """A closure that gives the values of all the expressions for a frame."""
    constant = tuple([e.name if isinstance(e, Symbol) else e.value for e in expressions if isinstance(e, CONSTANTS)])
    if len(constant) == len(expressions):
        return lambda frame: constant
    readers = [reader(e, slots, functions) for e in expressions]
    match readers:
        case [one]:
            return lambda frame: (one(frame),)
        case [one, two]:
            return lambda frame: (one(frame), two(frame))
        case _:
            return lambda frame: tuple([r(frame) for r in readers])


def frames(expressions: tuple[Expression, ...], slots: Slots, functions: Functions) -> Frames:
    """A closure that gives a new frame that begins with the values of the expressions."""
    readers = [reader(e, slots, functions) for e in expressions]
    match readers:
        case []:
            return lambda frame: []
        case [one]:
            return _single(expressions[0], one, slots)
        case [one, two]:
            return lambda frame: [one(frame), two(frame)]
        case _:
            return lambda frame: [r(frame) for r in readers]


def _single(expression: Expression, one: Reader, slots: Slots) -> Frames:
    """A frame of one value; the commonest, a variable and a number, without a further call."""
    match expression:
        case Operation("+" | "-" as sign, Variable(name), Number(int(number))) if slots(name) >= 0:
            slot, step = slots(name), number if sign == "+" else -number

            def single(frame: Frame) -> Frame:
                value = frame[slot]
                if value.__class__ is int and -_SMALL < value < _SMALL:
                    return [value + step]
                return [one(frame)]

            return single
        case _:
            return lambda frame: [one(frame)]


def _constant(value: Value) -> Reader:
    return lambda frame: value


def _variable(name: str, slot: int) -> Reader:
    def read(frame: Frame) -> Value:
        value = frame[slot] if slot >= 0 else UNBOUND
        if value is UNBOUND:
            raise Unbound(name)
        return value

    return read


def _shifted(slot: int, step: int, general: Reader) -> Reader:
    def read(frame: Frame) -> Value:
        value = frame[slot]
        if value.__class__ is int and -_SMALL < value < _SMALL:
            return value + step
        return general(frame)

    return read


def _general(expression: Expression, slots: Slots, functions: Functions) -> Reader:
    used = [(name, slot) for name in _names(expression) if (slot := slots(name)) >= 0]

    def read(frame: Frame) -> Value:
        bound = {name: frame[slot] for name, slot in used if frame[slot] is not UNBOUND}
        return evaluate(expression, bound, functions)

    return read


def _names(expression: Expression) -> list[str]:
    found: list[str] = []
    waiting = [expression]
    while waiting:
        match waiting.pop():
            case Variable(name):
                found.append(name)
            case Negative(operand):
                waiting.append(operand)
            case Operation(_, left, right):
                waiting += [left, right]
            case Apply(_, arguments):
                waiting += arguments
    return found
