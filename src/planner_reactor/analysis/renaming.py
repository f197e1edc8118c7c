"""Unknowns by the order in which they appear, so that two states that differ only in fresh names are one.

Unknowns that were there from the start (serial 0 or less) keep their names. The others are numbered anew; their first
names are kept, with a number where two share one.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from typing import Any, TypeVar

import msgspec
from msgspec.structs import replace

from planner_reactor.rs.configurations import Config
from planner_reactor.rs.states import (
    Chain,
    Deciding,
    Ended,
    Export,
    Group,
    Inverted,
    Keep,
    Leaf,
    Round,
    Serve,
    Spawning,
    Testing,
    parts_of,
    with_parts,
)
from planner_reactor.rs.terms import Call
from planner_reactor.rs.unknowns import Alike, Applied, Compared, Sum, Symbolic, Unknown, joined, unknowns

T = TypeVar("T")

COMPOSED = (Chain, Keep, Export, Group, Inverted, Deciding, Testing, Round, Spawning, Serve)
"""Running terms with live parts: what else they hold is bindings, or text of the program."""


def unknowns_of(thing: Any) -> Iterator[Unknown]:
    """Every unknown in a term, a process, a condition, a store; each may come several times."""
    match thing:
        case Symbolic():
            yield from unknowns(thing)
        case str() | int() | float() | None:
            return
        case tuple() | list():
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
        case Leaf(_, arguments, _, age):
            yield from unknowns_of(arguments)
            if isinstance(age, Symbolic):
                yield from unknowns(age)
        case Config(roots, store):
            for _, term in roots:
                yield from unknowns_of(term)
            if store.instances or store.queue:
                yield from unknowns_of(store)
        case _ if isinstance(thing, COMPOSED):
            yield from unknowns_of(getattr(thing, "scope", getattr(thing, "bindings", ())))
            for part in parts_of(thing):
                yield from unknowns_of(part)
        case msgspec.Struct():
            for name in thing.__struct_fields__:
                if name not in UNTOUCHED:
                    yield from unknowns_of(getattr(thing, name))


UNTOUCHED = frozenset({"rest", "loop", "branches", "site", "place", "operator", "renamed", "reaction"})
"""Fields that hold text of the program: no unknown is in them but those that were there from the start."""


def renamed(thing: T, *, taken: Iterable[str] = ()) -> T:
    """The same with its fresh unknowns numbered 1, 2, … in the order in which they appear, none named as in `taken`."""
    fresh = [u for u in dict.fromkeys(unknowns_of(thing)) if u.serial > 0]
    if not fresh:
        return thing
    taken = {*taken, *(u.name for u in unknowns_of(thing) if u.serial <= 0)}
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


def forgotten(thing: T) -> T:
    """The same where of every unknown value only that it is one is left, and which are the same."""
    names: dict[Symbolic, Unknown] = {}

    def known(value: Symbolic) -> Unknown:
        number = len(names) + 1
        return names.setdefault(value, Unknown(f"value{number}", number))

    result: T = _mapped(thing, known, whole=True)
    return result


def _mapped(thing: Any, new: Callable[[Any], Any], *, whole: bool = False) -> Any:
    """The thing with its unknowns mapped, or, if they are taken `whole`, its symbolic values."""
    match thing:
        case Unknown():
            return new(thing)
        case Symbolic() if whole:
            return new(thing)
        case Sum(parts, constant):
            return joined({new(p) if isinstance(p, Unknown) else _mapped(p, new): f for p, f in parts}, constant)
        case Applied(function, arguments):
            return Applied(function, _mapped(arguments, new))
        case Compared(value, relation, tolerance):
            return Compared(_mapped(value, new), relation, tolerance)
        case Alike(left, right, holds):
            return Alike(_mapped(left, new), _mapped(right, new), holds)
        case str() | int() | float() | None:
            return thing
        case tuple():
            return tuple(_mapped(part, new, whole=whole) for part in thing)
        case Ended(ok, bindings, cause):
            return Ended(ok, _mapped(bindings, new, whole=whole), cause)
        case Call(name, arguments, results, place):
            return Call(name, _mapped(arguments, new, whole=whole), results, place)
        case Leaf(_, arguments, _, age):
            mapped = _mapped(arguments, new, whole=whole)
            older = _mapped(age, new, whole=whole)
            return thing if mapped == arguments and older == age else replace(thing, arguments=mapped, age=older)
        case Config(roots, store):
            roots = tuple((number, _mapped(term, new, whole=whole)) for number, term in roots)
            return Config(roots, _mapped(store, new, whole=whole) if store.instances or store.queue else store)
        case _ if isinstance(thing, COMPOSED):
            return _composed(thing, new, whole)
        case msgspec.Struct():
            return _with_fields_mapped(thing, new, whole)
    return thing


def _composed(thing: Any, new: Callable[[Any], Any], whole: bool) -> Any:
    """A term with live parts: its own bindings, then the parts."""
    for name in ("scope", "bindings"):
        if (bound := getattr(thing, name, ())) and (mapped := _mapped(bound, new, whole=whole)) != bound:
            thing = replace(thing, **{name: mapped})
    parts = parts_of(thing)
    changed = tuple(_mapped(part, new, whole=whole) for part in parts)
    return thing if all(a is b for a, b in zip(changed, parts, strict=True)) else with_parts(thing, changed)


def _with_fields_mapped(thing: msgspec.Struct, new: Callable[[Any], Any], whole: bool) -> msgspec.Struct:
    changes = {}
    for name in thing.__struct_fields__:
        if name not in UNTOUCHED:
            old = getattr(thing, name)
            if (mapped := _mapped(old, new, whole=whole)) is not old and mapped != old:
                changes[name] = mapped
    return replace(thing, **changes) if changes else thing
