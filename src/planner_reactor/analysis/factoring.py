"""Factoring: parts that share no port, no situation and no label are examined one by one.

The states of such a composition are the product of the states of its factors, and so are its ends; it is stuck when
every factor has come to an end and not all of them have ended. So a hundred copies cost what one costs, a hundred
times; and copies that differ in plain names only (`footprints`) are examined once.

Where time can pass it passes for all together: factors in which something is timed or urgent are then taken as one.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import prod
from typing import Any

import msgspec

from planner_reactor.analysis.cells import Entangled
from planner_reactor.analysis.explore import canonical
from planner_reactor.analysis.footprints import KINDS as NAMING
from planner_reactor.analysis.footprints import plain_names
from planner_reactor.analysis.networks import STORE_KINDS, Network, Part, grouped, parts_of_roots
from planner_reactor.analysis.transitions import LIMIT, Transitions, built
from planner_reactor.rs.configurations import Config, Label, World
from planner_reactor.rs.terms import Value
from planner_reactor.rs.vocabulary import BUILT_IN

KINDS = (*STORE_KINDS, "port")


class Factor(msgspec.Struct, frozen=True):
    """One factor: its counts, and the labels of a shortest way to where it is stuck, if it can be.

    `ends` are the states that nothing leaves; in `over` of them everything has ended.
    """

    parts: int
    states: int
    transitions: int
    ends: int
    over: int
    stuck: tuple[Label, ...] | None


class Factored(msgspec.Struct, frozen=True):
    """The factors of a configuration; `examined` of them were explored, the others are copies of these."""

    factors: tuple[Factor, ...]
    examined: int

    @property
    def states(self) -> int:
        return prod(f.states for f in self.factors)

    @property
    def transitions(self) -> int:
        """Each move of a factor, in every state of the others."""
        return sum(f.transitions * self.states // f.states for f in self.factors)

    @property
    def deadlocks(self) -> int:
        """States that nothing leaves though something has not ended."""
        return prod(f.ends for f in self.factors) - prod(f.over for f in self.factors)

    @property
    def stuck(self) -> tuple[int, ...]:
        """The factors that can be stuck for ever, whatever goes on beside them."""
        return tuple(n for n, f in enumerate(self.factors) if f.stuck is not None)


def factored(config: Config, world: World, *, limit: int = LIMIT) -> Factored:
    """Every factor examined. Raises `BudgetError` if one of them has more than `limit` states."""
    config = canonical(config)
    groups = grouped(parts_of_roots(config, world), KINDS)
    try:
        return _examined(config, world, groups, limit)
    except Entangled:
        return _examined(config, world, [[part for group in groups for part in group]], limit)


def _examined(config: Config, world: World, groups: Sequence[Sequence[Part]], limit: int) -> Factored:
    known: dict[object, tuple[Transitions, tuple[Value, ...]]] = {}
    found: list[tuple[Transitions, Mapping[Value, Value]]] = []
    for group in groups:
        key, names = _shape(config, group, world)
        if key not in known:
            known[key] = built(_network(config, world, group, groups, limit), limit=limit), names
        transitions, theirs = known[key]
        found.append((transitions, dict(zip(theirs, names, strict=True))))
    together = [n for n, (t, _) in enumerate(found) if any(t.urgent) or _timed(t)]
    if len(together) > 1 and any(_timed(t) for t, _ in found):
        joined = [part for n in together for part in groups[n]]
        return _examined(config, world, [joined, *(g for n, g in enumerate(groups) if n not in together)], limit)
    factors = tuple(_factor(len(g), t, names) for g, (t, names) in zip(groups, found, strict=True))
    return Factored(factors, len(known))


def _network(
    config: Config, world: World, group: Sequence[Part], groups: Sequence[Sequence[Part]], limit: int
) -> Network:
    mine = {id(part) for part in group}
    elsewhere = frozenset(p.root for g in groups for p in g if id(p) not in mine)
    cells = grouped(group, STORE_KINDS)
    return Network(config, world, cells, elsewhere=elsewhere & {p.root for p in group}, limit=limit)


def _timed(transitions: Transitions) -> bool:
    return any(label[0] == "TIME" for moves in transitions.moves for label, _ in moves)


def _factor(parts: int, transitions: Transitions, names: Mapping[Value, Value]) -> Factor:
    stuck = min(transitions.deadlocks, default=None)
    path = None if stuck is None else tuple(_renamed(label, names) for label in transitions.path(stuck))
    over = len(transitions.ends) - len(transitions.deadlocks)
    return Factor(parts, len(transitions), transitions.size, len(transitions.ends), over, path)


def _renamed(label: Label, names: Mapping[Value, Value]) -> Label:
    """The label in the copy, where other names stand for ports, situations and labels of reactions."""
    name, arguments, status, values = label
    signature = BUILT_IN.get("OUT" if name == "COM" else name)
    if signature is None:
        return label
    own = (names.get(a, a) if signature.kind(n) in NAMING else a for n, a in enumerate(arguments))
    return name, tuple(own), status, values


# --------------------------------------------------------------------------------------------------- copies


def _shape(config: Config, group: Sequence[Part], world: World) -> tuple[object, tuple[Value, ...]]:
    """What a factor is but for its plain names, and these in the order in which they occur.

    A situation that is served by `::` follows other rules, so that is part of the shape. What has begun is its own.
    """
    if config.store != Config().store:
        return id(group), ()
    plain = plain_names(part.footprint for part in group)
    names: dict[Value, int] = {}
    roots: dict[int, int] = {}
    shape = tuple((roots.setdefault(p.root, len(roots)), _abstract(p.term, plain, names)) for p in group)
    spawned = tuple(name in world.spawned for name in names)
    return (shape, spawned), tuple(names)


def _abstract(term: Any, plain: frozenset[Value], names: dict[Value, int]) -> object:
    """A run-time term in which each plain name is the number of its first occurrence."""

    def abstract(value: Value) -> object:
        return ("name", names.setdefault(value, len(names))) if value in plain else value

    found: list[object] = [type(term)]
    for field in term.__struct_fields__ if isinstance(term, msgspec.Struct) else ("ok", "bindings"):
        value = getattr(term, field)
        if field in ("scope", "bindings"):
            found.append(tuple((name, abstract(bound)) for name, bound in value))
        elif field == "arguments":
            found.append(tuple(map(abstract, value)))
        elif field == "situation":
            found.append(abstract(value))
        elif field in ("parts", "bodies"):
            found.append(tuple(_abstract(part, plain, names) for part in value))
        elif field in ("current", "body", "test", "condition"):
            found.append(_abstract(value, plain, names))
        else:
            found.append(value)
    return tuple(found)
