"""Concrete executions of an environment model, on numbers, to hold its limit set against.

The program is run as it stands, recursions and all, by the concrete rules; beside it runs a world outside that writes
what it likes when it likes. What is seen of a run is which definitions are called with which values, by a world that
notes it, and which components have ended: nothing of `analysis.limits` has a part in it.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from math import inf
from random import Random
from typing import NamedTuple

from planner_reactor.analysis.conditions import constraints_of, events_of
from planner_reactor.analysis.explore import boundaries
from planner_reactor.analysis.limits import Limit
from planner_reactor.analysis.residuals import Noting
from planner_reactor.analysis.subnets import network, open_ports, traffic
from planner_reactor.rs.configurations import Config
from planner_reactor.rs.constraints import holds, instance
from planner_reactor.rs.evolves import started
from planner_reactor.rs.expressions import evaluate
from planner_reactor.rs.leaves import elapsed, offers, slack
from planner_reactor.rs.parser import parse_process
from planner_reactor.rs.states import Ended
from planner_reactor.rs.terms import Call
from planner_reactor.rs.unknowns import Symbolic, Unknown, split, unknowns
from tests.analysis.models import DURATIONS, Model, shipped


class Seen(NamedTuple):
    """The first limit of a run: its kind, the component's number, what it called, and what happened before."""

    kind: str
    component: int
    values: tuple[object, ...]
    name: str
    happened: frozenset[tuple[object, ...]]


def numbers(draw: Random) -> dict[str, object]:
    """Values for all that the models leave open: durations of any order, positions on both sides of the guards."""
    values: dict[str, object] = {name: draw.choice([0.05, 0.13, 0.31, 0.72, 1.5]) for name in DURATIONS}
    values |= {"p": draw.choice([0.0, 1.0, 2.0]), "a": draw.choice([0.5, 3.0]), "pr": draw.choice([0.0, 1.0, 5.0])}
    return values | {"eps": 0.5, "mu": 0.25, "nu": draw.choice([0.5, 1.5, 3.0])}


def first_limit(model: Model, sensors: Iterable[str], draw: Random, limit: int = 2_000) -> Seen | None:
    """Run it until one component invokes itself anew, a sensor is called, or a component has ended."""
    plain = model.world
    parts = network(model.process, plain).components
    world = Noting(plain.program, plain.signatures, plain.functions, endings=_oracle(draw))
    config = Config()
    for part in parts:
        config = started(part, world, config=config)
    read = {port for part in parts for port in traffic(part, plain).reads}
    for port in sorted(map(str, open_ports(parts, plain) & read)):
        later = f"Delay[{draw.uniform(0, 4)!r}] : OUT[{port}, {draw.choice([0.25, 1.75, 7.5])!r}]"
        config = started(parse_process(later), world, config=config)
    happened: set[tuple[object, ...]] = set()
    for _ in range(limit):
        choices = list(offers(config, world))
        if not any(offer.urgent for offer in choices):
            ahead = [d for d in boundaries(config, world) if d > 0]
            seconds = min((*ahead, slack(config, world)), default=inf)
            if seconds < inf and (not choices or draw.random() < 0.8):
                config = elapsed(config, seconds, world)
                continue
        if not choices:
            return None
        offer = draw.choice(choices)
        world.noted.clear()
        config = offer.taken(config, world)
        happened.add(offer.label[:3])
        if (found := _limit(config, parts, world, set(sensors), frozenset(happened))) is not None:
            return found
    return None


def _limit(
    config: Config, parts: tuple[object, ...], world: Noting, sensors: set[str], happened: frozenset[tuple[object, ...]]
) -> Seen | None:
    calls = {part.name: (n, part) for n, part in enumerate(parts) if isinstance(part, Call)}
    for name, values in world.noted:
        if name in sensors:
            return Seen("bound", -1, values, name, happened)
        if name in calls:
            number, part = calls[name]
            before = tuple(evaluate(a, {}, {}) for a in part.arguments)
            if values != before:
                return Seen("recursion", number, values, name, happened)
    for number, (_, term) in enumerate(config.roots[: len(parts)]):
        if isinstance(term, Ended):
            return Seen("end", number, (), "", happened)
    return None


def _oracle(draw: Random):  # type: ignore[no-untyped-def]
    def endings(name: str, arguments: tuple[object, ...]) -> list[tuple[bool, tuple[object, ...]]]:
        if name == "Ran":
            low, high = arguments
            return [(True, (draw.uniform(low, high),))]  # type: ignore[arg-type]
        return [(draw.random() < 0.5, ())]

    return endings


# ------------------------------------------------------------------------------------------------- is it foretold?


def fits(seen: Seen, entry: Limit, parts: tuple[object, ...], values: Mapping[Unknown, object]) -> bool:
    """Is what was seen an instance of this entry of the symbolic limit set?"""
    if seen.kind != entry.kind or (seen.component >= 0 and parts[seen.component] != entry.component):
        return False
    known = dict(values)
    if isinstance(entry.reached, Call):
        if entry.reached.name != seen.name:
            return False
        for argument, value in zip(entry.reached.arguments, seen.values, strict=True):
            if not _agrees(evaluate(argument, {}, {}), value, known):
                return False
    return all(holds(c, known, 1e-6) for c in constraints_of(entry.condition)) and all(
        _happened(e, seen, known) for e in events_of(entry.condition)
    )


def _agrees(symbolic: object, value: object, known: dict[Unknown, object]) -> bool:
    """Do they agree, if the one fresh unknown in it, if any, is what it must be?"""
    if not isinstance(symbolic, Symbolic):
        return symbolic == value
    fresh = [u for u in unknowns(symbolic) if u not in known]
    if fresh:
        factors, _ = split(symbolic)
        rest = instance(symbolic, {**known, fresh[0]: 0})
        known[fresh[0]] = (value - rest) / factors[fresh[0]]  # type: ignore[operator]
    return abs(instance(symbolic, known) - value) < 1e-6  # type: ignore[operator]


def _happened(event, seen: Seen, known: Mapping[Unknown, object]) -> bool:  # type: ignore[no-untyped-def]
    arguments = tuple(instance(a, known) if isinstance(a, Symbolic) else a for a in event.arguments)
    if event.kind == "outside":
        return any(h[0] == "COM" and h[1][0] == arguments[0] for h in seen.happened)
    return (event.name, arguments, "ok" if event.ok else "ab") in seen.happened


def campaign(name: str, count: int, seed: int, sensors: tuple[str, ...], entries: tuple[Limit, ...], symbolic: Model):
    """(limits seen that no entry foretells, entries that no run reached, runs that came to a limit)."""
    draw = Random(seed)
    parts = network(symbolic.process, symbolic.world).components
    unforetold: list[Seen] = []
    reached: set[int] = set()
    ended = 0
    for _ in range(count):
        given = numbers(draw)
        seen = first_limit(shipped(name, given), sensors, draw)
        if seen is None:
            continue
        ended += 1
        values = {u: v for n, v in given.items() for u in (Unknown(n), Unknown(n, -1))}
        found = [i for i, entry in enumerate(entries) if fits(seen, entry, parts, values)]
        reached.update(found)
        if not found:
            unforetold.append(seen)
    return unforetold, [e for i, e in enumerate(entries) if i not in reached], ended
