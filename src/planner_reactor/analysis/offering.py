"""How a component offers a port in its rounds: the shapes of Definitions 1, 2 and 4, ST and AT (X §4.4.1, App. A).

Local: what it would need by itself, if values were there whenever it wants to take one. `denseness` composes these.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import inf
from typing import Any, Literal, TypeAlias

import msgspec

from planner_reactor.analysis.conditions import Condition, constraints_of, events_of
from planner_reactor.analysis.durations import greatest
from planner_reactor.analysis.rounds import Path, Phase, Rounds
from planner_reactor.rs.constraints import implies, instance
from planner_reactor.rs.terms import Spawn, Value
from planner_reactor.rs.unknowns import Applied, Compared, Constraint, Sum, Symbolic, Unknown, split, unknowns

Trend: TypeAlias = Literal["increasing", "decreasing", "constant", "either", "open"]
Takes: TypeAlias = tuple[tuple[Value, Any], ...]
"""(port, what comes from it), side by side."""


class Local(msgspec.Struct, frozen=True):
    """A component offers the port locally (delay, resolution)-dense with the ports that it takes from.

    `takes` are those between two offers, one after the other; `gives` the ports at which it waits for a reader.
    `resolution` is None if it offers a value until somebody takes it. `restart` is the time to the first offer after it
    was begun anew, `most` a bound of |change|. It hands a value over at most `once`, or again and again (a STREAM).
    `lag` is the time from its first take to its offer.
    """

    form: str
    delay: Any
    resolution: Any
    takes: tuple[Takes, ...] = ()
    gives: tuple[Value, ...] = ()
    value: Value = None
    change: Any = None
    trend: Trend = "open"
    given: Condition = ()
    cut_by: tuple[Value, ...] = ()
    restart: Any = 0
    overlap: Any = 0
    most: Any = None
    once: bool = False
    lag: Any = 0


class Refusal(msgspec.Struct, frozen=True):
    """Why a component does not offer the port again and again."""

    why: str


def local(port: Value, found: Sequence[Rounds]) -> Local | Refusal:
    """The denseness of a port that these rounds offer, in the worst of them."""
    offering = [r for r in found if any(_offered(port, way) for way in (*r.ways, *r.ends))]
    if not offering:
        return Refusal("does not write it in any round that can be told")
    if len(offering) > 1:
        return Refusal("writes it in several rounds that go on side by side")
    (rounds,) = offering
    ways = [way for way in rounds.ways if _offered(port, way)]
    if not ways:
        return Refusal("writes it, and then ends or goes on without it")
    answers = [_of_way(port, rounds, way) for way in ways]
    return answers[0] if len(answers) == 1 else _worst(answers)


def _offered(port: Value, way: Path) -> bool:
    return any(p == port for phase in _phases(way) for p, _ in (*phase.offers, *phase.gives))


def _phases(way: Path) -> Iterator[Phase]:
    yield from way.phases
    for body in way.spawned:
        yield from body.phases


def _of_way(port: Value, rounds: Rounds, way: Path) -> Local:
    body = next((b for b in way.spawned if any(_shows(port, p) for p in b.phases)), None)
    return _spawned(port, rounds, way, body) if body is not None else _sequential(port, rounds, way)


def _shows(port: Value, phase: Phase) -> bool:
    return any(p == port for p, _ in (*phase.offers, *phase.gives))


# ------------------------------------------------------------------------------------------- one after the other


def _sequential(port: Value, rounds: Rounds, way: Path) -> Local:
    """Definitions 1, 2 and 4, Lemma 5: between two offers time passes and values are taken."""
    shown = [n for n, phase in enumerate(way.phases) if _shows(port, phase)]
    gaps = [_gap(way.phases, here, there) for here, there in zip(shown, [*shown[1:], shown[0]], strict=True)]
    gap = gaps[0] if len(gaps) == 1 else max(gaps, key=lambda g: len([p for p in g if p.takes]))
    delay = greatest(*(_time(g) for g in gaps))
    offers = [way.phases[n] for n in shown]
    value = next(v for p, v in (*offers[0].offers, *offers[0].gives) if p == port)
    until_taken = any(p == port for phase in offers for p, _ in phase.gives)
    resolution = None if until_taken and all(p.high == inf for p in offers) else greatest(*map(_length, offers))
    takes = tuple(phase.takes for phase in gap if phase.takes)
    change = _change(value, rounds, way)
    form = "on demand" if resolution is None else "Definition 2" if takes else "Definition 1"
    if form == "Definition 2" and rounds.name == "a loop":
        form = "Lemma 5"
    before = way.phases[: shown[0]]
    return Local(
        form, delay, resolution, takes, tuple(p for phase in gap if phase.waits for p, _ in phase.gives), value,
        change, _trend(change, way.given, rounds) if not takes else "open", _given(rounds, way, (way,)),
        rounds.cut_by, _time(before), 0, _most(change, way.given), until_taken, _since_taken(gap),
    )  # fmt: skip


def _gap(phases: Sequence[Phase], here: int, there: int) -> list[Phase]:
    return list(phases[here + 1 : there]) if here < there else [*phases[here + 1 :], *phases[:there]]


def _since_taken(phases: Sequence[Phase]) -> Any:
    first = next((n for n, phase in enumerate(phases) if phase.takes), None)
    return 0 if first is None else _time(phases[first + 1 :])


def _time(phases: Sequence[Phase], *, least_time: bool = False) -> Any:
    total: Any = 0
    for phase in phases:
        total = total + (phase.low if least_time else 0 if phase.waits else phase.high)
    return total


def _length(phase: Phase) -> Any:
    """How long what it offers stands: until its time is up, or until it has what it waits for."""
    return inf if phase.takes else phase.high


# ------------------------------------------------------------------------------------------------- side by side


def _spawned(port: Value, rounds: Rounds, way: Path, body: Path) -> Local:
    """Theorem 6 and beyond: a body of `::` offers the port while the next round is under way."""
    taken = [n for n, phase in enumerate(way.phases) if phase.takes]
    number = next(n for n, phase in enumerate(body.phases) if _shows(port, phase))
    offer, before = body.phases[number], body.phases[:number]
    period = _time(way.phases)
    apart = _time(before) - _time(before, least_time=True)
    idle = period - offer.low + apart
    after = _time(way.phases[taken[-1] + 1 :]) if taken else 0
    delay = greatest(idle, after)
    value = next(v for p, v in (*offer.offers, *offer.gives) if p == port)
    shortest = _time(way.phases, least_time=True)
    return Local(
        "Theorem 6", delay, None if offer.high == inf and offer.gives else offer.high,
        tuple(phase.takes for phase in way.phases if phase.takes), (), value, None, "open",
        _given(rounds, body, (way, body)), rounds.cut_by, period + _time(before),
        greatest(0, offer.high + apart - shortest) if offer.high != inf else 0, None, bool(offer.gives),
        _since_taken(way.phases) + _time(before),
    )  # fmt: skip


# --------------------------------------------------------------------------------------------------- what changes


def _change(value: Value, rounds: Rounds, way: Path) -> Value:
    """δ of Definition 4: what the next round offers, less what this one does."""
    entry = {u: after for (_, u), after in zip(rounds.entry, way.again, strict=False) if isinstance(u, Unknown)}
    if not isinstance(value, Symbolic):
        return 0 if isinstance(value, int | float) else None
    return instance(value, entry) - value if set(unknowns(value)) <= {*entry, *_fixed(value)} else None


def _fixed(value: Value) -> set[Unknown]:
    return {u for u in unknowns(value) if u.serial <= 0}


def _trend(change: Any, given: Condition, rounds: Rounds) -> Trend:
    if not isinstance(change, Unknown | Sum | Applied):
        return "open" if change is None else "constant" if change == 0 else "increasing" if change > 0 else "decreasing"
    known = [*constraints_of(given), *_positive(change, rounds)]
    rising, falling = (Compared(sign * change, "<") for sign in (-1, 1))
    return "increasing" if implies(known, rising) else "decreasing" if implies(known, falling) else "either"


def _most(change: Any, given: Condition) -> Any:
    """A bound of |δ|: of a value that is drawn, the greater end of its range; None if there is none."""
    if not isinstance(change, Unknown | Sum | Applied):
        return None if change is None else abs(change)
    drawn = [u for u in unknowns(change) if u.serial > 0]
    if not drawn:
        return change
    if not (isinstance(change, Unknown) and len(drawn) == 1):
        return None
    ends: list[Any] = []
    for c in constraints_of(given):
        factors, _ = split(c.value) if isinstance(c, Compared) else ({}, 0)
        if isinstance(c, Compared) and abs(factors.get(change, 0)) == 1 and c.relation in ("<", "<="):
            ends.append(change * factors[change] - c.value)
    return greatest(*ends) if len(ends) == 2 else None


def _positive(change: Value, rounds: Rounds) -> list[Constraint]:
    """A name that the text leaves open stands for more than 0: it is a size, not a direction."""
    own = {u for _, u in rounds.entry if isinstance(u, Unknown)}
    return [Compared(-u, "<") for u in unknowns(change) if u.serial <= 0 and u not in own]


def _given(rounds: Rounds, way: Path, along: Sequence[Path]) -> Condition:
    """What must hold for the round to be like this, if it may be otherwise."""
    others = isinstance(rounds.process, Spawn) or len(rounds.ways) + len(rounds.ends) > 1
    if not others:
        return ()
    atoms = [atom for each in along for atom in each.given]
    return tuple(dict.fromkeys((*events_of(atoms), *constraints_of(atoms))))


def _worst(answers: Sequence[Local]) -> Local:
    """Of several ways of going round, whichever happens."""
    most = max(answers, key=lambda a: len(a.takes))
    held = [a.resolution for a in answers]
    trends = {a.trend for a in answers}
    return msgspec.structs.replace(
        most, delay=greatest(*(a.delay for a in answers)),
        resolution=None if None in held else greatest(*held), restart=greatest(*(a.restart for a in answers)),
        overlap=greatest(*(a.overlap for a in answers)), trend=most.trend if len(trends) == 1 else "either",
    )  # fmt: skip


