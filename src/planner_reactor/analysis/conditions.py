"""Conditions under which a process evolves: what happens, and what must hold of the unknowns (X §4.3.1, App. B).

`Ω P` is written as the process itself, `℧ P` with a `~` before it: `InView[p, a]`, `~InView[p, a]`. A meeting within
the network is `port!value`, one with the world outside `IN[port]<value>` or `OUT[port, value]`. What must hold is
written as a comparison, `p < nu`, two bounds of one unknown as `-eps <= g <= eps`.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import Any, Literal, TypeAlias

import msgspec

from planner_reactor.rs.constraints import implies
from planner_reactor.rs.given import constant
from planner_reactor.rs.printer import show
from planner_reactor.rs.terms import Call, Value
from planner_reactor.rs.unknowns import Alike, Compared, Constraint, Unknown, joined, split, unknowns


class Event(msgspec.Struct, frozen=True):
    """A process ended, or two met. `kind`: a process of the network, a meeting in it, or one with the outside."""

    name: str
    arguments: tuple[Value, ...] = ()
    ok: bool = True
    results: tuple[Value, ...] = ()
    kind: Literal["process", "meeting", "outside"] = "process"

    def __str__(self) -> str:
        if self.kind == "meeting" and self.name == "COM":
            return f"{self.arguments[0]}!{_shown(self.arguments[1])}"
        call = Call(self.name, tuple(map(constant, self.arguments)), tuple(map(str, self.results)))
        return f"{'' if self.ok else '~'}{show(call)}"


Atom: TypeAlias = Event | Constraint
Condition: TypeAlias = tuple[Atom, ...]
"""All of it, in the order in which it was asked or happened."""


def events_of(condition: Iterable[Atom]) -> tuple[Event, ...]:
    return tuple(atom for atom in condition if isinstance(atom, Event))


def constraints_of(condition: Iterable[Atom]) -> tuple[Constraint, ...]:
    return tuple(atom for atom in condition if not isinstance(atom, Event))


def mentioned(condition: Iterable[Atom]) -> Iterator[Unknown]:
    """Every unknown of a condition."""
    for atom in condition:
        match atom:
            case Event(_, arguments, _, results):
                values: tuple[Any, ...] = (*arguments, *results)
            case Compared(value):
                values = (value,)
            case Alike(left, right):
                values = (left, right)
        for value in values:
            yield from unknowns(value)


def weaker(one: Condition, other: Condition) -> bool:
    """Does the one hold whenever the other does? An event is asked for only if the other has it too."""
    if not set(events_of(one)) <= set(events_of(other)):
        return False
    known = constraints_of(other)
    return all(implies(known, c) for c in constraints_of(one))


def shortened(constraints: Sequence[Constraint], known: Sequence[Constraint] = ()) -> tuple[Constraint, ...]:
    """The constraints without those that follow from the others and from what is known."""
    kept = list(dict.fromkeys(constraints))
    for c in reversed(list(kept)):
        others = [k for k in kept if k is not c]
        if implies([*known, *others], c):
            kept = others
    return tuple(kept)


# ------------------------------------------------------------------------------------------------------- text


def text(condition: Condition) -> str:
    """The condition for people; `true` if nothing is asked."""
    written: list[str] = [str(event) for event in events_of(condition)]
    written += _compared(constraints_of(condition))
    return " and ".join(written) or "true"


def path_text(path: Iterable[Condition]) -> str:
    """The conditions of a path, in their order, as X §4.3.1 writes them: `c1 . c2`."""
    return " . ".join(t for t in map(text, path) if t != "true") or "true"


def _compared(constraints: Sequence[Constraint]) -> list[str]:
    lines: list[str] = []
    bounds: dict[Unknown, dict[str, str]] = {}
    for c in constraints:
        if isinstance(c, Alike):
            lines.append(f"{_shown(c.left)} {'==' if c.holds else '/='} {_shown(c.right)}")
            continue
        subject, relation, other = _solved(c)
        if isinstance(subject, Unknown) and relation in ("<", "<=", ">", ">="):
            side = "above" if relation[0] == "<" else "below"
            if side not in bounds.setdefault(subject, {}):
                bounds[subject][side] = f" {relation} {_shown(other)}" if side == "above" else _shown(other)
                bounds[subject][f"{side} strictly"] = relation
                continue
        lines.append(f"{_shown(subject)} {relation} {_shown(other)}")
    return [*(_between(subject, found) for subject, found in bounds.items()), *lines]


def _between(subject: Unknown, found: dict[str, str]) -> str:
    if "below" not in found:
        return f"{subject!r}{found['above']}"
    if "above" not in found:
        return f"{subject!r} {found['below strictly']} {found['below']}"
    if found["above"] == f" <= {found['below']}" and found["below strictly"] == ">=":
        return f"{subject!r} == {found['below']}"
    return f"{found['below']} {found['below strictly'].replace('>', '<')} {subject!r}{found['above']}"


def _solved(c: Compared) -> tuple[Any, str, Any]:
    """`subject relation other`: solved for the youngest unknown that stands alone; `==` and `/=` are left as sums."""
    if c.relation in ("==", "/="):
        factors, rest = split(c.value)
        return joined(factors, 0), c.relation, -rest or 0
    factors, rest = split(c.value)
    alone = [p for p, f in factors.items() if abs(f) == 1 and isinstance(p, Unknown)]
    fresh = [p for p in alone if p.serial > 0]
    if fresh or (alone and len(factors) <= 2):
        subject = fresh[-1] if fresh else alone[0]
        sign = factors.pop(subject)
        return subject, c.relation if sign > 0 else c.relation.replace("<", ">"), joined(factors, rest) * -sign
    left = joined({p: f for p, f in factors.items() if f > 0}, 0)
    right = joined({p: -f for p, f in factors.items() if f < 0}, -rest)
    return left, c.relation, right


def _shown(value: Any) -> str:
    return show(constant(value))
