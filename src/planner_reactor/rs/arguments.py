"""Reads what stands in brackets: arguments (expressions), the parameters of a head, the names of results.

Like the parser of processes after Pratt, by the strengths in `grammar`. Every name is read as a `Symbol`;
`scope` tells the variables apart. `-` directly before a number belongs to the number.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from math import isfinite
from typing import TypeVar

from planner_reactor.rs.grammar import ARITHMETIC
from planner_reactor.rs.terms import (
    Apply,
    Expression,
    Head,
    Negative,
    Number,
    Operation,
    Parameter,
    Symbol,
    Text,
)
from planner_reactor.rs.tokens import Cursor

Element = TypeVar("Element")


def read_arguments(token: Cursor) -> tuple[Expression, ...]:
    """`[expression, …]`"""
    return _listed(token, "]", _expression)


def read_head(token: Cursor) -> tuple[Head, ...]:
    """`[name or constant, …]`"""
    return _listed(token, "]", _head)


def read_results(token: Cursor) -> tuple[str, ...]:
    """`<name, …>`"""
    return _listed(token, ">", _result)


def _listed(token: Cursor, closing: str, read: Callable[[Cursor], Element]) -> tuple[Element, ...]:
    """The elements, separated by commas, of a list that opens here."""
    opened = token.at
    token.enter()
    token.advance()
    elements: list[Element] = []
    if token.text != closing:
        elements.append(read(token))
        while token.text == ",":
            token.advance()
            elements.append(read(token))
    token.close(closing, opened)
    token.leave()
    return tuple(elements)


def _head(token: Cursor) -> Head:
    if token.kind == "name":
        return Parameter(token.advance())
    if token.kind in ("number", "text") or token.text == "-":
        constant = _operand(token)
        if isinstance(constant, Number | Text):
            return constant
    raise token.error("syntax", f"{token.found()} in a head", "a head holds names, numbers and strings")


def _result(token: Cursor) -> str:
    if token.kind == "name":
        return token.advance()
    message = f"{token.found()} where the name of a result should stand"
    raise token.error("syntax", message, "results are names: <x, y>")


def _expression(token: Cursor, floor: int = 0) -> Expression:
    """An expression composed by operators stronger than `floor`."""
    left = _operand(token)
    deeper = 0
    while (operator := ARITHMETIC.get(token.text)) is not None and operator.strength > floor:
        token.enter()  # `left` becomes deeper with every round
        deeper += 1
        token.advance()
        left = Operation(operator.sign, left, _expression(token, operator.strength))
        following = ARITHMETIC.get(token.text)
        if operator.joining == "once" and following is not None and following.joining == "once":
            hint = "a comparison is true or false, not a number: put parentheses around it"
            raise token.error("syntax", f"`{operator.sign}` and `{following.sign}` do not chain", hint)
    token.leave(deeper)
    return left


def _operand(token: Cursor) -> Expression:
    if token.kind == "name":
        return _name_or_application(token)
    if token.kind == "number":
        return Number(_number(token))
    if token.kind == "text":
        return Text(_string(token))
    if token.text == "-":
        return _negative(token)
    if token.text == "(":
        opened = token.at
        token.enter()
        token.advance()
        inner = _expression(token)
        token.close(")", opened)
        token.leave()
        return inner
    hint = 'expected a number, a name, a "string", f(…), `-` or `(`'
    raise token.error("syntax", f"{token.found()} where an argument should stand", hint)


def _name_or_application(token: Cursor) -> Expression:
    place = token.place()
    name = token.advance()
    if token.text == "(":
        token.enter()  # beside that of the list: an application takes four calls of Python
        arguments = _listed(token, ")", _expression)
        token.leave()
        return Apply(name, arguments, place)
    if token.text == "[":
        hint = f"a function takes its arguments in parentheses: {name}(…)"
        raise token.error("syntax", f"`[` after {name} in an argument", hint)
    if token.text == "=":
        raise token.error("syntax", "`=` in an argument", "`==` compares")
    return Symbol(name, place)


def _negative(token: Cursor) -> Expression:
    token.advance()
    if token.kind == "number":
        return Number(-_number(token))
    token.enter()
    operand = _operand(token)
    token.leave()
    return Negative(operand)


def _number(token: Cursor) -> int | float:
    text = token.text
    if len(text) > token.budgets.digits:
        raise token.error("too-long", f"a number of more than {token.budgets.digits} digits")
    number = int(text) if text.isdigit() else float(text)
    if not isfinite(number):
        raise token.error("syntax", f"{text} is too large", "the largest number is about 1.8e308")
    token.advance()
    return number


def _string(token: Cursor) -> str:
    try:
        text: str = json.loads(token.text)
    except ValueError:
        hint = r"expected \" \\ \/ \b \f \n \r \t or \u1234"
        raise token.error("syntax", "this string has a wrong escape", hint) from None
    token.advance()
    return text
