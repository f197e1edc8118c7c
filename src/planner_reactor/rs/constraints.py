"""Can constraints on unknowns hold together? Linear arithmetic over the rationals, by elimination (Fourier, Motzkin).

What the papers' models ask is a handful of differences and bounds, so this small reasoner of our own decides all of
them exactly: no library is needed. What is not linear (a product of unknowns, a function of the host) counts as an
unknown of its own; `satisfiable` then answers `unknown` where the linear reading finds no contradiction. A
disequation, or an equation with a tolerance, splits into the two sides of the gap.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from fractions import Fraction
from functools import lru_cache
from itertools import product
from typing import Any, Literal, TypeAlias

from planner_reactor.rs.unknowns import Alike, Applied, Compared, Constraint, Number, Unknown, joined, split, unknowns

Verdict: TypeAlias = Literal["yes", "no", "unknown"]
Part: TypeAlias = Unknown | Applied

Row: TypeAlias = tuple[tuple[tuple[Part, Fraction], ...], Fraction, bool]
"""Σ factor · part + constant ⋈ 0, with `<` if strict, else `<=`."""

MOST_GAPS = 8
"""Disequations that are split: beyond, the others are left out of account and the answer is `unknown`."""

MOST_ROWS = 400
"""Rows of an elimination: beyond, the answer is `unknown`."""


class _TooMany(Exception):
    """The elimination has grown beyond its budget."""


def satisfiable(constraints: Iterable[Constraint]) -> Verdict:
    """Is there a value for every unknown, so that all hold? `no` is certain, and so is `yes`."""
    return _satisfiable(tuple(dict.fromkeys(constraints)))


def consistent(constraints: Sequence[Constraint]) -> bool:
    """May they hold together, as far as anybody can say?"""
    return satisfiable(constraints) != "no"


def implies(known: Sequence[Constraint], conclusion: Constraint) -> bool:
    """Does the conclusion surely follow?"""
    return conclusion in known or satisfiable([*known, conclusion.negated()]) == "no"


@lru_cache(maxsize=20_000)
def _satisfiable(constraints: tuple[Constraint, ...]) -> Verdict:
    named = [c for c in constraints if isinstance(c, Alike)]
    if any(c.negated() in named for c in named):
        return "no"
    compared = [c for c in constraints if isinstance(c, Compared)]
    exact = not named and all(isinstance(part, Unknown) for c in compared for part in split(c.value)[0])
    gaps = [c for c in compared if c.relation == "/="]
    rows = [row for c in compared if c.relation != "/=" for row in _rows(c)]
    exact = exact and len(gaps) <= MOST_GAPS
    try:
        for sides in product((1, -1), repeat=min(len(gaps), MOST_GAPS)):
            if _solvable([*rows, *(_side(gap, side) for gap, side in zip(gaps, sides, strict=False))]):
                return "yes" if exact else "unknown"
    except _TooMany:
        return "unknown"
    return "no"


def solution(constraints: Sequence[Constraint]) -> dict[Unknown | Applied, Fraction] | None:
    """Values of the parts for which all comparisons hold, or None if there are none. Nothing else is looked at."""
    compared = [c for c in constraints if isinstance(c, Compared)]
    gaps = [c for c in compared if c.relation == "/="]
    rows = [row for c in compared if c.relation != "/=" for row in _rows(c)]
    for sides in product((1, -1), repeat=min(len(gaps), MOST_GAPS)):
        chosen = [*rows, *(_side(gap, side) for gap, side in zip(gaps, sides, strict=False))]
        if _solvable(chosen):
            return _solved(chosen)
    return None


def _solved(rows: list[Row]) -> dict[Part, Fraction]:
    """Parts are eliminated one by one; then each gets a value that fits those found after it."""
    if not (rows := [row for row in rows if row[0]]):
        return {}
    part = _cheapest(rows)
    values = _solved(_without(part, rows))
    low: list[tuple[Fraction, bool]] = []
    high: list[tuple[Fraction, bool]] = []
    for factors, constant, strict in rows:
        if (own := dict(factors).get(part)) is not None:
            others = (factor * values.setdefault(p, Fraction(0)) for p, factor in factors if p != part)
            (high if own > 0 else low).append((-(constant + sum(others)) / own, strict))
    values[part] = _between(low, high)
    return values


def _between(low: Sequence[tuple[Fraction, bool]], high: Sequence[tuple[Fraction, bool]]) -> Fraction:
    if not low and not high:
        return Fraction(0)
    if not high:
        return max(bound for bound, _ in low) + 1
    if not low:
        return min(bound for bound, _ in high) - 1
    return (max(bound for bound, _ in low) + min(bound for bound, _ in high)) / 2


def _rows(c: Compared) -> Iterator[Row]:
    if c.relation == "==":
        yield _row(c.value - c.tolerance, 1, strict=False)
        yield _row(c.value + c.tolerance, -1, strict=False)
    else:
        yield _row(c.value, 1, strict=c.relation == "<")


def _side(gap: Compared, side: int) -> Row:
    """`value > tolerance` or `value < -tolerance`."""
    return _row(gap.value - side * gap.tolerance, -side, strict=True)


def _row(value: Any, sign: int, *, strict: bool) -> Row:
    factors, constant = split(value)
    return tuple((p, sign * _exact(f)) for p, f in factors.items()), sign * _exact(constant), strict


def _exact(number: Number) -> Fraction:
    """The number as it is written: 0.1 is one tenth."""
    return Fraction(number) if isinstance(number, int) else Fraction(repr(number))


def _solvable(rows: list[Row]) -> bool:
    while True:
        for factors, constant, strict in rows:
            if not factors and (constant > 0 or (strict and constant == 0)):
                return False
        rows = [row for row in rows if row[0]]
        if not rows:
            return True
        rows = _without(_cheapest(rows), rows)


def _cheapest(rows: Sequence[Row]) -> Part:
    """The part whose elimination leaves the fewest rows."""
    counts: dict[Part, list[int]] = {}
    for factors, _, _ in rows:
        for part, factor in factors:
            counts.setdefault(part, [0, 0])[factor > 0] += 1
    return min(counts, key=lambda part: counts[part][0] * counts[part][1])


def _without(part: Part, rows: Sequence[Row]) -> list[Row]:
    """What the rows say of the others: each lower bound of the part is below each upper bound."""
    kept: dict[Row, None] = {}
    below: list[tuple[Row, Fraction]] = []
    above: list[tuple[Row, Fraction]] = []
    for row in rows:
        factor = dict(row[0]).get(part)
        if factor is None:
            kept[row] = None
        else:
            (above if factor > 0 else below).append((row, factor))
    for (low, a), (high, b) in product(below, above):
        kept[_added(low, b, high, -a)] = None
    if len(kept) > MOST_ROWS:
        raise _TooMany
    return list(kept)


def _added(one: Row, times: Fraction, other: Row, others_times: Fraction) -> Row:
    factors = {part: times * factor for part, factor in one[0]}
    for part, factor in other[0]:
        factors[part] = factors.get(part, Fraction(0)) + others_times * factor
    left = tuple((part, factor) for part, factor in factors.items() if factor)
    return left, times * one[1] + others_times * other[1], one[2] or other[2]


# ------------------------------------------------------------------------------------------------- projection


def projected(constraints: Sequence[Constraint], keep: Collection[Unknown]) -> tuple[Constraint, ...]:
    """What the constraints say of the unknowns in `keep` alone: the others may be anything that fits.

    A disequation about another unknown is left out, which can only weaken what is said.
    """
    kept: list[Constraint] = []
    rows: list[Row] = []
    for c in constraints:
        mentioned = set(_mentioned(c))
        if mentioned <= set(keep):
            kept.append(c)
        elif isinstance(c, Compared) and c.relation != "/=":
            rows += _rows(c)
    if not rows:
        return tuple(kept)
    rows += [row for c in kept if isinstance(c, Compared) and c.relation != "/=" for row in _rows(c)]
    own = {row: c for c in kept if isinstance(c, Compared) and c.relation != "/=" for row in _rows(c)}
    for part in dict.fromkeys(p for row in rows for p, _ in row[0] if not set(unknowns(p)) <= set(keep)):
        rows = _without(part, rows)
    new = [_compared(row) for row in rows if row[0] and row not in own]
    return (*kept, *(c for c in new if not implies(kept, c)))


def _compared(row: Row) -> Compared:
    factors, constant, strict = row
    scale = abs(factors[0][1])
    value = joined({p: _number(f / scale) for p, f in factors}, _number(constant / scale))
    return Compared(value, "<" if strict else "<=")


def _number(exact: Fraction) -> Number:
    return int(exact) if exact.denominator == 1 else float(exact)


def _mentioned(c: Constraint) -> Iterator[Unknown]:
    for value in (c.value,) if isinstance(c, Compared) else (c.left, c.right):
        yield from unknowns(value)


# ----------------------------------------------------------------------------------------- reading them back


def holds(constraint: Constraint, values: Mapping[Unknown, Any], slack: float = 1e-9) -> bool:
    """Does it hold for these values of its unknowns? Numbers may miss by less than `slack`."""
    if isinstance(constraint, Alike):
        return (instance(constraint.left, values) == instance(constraint.right, values)) is constraint.holds
    number = instance(constraint.value, values)
    match constraint.relation:
        case "<":
            return bool(number < slack)
        case "<=":
            return bool(number <= slack)
        case "==":
            return bool(abs(number) <= constraint.tolerance + slack)
        case _:
            return bool(abs(number) > constraint.tolerance - slack)


def instance(value: Any, values: Mapping[Unknown, Any]) -> Any:
    """The value when its unknowns have these values; those without one stay."""
    match value:
        case Unknown():
            return values.get(value, value)
        case Applied("*", (left, right)):
            return instance(left, values) * instance(right, values)
        case Applied("/", (left, right)):
            return instance(left, values) / instance(right, values)
        case Applied(function, arguments):
            return Applied(function, tuple(instance(a, values) for a in arguments))
    factors, constant = split(value)
    for part, factor in factors.items():
        constant = constant + factor * instance(part, values)
    return constant
