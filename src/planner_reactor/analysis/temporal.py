"""Linear-time formulas: their terms, their normal form, and what they mean on a run that goes round (a lasso).

X is `next`, U is `until`; everything else is made of these. `holds` is the plain meaning, by looking at every moment;
`tableau` translates the same formulas for a search, and is held against it.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cache
from typing import TypeAlias

import msgspec

from planner_reactor.analysis.observing import Atom


class Truth(msgspec.Struct, frozen=True):
    """`true`, `false`."""

    value: bool


class Here(msgspec.Struct, frozen=True):
    """The atom is true at this moment."""

    atom: Atom


class Negation(msgspec.Struct, frozen=True):
    body: Formula


class Both(msgspec.Struct, frozen=True):
    left: Formula
    right: Formula


class Either(msgspec.Struct, frozen=True):
    left: Formula
    right: Formula


class Next(msgspec.Struct, frozen=True):
    body: Formula


class Until(msgspec.Struct, frozen=True):
    """The right side comes to be true, and up to there the left side is."""

    left: Formula
    right: Formula


class Release(msgspec.Struct, frozen=True):
    """The right side is true up to and with the moment at which the left side is; for ever, if it never is."""

    left: Formula
    right: Formula


Formula: TypeAlias = Truth | Here | Negation | Both | Either | Next | Until | Release

TRUE, FALSE = Truth(True), Truth(False)


def eventually(body: Formula) -> Formula:
    return Until(TRUE, body)


def always(body: Formula) -> Formula:
    return Release(FALSE, body)


def implies(left: Formula, right: Formula) -> Formula:
    return Either(Negation(left), right)


def normal(formula: Formula, *, negated: bool = False) -> Formula:
    """The same (or its negation) with negations at atoms only."""
    match formula:
        case Truth(value):
            return Truth(value != negated)
        case Here():
            return Negation(formula) if negated else formula
        case Negation(body):
            return normal(body, negated=not negated)
        case Both(left, right) | Either(left, right):
            joined = Both if isinstance(formula, Both) != negated else Either
            return joined(normal(left, negated=negated), normal(right, negated=negated))
        case Next(body):
            return Next(normal(body, negated=negated))
        case Until(left, right) | Release(left, right):
            bounded = Until if isinstance(formula, Until) != negated else Release
            return bounded(normal(left, negated=negated), normal(right, negated=negated))


def parts(formula: Formula) -> tuple[Formula, ...]:
    """The formulas directly below."""
    match formula:
        case Truth() | Here():
            return ()
        case Negation(body) | Next(body):
            return (body,)
        case Both(left, right) | Either(left, right) | Until(left, right) | Release(left, right):
            return (left, right)


def atoms(formula: Formula) -> tuple[Atom, ...]:
    """Every atom, once, in the order of the text."""
    return tuple(dict.fromkeys(_atoms(formula)))


def _atoms(formula: Formula) -> Iterator[Atom]:
    if isinstance(formula, Here):
        yield formula.atom
    for part in parts(formula):
        yield from _atoms(part)


def holds(formula: Formula, moments: Sequence[frozenset[Atom]], loop: int) -> bool:
    """Is it true of the run `moments[:loop]` followed by `moments[loop:]` for ever?"""
    count = len(moments)

    def following(at: int) -> int:
        return at + 1 if at + 1 < count else loop

    @cache
    def true(formula: Formula, at: int) -> bool:
        match formula:
            case Truth(value):
                return value
            case Here(atom):
                return atom in moments[at]
            case Negation(body):
                return not true(body, at)
            case Both(left, right):
                return true(left, at) and true(right, at)
            case Either(left, right):
                return true(left, at) or true(right, at)
            case Next(body):
                return true(body, following(at))
            case Until(left, right):
                for _ in range(2 * count):
                    if true(right, at):
                        return True
                    if not true(left, at):
                        return False
                    at = following(at)
                return False
            case Release(left, right):
                return not true(Until(Negation(left), Negation(right)), at)

    return true(formula, 0)


def show(formula: Formula) -> str:
    """The formula in the notation of properties."""
    match formula:
        case Truth(value):
            return "true" if value else "false"
        case Here(atom):
            return str(atom)
        case Until(Truth(True), body):
            return f"eventually {_operand(body)}"
        case Release(Truth(False), body):
            return f"always {_operand(body)}"
        case Negation(body):
            return f"not {_operand(body)}"
        case Next(body):
            return f"next {_operand(body)}"
        case Either(Negation(left), right):
            return f"{_operand(left)} -> {_operand(right)}"
        case _:
            word = {Both: "and", Either: "or", Until: "until", Release: "releases"}[type(formula)]
            left, right = parts(formula)
            return f"{_operand(left)} {word} {_operand(right)}"


def _operand(formula: Formula) -> str:
    simple = isinstance(formula, Truth | Here | Negation | Next) or (
        isinstance(formula, Until | Release) and isinstance(formula.left, Truth)
    )
    return show(formula) if simple else f"({show(formula)})"
