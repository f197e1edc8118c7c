"""Checks on heads: clauses of one name must agree in form and exclude each other (`semantics`, Syntax).

`SP[6] = …` and `SP[7] = …` are clauses chosen by value; `P[x] = …` beside `P[1] = …` is not, since a call of
P[1] could mean either. Names of basic and built-in processes are taken.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations_with_replacement

from planner_reactor.errors import Diagnostic
from planner_reactor.rs.linking import Linked, error
from planner_reactor.rs.printer import show_head
from planner_reactor.rs.terms import Parameter, Value


def check_clauses(linked: Linked) -> Iterator[Diagnostic]:
    """Errors "overlapping-clauses", "clause-form" and "redefined"."""
    for name in dict.fromkeys(linked.schemas[number].name for number in linked.focus):
        numbers = linked.clauses(name)
        first = linked.schemas[numbers[0]]
        if name in linked.signatures:
            message = f"{name} is a basic process and cannot be defined"
            yield error(first.place, "redefined", message, "choose another name")
        for number in numbers[1:]:
            clause = linked.schemas[number]
            if len(clause.head) != len(first.head) or len(clause.results) != len(first.results):
                hint = f"the first is {show_head(first)}, at {linked.place(numbers[0])}"
                message = f"{show_head(clause)} differs in form from other clauses of {name}"
                yield error(clause.place, "clause-form", message, hint)
        if len(numbers) > 1:
            yield from _overlaps(linked, numbers)


def _overlaps(linked: Linked, numbers: list[int]) -> Iterator[Diagnostic]:
    """Clauses that can apply together with another. Two can if they agree wherever both have a constant:
    looked up for each pair of patterns of constants, since a reactor has hundreds of clauses and one or two
    patterns."""
    by_pattern: dict[tuple[int, ...], list[int]] = {}
    for number in numbers:
        head = linked.schemas[number].head
        pattern = tuple(i for i, h in enumerate(head) if not isinstance(h, Parameter))
        by_pattern.setdefault(pattern, []).append(number)
    found: dict[int, int] = {}
    for one, other in combinations_with_replacement(by_pattern, 2):
        common = [i for i in one if i in other]
        first: dict[tuple[Value, ...], int] = {}
        for number in by_pattern[one] if one != other else ():
            first.setdefault(_values(linked, number, common), number)
        for number in by_pattern[other]:
            values = _values(linked, number, common)  # two of one pattern are compared with all their constants
            earlier = first.setdefault(values, number) if one == other else first.get(values, number)
            if earlier != number:
                found.setdefault(max(earlier, number), min(earlier, number))
    for later, earlier in sorted(found.items()):
        yield _overlapping(linked, earlier, later)


def _values(linked: Linked, number: int, positions: list[int]) -> tuple[Value, ...]:
    head = linked.schemas[number].head
    return (len(head), *(h.value for i in positions if not isinstance(h := head[i], Parameter)))


def _overlapping(linked: Linked, earlier: int, later: int) -> Diagnostic:
    one, other = show_head(linked.schemas[earlier]), show_head(linked.schemas[later])
    place = linked.place(earlier)
    if one == other:
        message, hint = f"{one} is defined twice", f"first at {place}"
    else:
        message = f"{one} and {other} can both apply"
        hint = f"the first stands at {place}; clauses of one name must exclude each other by constants"
    return error(linked.schemas[later].place, "overlapping-clauses", message, hint)
