"""Checks on situations and reactions (R §5.2 to §5.5; `semantics`, Transitions: ASSERT and SIT).

In a reaction, that is beside an `E[…]`, a SIT is the whole left operand of `:;` or `::`, and no body that it
opens calls the definition that holds it: what comes after the body would else be cut off when the reaction is
removed, or an ASSERT would never return. A situation may be asserted from below itself only if it is served
by `::`: a `:;` serves one instance at a time, and the inner one would wait for the outer for ever.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator
from typing import TypeAlias

from planner_reactor.errors import Diagnostic, Place
from planner_reactor.rs.facts import Service, facts_of
from planner_reactor.rs.graphs import cycles, reachable, way_round
from planner_reactor.rs.linking import Linked, error, value_of, warning
from planner_reactor.rs.terms import Call, Expression, Process, calls
from planner_reactor.rs.uses import Uses

Node: TypeAlias = str | int
"""A situation by its name, or a definition by its number."""

ASSERTING = frozenset({"ASSERT", "REASSERT"})


def check_situations(linked: Linked) -> Iterator[Diagnostic]:
    """Errors "sit-position", "self-call" and "asserted-below-itself"."""
    yield from _reactions(linked)
    yield from _below_itself(linked)


def check_service(linked: Linked, used: Uses) -> Iterator[Diagnostic]:
    """Warnings "unserved-situation"."""
    served = used.of([("SIT", 0)])
    asserted = used.of([("ASSERT", 0), ("REASSERT", 0)])
    if ("SIT", 0) in used.open_sinks:
        return
    meant = [situation for situation in served if situation not in asserted]
    for name, place in asserted.items():
        if name not in served:
            hint = linked.nearest(name, meant) or f"nothing here waits for it with SIT[{name}]"
            yield warning(place, "unserved-situation", f"situation {name} is asserted but never served", hint)


def _reactions(linked: Linked) -> Iterator[Diagnostic]:
    """The rules for SIT in everything that stands beside a guard, or is called from there."""
    beside = [part for number in linked.focus for part in linked.facts[number].guarded]
    newly = reachable(linked.calls, _called(linked, beside))
    guarded = reachable(linked.calls, _called(linked, [p for facts in linked.facts for p in facts.guarded]))
    reactions = [number for number in guarded if number in newly or number in linked.focus]
    strays = [sit for part in beside for sit in facts_of(part).strays]
    strays += [sit for number in reactions for sit in linked.facts[number].strays]
    for sit in strays:
        hint = "write SIT[…]<k> :; (…) or SIT[…]<k> :: (…)"
        message = "in a reaction a SIT is the whole left side of `:;` or `::`"
        yield error(sit.place, "sit-position", message, hint)
    cycle_of = {n: together for c in cycles(linked.calls_in_focus) for together in [frozenset(c)] for n in c}
    for number in reactions:
        yield from _self_calls(linked, number, cycle_of.get(number, frozenset()))


def _called(linked: Linked, processes: Iterable[Process]) -> list[int]:
    return [target for process in processes for call in calls(process) for target in linked.targets(call)]


def _self_calls(linked: Linked, number: int, cycle: Collection[int]) -> Iterator[Diagnostic]:
    """Calls from which control comes back to the definition, on its cycle of the call graph."""
    name = linked.schemas[number].name
    for service in linked.facts[number].services if cycle else ():
        for call in calls(service.body):
            if any(target in cycle for target in linked.targets(call)):
                message = f"the body of this SIT calls {name}, which holds it"
                hint = "a loop goes on by itself when its body has ended"
                yield error(call.place, "self-call", message, hint)


def _below_itself(linked: Linked) -> Iterator[Diagnostic]:
    """Cycles of the graph in which a situation leads to what the bodies that serve it assert and call, and a
    definition to what it asserts and calls."""
    services: dict[str, list[Service]] = {}
    for facts in linked.facts:
        for service in facts.services:
            name = _name(service.situation)
            if name is not None:
                services.setdefault(name, []).append(service)
    begun = (_name(service.situation) for n in linked.focus for service in linked.facts[n].services)
    waiting: list[Node] = [name for name in begun if name is not None]
    below: dict[Node, dict[Node, Place | None]] = {}
    while waiting:
        node = waiting.pop()
        if node not in below:
            found = linked.facts[node].calls if isinstance(node, int) else _calls_of(services.get(node, ()))
            below[node] = _steps(linked, found)
            waiting.extend(below[node])
    for cycle in cycles(below):
        together = set(cycle)
        asserted = {s: place for node in cycle for s, place in below[node].items() if s in together}
        wrong = (s for s in asserted if isinstance(s, str) and not any(v.spawns for v in services[s]))
        name = next(wrong, None)  # one for each cycle: the way round names the others
        if name is not None:
            way = [node for node in way_round(below, name) if isinstance(node, str)]
            yield _asserted_below(name, way, asserted[name])


def _calls_of(services: Iterable[Service]) -> Iterator[Call]:
    return (call for service in services for call in calls(service.body))


def _steps(linked: Linked, found: Iterable[Call]) -> dict[Node, Place | None]:
    """The situations that these calls assert, as far as the text names them, and the definitions they
    select."""
    steps: dict[Node, Place | None] = {}
    for call in found:
        name = _name(call.arguments[0]) if call.name in ASSERTING and call.arguments else None
        if name is not None:
            steps.setdefault(name, call.place)
        for target in linked.targets(call):
            steps.setdefault(target, call.place)
    return steps


def _asserted_below(name: str, way: list[str], place: Place | None) -> Diagnostic:
    message = f"situation {name} is asserted from below itself"
    hint = f"its `:;` would wait for itself ({' → '.join(way)}); serve it with SIT[{name}]<k> :: …"
    return error(place, "asserted-below-itself", message, hint)


def _name(situation: Expression | None) -> str | None:
    value = None if situation is None else value_of(situation)
    return value if isinstance(value, str) else None
