"""The sensory-motor interface of an agent, and what the ports of a model carry (X §3.3, §5.1, §6.2).

The interface is what stands between the environment and the agent: definitions that the environment does not use, each
of which reads a port that the environment writes (a sensory process), or writes one that it reads (a motor process).
It is found from the ports; nothing is known by its name.

A port carries a quantity: what its writer offers, in terms of the parameters of the network, traced back through every
value that was taken on the way. `pos` of X §5.1 carries p: its writer took it from `op`, where Object offers it.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator
from typing import Any, Literal

import msgspec

from planner_reactor.analysis.denseness import Failure, Netlist
from planner_reactor.analysis.subnets import network, open_ports, traffic
from planner_reactor.errors import InputError, nearest
from planner_reactor.rs.configurations import World
from planner_reactor.rs.constraints import instance
from planner_reactor.rs.expressions import EvaluationError, evaluate
from planner_reactor.rs.graphs import reachable
from planner_reactor.rs.terms import Call, Parameter, Process, Value, Variable, calls
from planner_reactor.rs.unknowns import Symbolic, Unknown


class Connector(msgspec.Struct, frozen=True):
    """One process of the interface: `inner` is its port towards the agent, `outer` that towards the environment."""

    process: Call
    inner: str
    outer: str
    kind: Literal["sensory", "motor"]


def interface(environment: Process, world: World, processes: Collection[Call] | None = None) -> tuple[Connector, ...]:
    """The sensory and motor processes of an environment, in the order of the text; `processes` says which (else all).

    A port that is read within the environment too is one of the interface if nothing else of the text uses the process
    that reads it. InputError for a process that connects nothing.
    """
    outside = open_ports(network(environment, world).components, world)
    own = traffic(environment, world)
    if processes is None:
        used = {c.name for schema in world.program.schemas for c in calls(schema.body)}
        found = [c for call in _candidates(environment, world) for c in _connectors(call, world, own, outside)]
        return tuple(c for c in found if c.outer in outside or c.process.name not in used)
    found = []
    for call in processes:
        if not world.program.clauses(call.name):
            hint = nearest(call.name, world.program.names) or "expected a definition of the text"
            raise InputError(f"no process {call.name} for the interface, {hint}")
        made = list(_connectors(call, world, own, outside))
        if not made:
            ports = ", ".join(sorted(map(str, outside))) or "none"
            raise InputError(f"{call.name} connects no port of the environment, whose open ports are: {ports}")
        found += made
    return tuple(found)


def _candidates(environment: Process, world: World) -> Iterator[Call]:
    """Definitions without parameters that neither belong to the environment nor hold it."""
    program = world.program
    edges = {s.name: tuple(c.name for clause in program.clauses(s.name) for c in calls(clause.body))
             for s in program.schemas}  # fmt: skip
    roots = [c.name for c in calls(environment)]
    inside = reachable(edges, [r for r in roots if r in edges])
    for schema in program.schemas:
        if schema.name not in inside and not schema.head:
            below = reachable(edges, [schema.name])
            if not set(below) & set(roots):
                yield Call(schema.name)


def _connectors(call: Call, world: World, own: Any, outside: Collection[Value]) -> Iterator[Connector]:
    found = traffic(call, world)
    writes, reads = found.writes | found.streams, found.reads
    for outer in sorted(map(str, reads & (own.writes | own.streams))):
        for inner in sorted(str(p) for p in writes - own.ports if p is not None):
            yield Connector(call, inner, outer, "sensory")
    for outer in sorted(map(str, writes & own.reads & set(outside))):
        for inner in sorted(str(p) for p in reads - own.ports if p is not None):
            yield Connector(call, inner, outer, "motor")


def sensors(environment: Process, world: World, ports: Collection[Value]) -> tuple[str, ...]:
    """The definitions of the environment that themselves write one of these ports, or one that nothing in it reads: the
    pseudo-bounds of X §4.3.2.

    A component that writes it in its own rounds is none: it goes on, and says where it is all the time.
    """
    own = traffic(environment, world)
    ports = {*ports, *((own.writes | own.streams) - own.reads)}
    found: dict[str, None] = {}
    seen: set[tuple[str, tuple[Value, ...]]] = set()
    waiting: list[tuple[str, tuple[Value, ...], Process, dict[str, Value]]] = [("", (), environment, {})]
    whole = {c.name for c in network(environment, world).components if isinstance(c, Call)}
    while waiting:
        name, _, body, scope = waiting.pop()
        for call in calls(body):
            values = tuple(_name(a, scope, world) for a in call.arguments)
            if call.name in ("OUT", "STREAM") and values and values[0] in ports and name and name not in whole:
                found[name] = None
            for schema in world.program.clauses(call.name):
                if (call.name, values) not in seen:
                    seen.add((call.name, values))
                    inner = {h.name: v for h, v in zip(schema.head, values, strict=False) if isinstance(h, Parameter)}
                    waiting.append((call.name, values, schema.body, inner))
    return tuple(sorted(found))


def _name(expression: Any, scope: dict[str, Value], world: World) -> Value:
    if isinstance(expression, Variable):
        return scope.get(expression.name)
    try:
        value = evaluate(expression, scope, world.functions)
    except (EvaluationError, ValueError):
        return None
    return value if isinstance(value, str) else None


def carried(port: Value, nets: Netlist, seen: Collection[Value] = ()) -> Any:
    """What a port carries, in terms of the parameters of the network; None if nobody can tell."""
    if port in seen or isinstance(own := nets.local(port), Failure):
        return None
    (writer,) = nets.writers(port)
    known = dict(parameters(nets.components[writer], nets.world))
    for taken, got in (t for takes in own.takes for t in takes):
        known[got] = carried(taken, nets, (*seen, port))
    if not isinstance(own.value, Symbolic):
        return own.value
    try:
        return instance(own.value, known)
    except TypeError:
        return None


def parameters(component: Process, world: World) -> Iterator[tuple[Unknown, Any]]:
    """The parameters of a component as its rounds name them, each with what the network gives it."""
    if isinstance(component, Call):
        values = tuple(evaluate(a, {}, world.functions) for a in component.arguments)
        schema = world.program.select(component.name, values)
        for head, value in zip(schema.head if schema else (), values, strict=False):
            if isinstance(head, Parameter) and not isinstance(value, str):
                yield Unknown(head.name, -1), value


def feeding(port: Value, nets: Netlist) -> tuple[Value, ...]:
    """The ports that the writer of a port takes from."""
    own = nets.local(port)
    return () if isinstance(own, Failure) else tuple(p for takes in own.takes for p, _ in takes)
