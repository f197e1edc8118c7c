"""What the leaves do that act on situations, and on what holds them back (docs/language.md, Transitions).

One function for each rule, named after it: from the leaf, where it stands, the store and the world to the status that
an observer sees, the values, what the leaf becomes, and the store afterwards; None if it has no step now.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeAlias

from planner_reactor.rs.configurations import AB, OK, WAITS, World
from planner_reactor.rs.expressions import is_number
from planner_reactor.rs.migration import migrated
from planner_reactor.rs.states import Await, Delivered, Ended, Leaf, Queued, Reaction, Run, Spot, Waiting, results_of
from planner_reactor.rs.store import Store
from planner_reactor.rs.terms import Value

Result: TypeAlias = tuple[str, tuple[Value, ...], Run, Store]
Rule: TypeAlias = Callable[[Leaf, Spot, Store, World], Result | None]


def assert_(leaf: Leaf, spot: Spot, store: Store, world: World) -> Result | None:
    """ASSERT, REASSERT: a new instance, owned by the instance whose body this is."""
    situation, *rest = leaf.arguments
    if not isinstance(situation, str):
        return AB, (), Ended(False, cause="error"), store
    arguments = tuple(rest)
    if store.gone(spot.owner):
        return AB, (), Ended(False, cause="withdrawn"), store
    if situation not in world.spawned and store.above(spot.owner, situation):
        return AB, (), Ended(False, cause="error"), store
    if store.holds_back(situation):
        store, ticket = store.queued(situation, arguments, spot.owner)
        return WAITS, (), Queued(ticket, leaf), store
    store, number = store.asserted(situation, arguments, spot.owner)
    return WAITS, (), Await(number, leaf.results, leaf if leaf.name == "REASSERT" else None), store


def sit(leaf: Leaf, spot: Spot, store: Store, world: World) -> Result | None:
    """SIT: deliver the least recently served instance that this reaction may serve."""
    situation = str(leaf.arguments[0])
    reaction = Reaction(spot.guard, leaf.site)
    instance = store.available(situation, reaction)
    if instance is None:
        return None
    values = (instance.number, *instance.arguments)
    bindings = results_of(leaf, values)
    store = store.stamped(instance.number, reaction)
    if leaf.opens:
        return OK, values, Delivered(situation, instance.number, reaction, bindings), store
    return OK, values, Ended(True, bindings), store


def succeed(leaf: Leaf, spot: Spot, store: Store, world: World) -> Result | None:
    return OK, (), Ended(True), _ended_instance(leaf, store, ok=True)


def fail(leaf: Leaf, spot: Spot, store: Store, world: World) -> Result | None:
    return OK, (), Ended(True), _ended_instance(leaf, store, ok=False)


def _ended_instance(leaf: Leaf, store: Store, *, ok: bool) -> Store:
    situation, number = leaf.arguments
    instance = store.get(number) if isinstance(number, int) else None
    return store.ended(instance.number, ok=ok) if instance and instance.situation == situation else store


def update(leaf: Leaf, spot: Spot, store: Store, world: World) -> Result | None:
    """UPDATE[s,k,v…]: the values that ASSERT will return."""
    situation, number, *values = leaf.arguments
    instance = store.get(number) if isinstance(number, int) else None
    if instance and instance.situation == situation and instance.status == "on":
        store = store.changed(instance.number, values=tuple(values))
    return OK, (), Ended(True), store


def wait(leaf: Leaf, spot: Spot, store: Store, world: World) -> Result | None:
    """WAIT, WAITINHIBIT: their start; granted inside the step that makes the situation quiescent."""
    return WAITS, (), Waiting(leaf.name, str(leaf.arguments[0])), store


def drain(leaf: Leaf, spot: Spot, store: Store, world: World) -> Result | None:
    situation = str(leaf.arguments[0])
    return WAITS, (), Waiting("DRAIN", situation), store.drain(situation, spot.root)


def renew(leaf: Leaf, spot: Spot, store: Store, world: World) -> Result | None:
    """RENEW[s]: from here on instances of s are of the next version, and reactions serve the versions they know."""
    return OK, (), Ended(True), store.renewed(str(leaf.arguments[0]))


def wait_old(leaf: Leaf, spot: Spot, store: Store, world: World) -> Result | None:
    """WAITOLD[s]: its start; granted inside the step that ends the last instance of an older version."""
    situation = str(leaf.arguments[0])
    return WAITS, (), Waiting("WAITOLD", situation, store.version(situation)), store


def migrate(leaf: Leaf, spot: Spot, store: Store, world: World) -> Result | None:
    """MIGRATE[s, a…]: what is held back takes these arguments, and stays if whoever asserted it is removed."""
    situation, *how = leaf.arguments
    return OK, (), Ended(True), store.migrated(str(situation), lambda old: migrated(old, how, world.functions))


def inhibit(leaf: Leaf, spot: Spot, store: Store, world: World) -> Result | None:
    return OK, (), Ended(True), store.inhibit(str(leaf.arguments[0]), spot.root, "inhibit")


def uninhibit(leaf: Leaf, spot: Spot, store: Store, world: World) -> Result | None:
    return OK, (), Ended(True), store.uninhibit(str(leaf.arguments[0]), spot.root)


def disable(leaf: Leaf, spot: Spot, store: Store, world: World) -> Result | None:
    """What a failed assumption does to a situation that rests on it."""
    situation, assumption = str(leaf.arguments[0]), str(leaf.arguments[1])
    owner = ("assumption", assumption)
    if any(h.situation == situation and h.owner == owner for h in store.inhibitions):
        return OK, (), Ended(True), store
    return OK, (), Ended(True), store.inhibit(situation, owner, "assumption")


def enable(leaf: Leaf, spot: Spot, store: Store, world: World) -> Result | None:
    situation, assumption = str(leaf.arguments[0]), str(leaf.arguments[1])
    return OK, (), Ended(True), store.uninhibit(situation, ("assumption", assumption))


def disabled(leaf: Leaf, spot: Spot, store: Store, world: World) -> Result | None:
    """DISABLED[s]<a>: stops while a failed assumption disables s; a is the one that did it first."""
    owner = store.disabled_by(str(leaf.arguments[0]))
    if owner is None:
        return None
    return OK, (owner,), Ended(True, results_of(leaf, (owner,))), store


def enabled(leaf: Leaf, spot: Spot, store: Store, world: World) -> Result | None:
    """ENABLED[s]: stops while none does."""
    return None if store.disabled(str(leaf.arguments[0])) else (OK, (), Ended(True), store)


def stub(leaf: Leaf, spot: Spot, store: Store, world: World) -> Result | None:
    """STUB[s]: the failure that follows is known to come from a placeholder."""
    return OK, (), Ended(True), store if spot.owner is None else store.changed(spot.owner, stub=True)


def report(leaf: Leaf, spot: Spot, store: Store, world: World) -> Result | None:
    return OK, (), Ended(True), store


def monitor(leaf: Leaf, spot: Spot, store: Store, world: World) -> Result | None:
    """ASSUMONITOR, HOLDMONITOR: what they sense is no step; without a period they abort."""
    period = leaf.arguments[1]
    if is_number(period) and period > 0:  # type: ignore[operator]  # a number
        return None
    return AB, (), Ended(False, cause="error"), store


RULES: dict[str, Rule] = {
    "ASSERT": assert_,
    "REASSERT": assert_,
    "SIT": sit,
    "SUCCEED": succeed,
    "FAIL": fail,
    "UPDATE": update,
    "WAIT": wait,
    "WAITINHIBIT": wait,
    "DRAIN": drain,
    "RENEW": renew,
    "WAITOLD": wait_old,
    "MIGRATE": migrate,
    "INHIBIT": inhibit,
    "UNINHIBIT": uninhibit,
    "DISABLE": disable,
    "ENABLE": enable,
    "DISABLED": disabled,
    "ENABLED": enabled,
    "STUB": stub,
    "REPORT": report,
    "ASSUMONITOR": monitor,
    "HOLDMONITOR": monitor,
}
"""By the name of the leaf."""
