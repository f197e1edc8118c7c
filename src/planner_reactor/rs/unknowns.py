"""Unknowns: values of which a program knows only how they are made up, so that the rules of `evolves` can be read
symbolically (X §4.3.1).

An `Unknown` stands for a number or anything else that nobody has given yet; arithmetic on it builds a `Sum` in one
normal form (equal sums are equal values), whatever is not linear an `Applied`. The rules are not written twice: they
run on these values as on any others. Where they ask what nobody knows, is `p < nu`, the question is put to `decide`,
and `courses` runs the same code once for each answer that what is known already leaves open. The answers of a course
are its condition. Whether constraints can hold together is asked of `constraints`.

Legend: unknowns that were there from the start have serial 0, or -1 where they shall come before the others; later
ones have 1, 2, …; a sum names older ones first.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextvars import ContextVar
from math import isinf
from typing import Any, TypeAlias, TypeVar

import msgspec

from planner_reactor.errors import PlannerReactorError

Number: TypeAlias = int | float
DECIMALS = 12
"""Digits of a sum's constant that count: beyond, only the order of additions is seen."""

T = TypeVar("T")


class Undecided(PlannerReactorError, ValueError):
    """Something was asked of an unknown where nobody keeps the answers: see `courses`."""


class Symbolic:
    """What all values with an unknown in them have in common: arithmetic, and order that is decided."""

    __slots__ = ()

    def __add__(self, other: Any) -> Any:
        return _sum(self, other, 1)

    def __radd__(self, other: Any) -> Any:
        return _sum(other, self, 1)

    def __sub__(self, other: Any) -> Any:
        return _sum(self, other, -1)

    def __rsub__(self, other: Any) -> Any:
        return _sum(other, self, -1)

    def __neg__(self) -> Any:
        return _sum(0, self, -1)

    def __mul__(self, other: Any) -> Any:
        return _product(self, other)

    __rmul__ = __mul__

    def __truediv__(self, other: Any) -> Any:
        return _product(self, 1 / other) if not isinstance(other, Symbolic) else _quotient(self, other)

    def __rtruediv__(self, other: Any) -> Any:
        return _quotient(other, self)

    def __abs__(self) -> Any:
        return self if self >= 0 else -self

    def __round__(self, digits: int = 0) -> Any:
        return self

    def __lt__(self, other: Any) -> bool:
        return _ordered(self, "<", other)

    def __le__(self, other: Any) -> bool:
        return _ordered(self, "<=", other)

    def __gt__(self, other: Any) -> bool:
        return _ordered(other, "<", self)

    def __ge__(self, other: Any) -> bool:
        return _ordered(other, "<=", self)


class Unknown(Symbolic, msgspec.Struct, frozen=True):
    """A value that is not known. Two of the same name and serial are the same value."""

    name: str
    serial: int = 0

    def __repr__(self) -> str:
        return self.name


class Sum(Symbolic, msgspec.Struct, frozen=True):
    """`constant + Σ factor · part`: at least one part, no factor 0, the oldest part first."""

    parts: tuple[tuple[Unknown | Applied, Number], ...]
    constant: Number = 0

    def __repr__(self) -> str:
        text = ""
        for part, factor in self.parts:
            times = "" if abs(factor) == 1 else f"{abs(factor)!r} * "
            sign = ("-" if factor < 0 else "") if not text else (" - " if factor < 0 else " + ")
            text += f"{sign}{times}{part!r}"
        if self.constant:
            text += f" {'-' if self.constant < 0 else '+'} {abs(self.constant)!r}"
        return text


class Applied(Symbolic, msgspec.Struct, frozen=True):
    """A function of the host, a product or a quotient, of which only equal arguments are known to give the same."""

    function: str
    arguments: tuple[Any, ...]

    def __repr__(self) -> str:
        if self.function in ("*", "/"):
            left, right = (f"({a!r})" if isinstance(a, Sum) else repr(a) for a in self.arguments)
            return f"{left} {self.function} {right}"
        return f"{self.function}({', '.join(map(_shown, self.arguments))})"


# ------------------------------------------------------------------------------------------------ constraints


class Compared(msgspec.Struct, frozen=True):
    """`value relation 0`, the relation one of `<`, `<=`, `==`, `/=`; equal means within the tolerance."""

    value: Unknown | Sum | Applied
    relation: str
    tolerance: Number = 0

    def negated(self) -> Compared:
        if self.relation in ("==", "/="):
            return Compared(self.value, "/=" if self.relation == "==" else "==", self.tolerance)
        return Compared(-self.value, "<=" if self.relation == "<" else "<")


class Alike(msgspec.Struct, frozen=True):
    """Are two values the same that are not both numbers?"""

    left: Any
    right: Any
    holds: bool = True

    def negated(self) -> Alike:
        return Alike(self.left, self.right, not self.holds)


Constraint: TypeAlias = Compared | Alike


def decide(constraint: Constraint) -> bool:
    """Does it hold? Followed from what is known, or supposed for the present course."""
    course = _course.get()
    if course is None:
        raise Undecided(f"nobody decides {constraint}")
    return course.answer(constraint)


def equal(left: Any, right: Any, tolerance: Any = 0) -> bool:
    """Are two values of which one is symbolic the same? Structure decides if it can."""
    if left == right:
        return True
    if isinstance(left, Symbolic | int | float) and isinstance(right, Symbolic | int | float):
        if isinstance(tolerance, Symbolic):
            return bool(abs(left - right) <= tolerance)
        difference = left - right
        if not isinstance(difference, Symbolic):
            return bool(abs(difference) <= tolerance)
        return decide(Compared(_oriented(difference), "==", tolerance))
    return decide(Alike(left, right))


# ---------------------------------------------------------------------------------------------------- courses

Consistent: TypeAlias = Callable[[Sequence[Constraint]], bool]


class Course:
    """One way through the questions: the answers that were fixed beforehand, then `yes` wherever both are open."""

    def __init__(self, known: Sequence[Constraint], fixed: tuple[bool, ...], consistent: Consistent) -> None:
        self.supposed: list[Constraint] = []
        self.answers: list[bool] = []
        self._known = list(known)
        self._fixed = fixed
        self._consistent = consistent

    def answer(self, constraint: Constraint) -> bool:
        opposite = constraint.negated()
        if constraint in self._known:
            return True
        if opposite in self._known:
            return False
        open_yes = self._consistent([*self._known, constraint])
        if not (open_yes and self._consistent([*self._known, opposite])):
            return open_yes
        position = len(self.answers)
        yes = self._fixed[position] if position < len(self._fixed) else True
        self.answers.append(yes)
        self.supposed.append(constraint if yes else opposite)
        self._known.append(self.supposed[-1])
        return yes


_course: ContextVar[Course | None] = ContextVar("course", default=None)


def courses(
    run: Callable[[], T], known: Sequence[Constraint], consistent: Consistent
) -> Iterator[tuple[T, tuple[Constraint, ...]]]:
    """What `run` gives in each course that `known` leaves open, with what the course supposes. `run` is pure."""
    waiting: list[tuple[bool, ...]] = [()]
    while waiting:
        fixed = waiting.pop()
        course = Course(known, fixed, consistent)
        token = _course.set(course)
        try:
            result = run()
        finally:
            _course.reset(token)
        yield result, tuple(course.supposed)
        answers = tuple(course.answers)
        waiting += [(*answers[:i], False) for i in range(len(answers) - 1, len(fixed) - 1, -1)]


# ------------------------------------------------------------------------------------------------- arithmetic


def split(value: Any) -> tuple[dict[Unknown | Applied, Number], Number]:
    """A number or a symbolic value as factors of its parts, and a constant."""
    if isinstance(value, Sum):
        return dict(value.parts), value.constant
    if isinstance(value, Unknown | Applied):
        return {value: 1}, 0
    return {}, value


def joined(factors: Mapping[Unknown | Applied, Number], constant: Number) -> Any:
    """The value with these factors and this constant, in normal form."""
    parts = tuple(sorted(((p, _plain(f)) for p, f in factors.items() if f), key=lambda found: _age(found[0])))
    constant = _plain(constant)
    if not parts:
        return constant
    if len(parts) == 1 and parts[0][1] == 1 and not constant:
        return parts[0][0]
    return Sum(parts, constant)


def _plain(number: Number) -> Number:
    """The number in one form: 5.0 is 5, and what only the order of additions has made is gone."""
    if isinstance(number, float) and not isinf(number):
        number = round(number, DECIMALS)
        return int(number) if number.is_integer() else number
    return number


def unknowns(value: Any) -> Iterator[Unknown]:
    """Every unknown in a value, the oldest first."""
    match value:
        case Unknown():
            yield value
        case Sum(parts):
            for part, _ in parts:
                yield from unknowns(part)
        case Applied(_, arguments):
            for argument in arguments:
                yield from unknowns(argument)


def _sum(left: Any, right: Any, sign: int) -> Any:
    if not (_summable(left) and _summable(right)):
        return NotImplemented
    if not isinstance(left, Symbolic) and isinf(left):
        return left
    if not isinstance(right, Symbolic) and isinf(right):
        return sign * right
    factors, constant = split(left)
    more, further = split(right)
    for part, factor in more.items():
        factors[part] = factors.get(part, 0) + sign * factor
    return joined(factors, constant + sign * further)


def _product(left: Any, right: Any) -> Any:
    if isinstance(left, Symbolic) and isinstance(right, Symbolic):
        return Applied("*", tuple(sorted((left, right), key=_age)))
    if not _summable(right):
        return NotImplemented
    factors, constant = split(left)
    return joined({part: factor * right for part, factor in factors.items()}, constant * right)


def _quotient(left: Any, right: Symbolic) -> Any:
    if equal(right, 0):
        raise ZeroDivisionError
    return left if left == 0 else 1 if left == right else Applied("/", (left, right))


def _summable(value: Any) -> bool:
    return isinstance(value, Symbolic | int | float) and not isinstance(value, bool)


def _ordered(left: Any, relation: str, right: Any) -> bool:
    if not (_summable(left) and _summable(right)):
        raise TypeError(f"{left!r} {relation} {right!r}")
    difference = left - right
    if isinstance(difference, Symbolic):
        assert isinstance(difference, Unknown | Sum | Applied)
        return decide(Compared(difference, relation))
    return bool(difference < 0 if relation == "<" else difference <= 0)


def _oriented(difference: Any) -> Any:
    """Of x - y and y - x always the same one: that whose oldest part counts positive."""
    factors, _ = split(difference)
    return difference if next(iter(factors.values())) > 0 else -difference


def _age(value: Any) -> tuple[int, str]:
    return max((u.serial for u in unknowns(value)), default=0), repr(value)


def _shown(value: Any) -> str:
    return value if isinstance(value, str) else repr(value)
