"""The names in a program that stand where only a number can: constants that the text leaves open.

`Delay[t0]` with nothing to bind t0 says that t0 is a number; so does `p + mu`. Where a program is to run this is a
mistake; where it is analysed it is an unknown. Names that go to arguments of any kind may be names, and stay what
they are.
"""

from __future__ import annotations

from collections.abc import Iterator

from planner_reactor.rs.calls import NUMBERS
from planner_reactor.rs.linking import Linked
from planner_reactor.rs.terms import Apply, Expression, Negative, Operation, Symbol
from planner_reactor.rs.uses import flows, parameter_kind, sinks_of


def open_names(linked: Linked) -> tuple[str, ...]:
    """The names that stand for numbers, in the order of the text."""
    known = flows(linked)
    found: dict[str, None] = {}
    for number in linked.focus:
        for call in linked.facts[number].calls:
            signature = linked.signatures.get(call.name)
            for position, argument in enumerate(call.arguments):
                found.update(dict.fromkeys(_calculated_with(argument)))
                if isinstance(argument, Symbol) and (signature is not None or linked.targets(call)):
                    sinks = sinks_of(linked, known, call, position) if signature is None else ()
                    kind = signature.kind(position) if signature is not None else parameter_kind(linked, sinks)
                    if kind in NUMBERS:
                        found[argument.name] = None
    return tuple(found)


def _calculated_with(expression: Expression) -> Iterator[str]:
    """The names that arithmetic is done on, or that are compared by order."""
    match expression:
        case Negative(operand):
            sides: tuple[Expression, ...] = (operand,)
        case Operation(_, left, right):
            sides = (left, right)
        case Apply(_, arguments):
            for argument in arguments:
                yield from _calculated_with(argument)
            return
        case _:
            return
    for side in sides:
        if isinstance(side, Symbol):
            yield side.name
        yield from _calculated_with(side)
