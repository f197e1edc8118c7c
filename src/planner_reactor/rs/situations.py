"""Checks on situations and reactions (R §5.2 to §5.5; `semantics`, Transitions: ASSERT and SIT).

In a reaction, that is beside an `E[…]`, a SIT is the whole left operand of `:;` or `::`, and no body that it
opens calls the definition that holds it: what comes after the body would else be cut off when the reaction is
removed, or an ASSERT would never return. A situation may be asserted from below itself only if it is served
by `::`: a `:;` serves one instance at a time, and the inner one would wait for the outer for ever.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator

from planner_reactor.errors import Diagnostic, Place, nearest
from planner_reactor.rs.facts import facts_of
from planner_reactor.rs.graphs import cycles, reachable
from planner_reactor.rs.linking import Linked, error, value_of, warning
from planner_reactor.rs.terms import Expression, Process, calls
from planner_reactor.rs.uses import Uses

ASSERTING = frozenset({"ASSERT", "REASSERT"})


def check_situations(linked: Linked, used: Uses) -> Iterator[Diagnostic]:
    """Errors "sit-position", "self-call" and "asserted-below-itself", warning "unserved-situation"."""
    yield from _reactions(linked)
    yield from _below_itself(linked)
    yield from _unserved(used)


def _unserved(used: Uses) -> Iterator[Diagnostic]:
    served = used.of([("SIT", 0)])
    asserted = used.of([("ASSERT", 0), ("REASSERT", 0)])
    if ("SIT", 0) in used.open_sinks:
        return
    for name, place in asserted.items():
        if name not in served:
            meant = nearest(name, [s for s in served if s not in asserted])
            hint = meant or f"nothing here waits for it with SIT[{name}]"
            yield warning(place, "unserved-situation", f"situation {name} is asserted but never served", hint)


def _reactions(linked: Linked) -> Iterator[Diagnostic]:
    """The rules for SIT in everything that stands beside a guard, or is called from there."""
    inline = [part for facts in linked.facts for part in facts.guarded]
    called = [t for part in inline for call in calls(part) for t in linked.targets(call)]
    reactions = reachable(linked.calls, called)
    strays = [sit for part in inline for sit in facts_of(part).strays]
    strays += [sit for number in reactions for sit in linked.facts[number].strays]
    for sit in strays:
        hint = "write SIT[…]<k> :; (…) or SIT[…]<k> :: (…)"
        message = "in a reaction a SIT is the whole left side of `:;` or `::`"
        yield error(sit.place, "sit-position", message, hint)
    together = {number: i for i, cycle in enumerate(cycles(linked.calls)) for number in cycle}
    for number in reactions:
        if number in together:
            yield from _self_calls(linked, number, {n for n in together if together[n] == together[number]})


def _self_calls(linked: Linked, number: int, cycle: Collection[int]) -> Iterator[Diagnostic]:
    name = linked.schemas[number].name
    for service in linked.facts[number].services:
        for call in calls(service.body):
            if any(target in cycle for target in linked.targets(call)):
                message = f"the body of this SIT calls {name}, which holds it"
                hint = "a loop goes on by itself when its body has ended"
                yield error(call.place, "self-call", message, hint)


def _below_itself(linked: Linked) -> Iterator[Diagnostic]:
    asserted: dict[str, dict[str, Place | None]] = {}
    spawned: set[str] = set()
    for facts in linked.facts:
        for service in facts.services:
            name = _name(service.situation)
            if name is not None:
                asserted.setdefault(name, {}).update(_asserted(linked, service.body))
                spawned |= {name} if service.spawns else set()
    for cycle in cycles(asserted):
        for above in cycle:
            for name, place in asserted[above].items():
                if name in cycle and name not in spawned:
                    yield _asserted_below(name, above, place)


def _asserted(linked: Linked, body: Process) -> dict[str, Place | None]:
    """The situations that this body asserts, itself or through definitions, as far as the text names them."""
    own = list(calls(body))
    through = reachable(linked.calls, [t for call in own for t in linked.targets(call)])
    found: dict[str, Place | None] = {}
    for call in (*own, *(c for number in through for c in linked.facts[number].calls)):
        name = _name(call.arguments[0]) if call.name in ASSERTING and call.arguments else None
        if name is not None:
            found.setdefault(name, call.place)
    return found


def _asserted_below(name: str, above: str, place: Place | None) -> Diagnostic:
    message = f"situation {name} is asserted from below itself"
    through = "" if above == name else f" (here from below {above})"
    hint = f"its `:;` would wait for itself{through}; serve it with SIT[{name}]<k> :: …"
    return error(place, "asserted-below-itself", message, hint)


def _name(situation: Expression | None) -> str | None:
    value = None if situation is None else value_of(situation)
    return value if isinstance(value, str) else None
