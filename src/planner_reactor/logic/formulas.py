"""Formulas of the interval logic: atoms `p(x, …)` over variables and constants, and their unification.

`p(x) @ i` says that p(x) holds over interval i; what an interval means to an action stands in `domain`
beside the atom. A *variable* is a whole number, everything else is a constant: a symbol of the domain is a
str, and a planner may bring constants of its own (a parameter, the result of an action, a thing that exists
without a name). So a formula is renamed apart by adding an offset to its variables, and two constants unify
only if they are equal.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterator, Mapping
from typing import TypeAlias

import msgspec

Term: TypeAlias = Hashable
"""An int is a variable, anything else a constant."""


class Numeral(msgspec.Struct, frozen=True):
    """A number as a constant of a domain (a bare int would be a variable)."""

    value: int | float

    def __str__(self) -> str:
        return str(self.value)


class Atom(msgspec.Struct, frozen=True):
    """`predicate(arguments)`."""

    predicate: str
    arguments: tuple[Term, ...] = ()

    def shifted(self, offset: int) -> Atom:
        """The same atom with every variable renamed by adding `offset`."""
        return Atom(self.predicate, tuple([a + offset if type(a) is int else a for a in self.arguments]))

    def __str__(self) -> str:
        return f"{self.predicate}({','.join(f'?{a}' if type(a) is int else str(a) for a in self.arguments)})"


class Bindings:
    """What variables stand for; bindings made since a `mark` can be undone."""

    __slots__ = ("trail", "values")

    def __init__(self) -> None:
        self.values: dict[int, Term] = {}
        self.trail: list[int] = []

    def mark(self) -> int:
        return len(self.trail)

    def undo(self, mark: int) -> None:
        """Forget every binding made since `mark`."""
        while len(self.trail) > mark:
            del self.values[self.trail.pop()]

    def walk(self, term: Term) -> Term:
        """What the term stands for now: a constant, or a variable that nothing binds."""
        while type(term) is int and term in self.values:
            term = self.values[term]
        return term

    def bind(self, variable: int, term: Term) -> None:
        self.values[variable] = term
        self.trail.append(variable)

    def unify(self, first: tuple[Term, ...], second: tuple[Term, ...]) -> bool:
        """Make two lists of terms equal if that is possible; on failure the caller undoes what was bound."""
        if len(first) != len(second):
            return False
        walk = self.walk
        for one, other in zip(first, second, strict=True):
            a, b = walk(one), walk(other)
            if a == b and type(a) is type(b):
                continue
            if type(a) is int:
                self.bind(a, b)
            elif type(b) is int:
                self.bind(b, a)
            else:
                return False
        return True

    def ground(self, atom: Atom) -> Atom:
        """The atom with every bound variable replaced by what it stands for."""
        walk = self.walk
        return Atom(atom.predicate, tuple([walk(a) for a in atom.arguments]))


def filled(atom: Atom, given: Mapping[int, Term]) -> Atom:
    """The atom with some of its variables replaced."""
    return Atom(atom.predicate, tuple([given.get(a, a) if type(a) is int else a for a in atom.arguments]))


def variables(atoms: tuple[Atom, ...]) -> Iterator[int]:
    """The variables of some atoms, each once, in order of appearance."""
    seen: dict[int, None] = {}
    for atom in atoms:
        for argument in atom.arguments:
            if type(argument) is int and argument not in seen:
                seen[argument] = None
                yield argument
