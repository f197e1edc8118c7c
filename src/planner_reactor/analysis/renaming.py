"""Unknowns by the order in which they appear, so that two states that differ only in fresh names are one.

Unknowns that were there from the start (serial 0 or less) keep their names. The others are numbered anew; their first
names are kept, with a number where two share one.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any, TypeVar

import msgspec
from msgspec.structs import replace

from planner_reactor.rs.states import Ended, Leaf
from planner_reactor.rs.terms import Call
from planner_reactor.rs.unknowns import Alike, Applied, Compared, Sum, Symbolic, Unknown, joined, unknowns

T = TypeVar("T")


def unknowns_of(thing: Any) -> Iterator[Unknown]:
    """Every unknown in a term, a process, a condition, a store; each may come several times."""
    match thing:
        case Symbolic():
            yield from unknowns(thing)
        case str() | int() | float() | None:
            return
        case tuple():
            for part in thing:
                yield from unknowns_of(part)
        case Ended():
            yield from unknowns_of(thing.bindings)
        case Compared(value):
            yield from unknowns(value)
        case Alike(left, right):
            yield from unknowns_of((left, right))
        case Call(_, arguments):
            yield from unknowns_of(arguments)
        case msgspec.Struct():
            for name in thing.__struct_fields__:
                if name not in UNTOUCHED:
                    yield from unknowns_of(getattr(thing, name))


UNTOUCHED = frozenset({"rest", "loop", "branches", "site", "place", "results", "operator", "renamed", "reaction"})
"""Fields that hold text of the program: no unknown is in them but those that were there from the start."""


def renamed(thing: T) -> T:
    """The same with its fresh unknowns numbered 1, 2, … in the order in which they appear."""
    fresh = [u for u in dict.fromkeys(unknowns_of(thing)) if u.serial > 0]
    if not fresh:
        return thing
    taken = {u.name for u in unknowns_of(thing) if u.serial <= 0}
    names: dict[Unknown, Unknown] = {}
    for number, old in enumerate(fresh, 1):
        name = first = old.name.rstrip("0123456789") or old.name
        copies = 1
        while name in taken:
            copies += 1
            name = f"{first}{copies}"
        taken.add(name)
        names[old] = Unknown(name, number)
    result: T = _mapped(thing, lambda u: names.get(u, u))
    return result


def _mapped(thing: Any, new: Callable[[Unknown], Unknown]) -> Any:
    match thing:
        case Unknown():
            return new(thing)
        case Sum(parts, constant):
            return joined({_mapped(part, new): factor for part, factor in parts}, constant)
        case Applied(function, arguments):
            return Applied(function, _mapped(arguments, new))
        case Compared(value, relation, tolerance):
            return Compared(_mapped(value, new), relation, tolerance)
        case Alike(left, right, holds):
            return Alike(_mapped(left, new), _mapped(right, new), holds)
        case str() | int() | float() | None:
            return thing
        case tuple():
            return tuple(_mapped(part, new) for part in thing)
        case Ended(ok, bindings, cause):
            return Ended(ok, _mapped(bindings, new), cause)
        case Call(name, arguments, results, place):
            return Call(name, _mapped(arguments, new), results, place)
        case Leaf():
            return replace(thing, arguments=_mapped(thing.arguments, new), age=_mapped(thing.age, new))
        case msgspec.Struct():
            changes = {}
            for name in thing.__struct_fields__:
                if name not in UNTOUCHED:
                    old = getattr(thing, name)
                    if (mapped := _mapped(old, new)) is not old and mapped != old:
                        changes[name] = mapped
            return replace(thing, **changes) if changes else thing
    return thing
