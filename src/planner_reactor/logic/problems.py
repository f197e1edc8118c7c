"""What is said of intervals: how they lie, how long they last, how far apart they are, what they use.

A `Statement` keeps its own words and their place, so that a contradiction can be told in them. Durations are
milliseconds. Without a `Capacity` there is enough of a resource for all: leaving a statement out never forbids more.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterable
from typing import TypeAlias

import msgspec

from planner_reactor.errors import Place
from planner_reactor.logic.allen import show

Interval: TypeAlias = Hashable
End: TypeAlias = tuple[Interval, int]
"""The start (0) or the end (1) of an interval."""


class _Said(msgspec.Struct, frozen=True, kw_only=True):
    words: str = ""
    place: Place | None = None

    def __str__(self) -> str:
        return self.words or self.own_words()

    def own_words(self) -> str:
        """The statement in the notation of `network_text`."""
        raise NotImplementedError


class Lies(_Said, frozen=True):
    """`first` lies to `second` in one of the relations."""

    first: Interval
    relation: int
    second: Interval

    def own_words(self) -> str:
        return f"{self.first} {show(self.relation)} {self.second}"


class Lasts(_Said, frozen=True):
    """How long an interval is, at least and at most (None: any length), in milliseconds."""

    interval: Interval
    least: float
    most: float | None

    def own_words(self) -> str:
        return f"{self.interval} lasts {_span(self.least, self.most)}"


class Apart(_Said, frozen=True):
    """How long after one end point another lies, in milliseconds; negative is before it."""

    first: End
    second: End
    least: float
    most: float | None

    def own_words(self) -> str:
        return f"{_end(self.second)} after {_end(self.first)} {_span(self.least, self.most)}"


class Uses(_Said, frozen=True):
    """What an interval takes of a resource, from its start to its end."""

    interval: Interval
    resource: Hashable
    amount: int = 1

    def own_words(self) -> str:
        return f"{self.interval} uses {self.resource}" + (f" {self.amount}" if self.amount != 1 else "")


class Capacity(_Said, frozen=True):
    """How much there is of a resource."""

    resource: Hashable
    amount: int

    def own_words(self) -> str:
        return f"resource {self.resource} {self.amount}"


Statement: TypeAlias = Lies | Lasts | Apart | Uses | Capacity


def intervals_of(statements: Iterable[Statement]) -> tuple[Interval, ...]:
    """The intervals that statements name, in the order of their first mention."""
    found: dict[Interval, None] = {}
    for said in statements:
        match said:
            case Lies(first=first, second=second):
                found[first] = found[second] = None
            case Apart(first=(first, _), second=(second, _)):
                found[first] = found[second] = None
            case Lasts(interval=interval) | Uses(interval=interval):
                found[interval] = None
    return tuple(found)


def _span(least: float, most: float | None) -> str:
    return f"{least:g} .." if most is None else f"{least:g}" if least == most else f"{least:g} .. {most:g}"


def _end(end: End) -> str:
    return f"{'end' if end[1] else 'start'} of {end[0]}"
