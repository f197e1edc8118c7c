"""Writes terms as text, always in the same way: `parse(show(term)) == term`.

Parentheses follow the table in `grammar`: a mixture of `:` and `;`, the operands of loops and of `#`, and `#`
itself within anything larger are always in parentheses, so that nobody has to remember strengths. `show`
writes a definition on one line; with a `width` it breaks long ones at their outermost operators. A number
that is not finite has no notation, and comments of the text that a term came from are not kept.
"""

from __future__ import annotations

from collections.abc import Iterable

from planner_reactor.rs.grammar import ARITHMETIC, OPERATOR_OF, PREFIX_MINUS, stands_bare
from planner_reactor.rs.terms import (
    Apply,
    Call,
    Expression,
    Head,
    If,
    Negative,
    Not,
    Number,
    Operation,
    Parameter,
    Process,
    Program,
    Schema,
    Symbol,
    Text,
    Variable,
    operands,
)

INDENT = 4


def show(thing: Process | Schema | Program | Expression, *, width: int | None = None) -> str:
    """`thing` as text that parses back to it; a definition longer than `width` columns takes several
    lines."""
    match thing:
        case Program():
            return "\n".join(show(schema, width=width) for schema in thing.schemas)
        case Schema():
            return _schema(thing, width)
        case Number() | Text() | Symbol() | Variable() | Negative() | Operation() | Apply():
            return _expression(thing)
        case _:
            return _process(thing) if width is None else _laid_out(thing, 0, width)


def show_head(schema: Schema) -> str:
    """`Name[head]<results>`, the left side of a definition."""
    return schema.name + _bracketed(map(_constant_or_name, schema.head)) + _results(schema.results)


def _schema(schema: Schema, width: int | None) -> str:
    head = show_head(schema)
    line = f"{head} = {_process(schema.body)}"
    if width is None or len(line) <= width:
        return line
    return f"{head} =\n{' ' * INDENT}{_laid_out(schema.body, INDENT, width)}"


def _process(process: Process) -> str:
    match process:
        case Call(name, arguments, results):
            return name + _bracketed(map(_expression, arguments)) + _results(results)
        case If(test, then, otherwise):
            return f"if {_process(test)} then {_process(then)} else {_process(otherwise)}"
        case Not(body):
            return "~" + _operand(body, process)
        case _:
            sign = OPERATOR_OF[type(process)].sign
            return f" {sign} ".join([_operand(part, process) for part in operands(process)])


def _operand(operand: Process, below: Process) -> str:
    text = _process(operand)
    return text if stands_bare(operand, below) else f"({text})"


def _laid_out(process: Process, column: int, width: int) -> str:
    """The process on as many lines as it takes, when its first line begins at `column`."""
    line = _process(process)
    if column + len(line) <= width:
        return line
    margin = "\n" + " " * column
    match process:
        case Call():
            return line
        case If():
            words = ("if ", "then ", "else ")
            parts = zip(words, operands(process), strict=True)
            return margin.join(word + _laid_out(part, column + len(word), width) for word, part in parts)
        case Not(body):
            return "~" + _operand_laid_out(body, process, column + 1, width)
        case _:
            sign = OPERATOR_OF[type(process)].sign + " "
            first, *others = operands(process)
            lines = [_operand_laid_out(first, process, column, width)]
            lines += [sign + _operand_laid_out(o, process, column + len(sign), width) for o in others]
            return margin.join(lines)


def _operand_laid_out(operand: Process, below: Process, column: int, width: int) -> str:
    if stands_bare(operand, below):
        return _laid_out(operand, column, width)
    return f"({_laid_out(operand, column + 1, width)})"


def _expression(expression: Expression, floor: int = 0) -> str:
    """The expression, in parentheses if its operator is not stronger than `floor`."""
    match expression:
        case Symbol(name) | Variable(name):
            return name
        case Number() | Text():
            return _constant_or_name(expression)
        case Apply(function, arguments):
            return f"{function}({', '.join(map(_expression, arguments))})"
        case Negative(Number(int() | float()) as number):  # `-3` is the number
            return f"-({_expression(number)})"
        case Negative(operand):
            return _parenthesised(f"-{_expression(operand, PREFIX_MINUS - 1)}", PREFIX_MINUS, floor)
        case Operation(sign, left, right):
            operator = ARITHMETIC[sign]
            left_floor = operator.strength - (operator.joining == "left")
            text = f"{_expression(left, left_floor)} {sign} {_expression(right, operator.strength)}"
            return _parenthesised(text, operator.strength, floor)


def _parenthesised(text: str, strength: int, floor: int) -> str:
    return text if strength > floor else f"({text})"


def _constant_or_name(head: Head) -> str:
    match head:
        case Parameter(name):
            return name
        case Number(value):
            return repr(value)
        case Text(text):
            import json  # texts are rare

            return json.dumps(text, ensure_ascii=False)


def _bracketed(texts: Iterable[str]) -> str:
    inside = ", ".join(texts)
    return f"[{inside}]" if inside else ""


def _results(names: tuple[str, ...]) -> str:
    return f"<{', '.join(names)}>" if names else ""
