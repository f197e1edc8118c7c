"""What the conditions of a limit set say of the parameters of a network (X §6.1, the stop conditions).

A comparison says it itself. A process of the host says it if it declares a test that it agrees with
(`Signature.means`), or if the text defines it; of any other only its name is known, and nothing follows from it.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

from planner_reactor.analysis.conditions import Atom, Event, constraints_of
from planner_reactor.analysis.rounds import ways_through
from planner_reactor.rs.configurations import World
from planner_reactor.rs.constraints import implies, instance
from planner_reactor.rs.parser import parse_process
from planner_reactor.rs.unknowns import Alike, Applied, Compared, Constraint, Sum, Unknown, unknowns


def meaning(atom: Atom, world: World) -> tuple[Constraint, ...] | None:
    """The comparisons that an atom stands for; None if nobody knows."""
    if not isinstance(atom, Event):
        return (atom,)
    signature = world.signatures.get(atom.name)
    if atom.kind != "process" or signature is None or not signature.means:
        return None
    test = parse_process(signature.means, bound=signature.parameters)
    scope = dict(zip(signature.parameters, atom.arguments, strict=False))
    ways = [w for w in ways_through(test, world, scope) if w.end == ("ok" if atom.ok else "ab")]
    return constraints_of(ways[0].given) if len(ways) == 1 else None


def after(constraints: Iterable[Constraint], values: Mapping[Unknown, Any]) -> list[Constraint | bool]:
    """The comparisons where these unknowns have these values; True or False where nothing is left to ask."""
    return [_after(c, values) for c in constraints]


def _after(constraint: Constraint, values: Mapping[Unknown, Any]) -> Constraint | bool:
    if isinstance(constraint, Alike):
        left, right = instance(constraint.left, values), instance(constraint.right, values)
        return (left == right) is constraint.holds if left == right else Alike(left, right, constraint.holds)
    value = instance(constraint.value, values)
    if isinstance(value, Unknown | Sum | Applied):
        return Compared(value, constraint.relation, constraint.tolerance)
    tests = {"<": value < 0, "<=": value <= 0, "==": abs(value) <= constraint.tolerance}
    return bool(tests.get(constraint.relation, abs(value) > constraint.tolerance))


def assured(constraints: Iterable[Constraint], values: Mapping[Unknown, Any], known: Iterable[Constraint] = ()) -> bool:
    """Do all of them hold where these unknowns have these values, whatever the others are?"""
    taken = list(known)
    return all(c is True or (c is not False and implies(taken, c)) for c in after(constraints, values))


def distance(constraints: Iterable[Constraint]) -> Any:
    """The D of a condition that asks `D == 0`; None if it does not."""
    return next((c.value for c in constraints if isinstance(c, Compared) and c.relation == "=="), None)


def sizes(values: Iterable[Any], own: Iterable[Unknown]) -> list[Constraint]:
    """That the names which a text leaves open stand for more than 0, parameters of the network left out."""
    apart = set(own)
    found = dict.fromkeys(u for v in values for u in unknowns(v) if u.serial <= 0 and u not in apart)
    return [Compared(-u, "<") for u in found]
