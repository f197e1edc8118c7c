"""The parts of a network, what they say to each other, and the subnet that matters for given ports (X §7, "Snet").

The components of a process are the calls that its definitions compose with `|`, however deep: of GEM (X §5.2) there
are five. A component matters for a port if it reads or writes it, or if one that matters depends on it: a reader on
whoever writes, a writer on whoever reads, unless it writes by a STREAM, which nobody holds up.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator
from functools import cached_property

import msgspec

from planner_reactor.errors import InputError, nearest
from planner_reactor.rs.configurations import World
from planner_reactor.rs.expressions import EvaluationError, evaluate
from planner_reactor.rs.given import constant, process_with_values
from planner_reactor.rs.terms import Call, Expression, Par, Parameter, Process, Schema, Value, Variable, calls


class Traffic(msgspec.Struct, frozen=True):
    """The ports at which a process reads, writes and waits, and streams. None: one that only a run will tell."""

    reads: frozenset[Value] = frozenset()
    writes: frozenset[Value] = frozenset()
    streams: frozenset[Value] = frozenset()

    @property
    def ports(self) -> frozenset[Value]:
        return self.reads | self.writes | self.streams

    def needs(self, other: Traffic) -> bool:
        """Does what this one does depend on the other?"""
        return bool(self.reads & (other.writes | other.streams) or self.writes & other.reads or None in self.ports)


class Network(msgspec.Struct, frozen=True, dict=True):
    """A process as the tree of its concurrent components: `call` is one of them, or composes `parts` with `|`."""

    call: Process
    parts: tuple[Network, ...] = ()

    @cached_property
    def components(self) -> tuple[Process, ...]:
        """The leaves, from left to right."""
        return tuple(c for part in self.parts for c in part.components) if self.parts else (self.call,)


def network(process: Process, world: World, *, whole: Collection[str] = ()) -> Network:
    """The tree of a process; definitions in `whole` are not opened."""
    match process:
        case Par(parts):
            return Network(process, tuple(network(part, world, whole=whole) for part in parts))
        case Call() if not process.results and process.name not in whole and (opened := body_of(process, world)):
            inner = network(opened, world, whole=(*whole, process.name)) if isinstance(opened, Par) else None
            return Network(process, inner.parts if inner else ())
    return Network(process)


def body_of(call: Call, world: World) -> Process | None:
    """The body of the definition that this call means, with its values in place; None if there is none."""
    try:
        values = tuple(evaluate(a, {}, world.functions) for a in call.arguments)
    except EvaluationError:
        return None
    schema = world.select(call.name, values)
    return with_arguments(schema, values) if schema is not None else None


def with_arguments(schema: Schema, values: tuple[Value, ...]) -> Process:
    """The body of the schema where its parameters have these values."""
    given = {h.name: v for h, v in zip(schema.head, values, strict=True) if isinstance(h, Parameter)}
    return process_with_values(schema.body, given, Variable)


def traffic(process: Process, world: World) -> Traffic:
    """The ports of a process, through every definition that it may come to call."""
    found: dict[tuple[str, Value], None] = {}
    seen: set[tuple[str, tuple[Value, ...]]] = set()
    waiting: list[tuple[Process, dict[str, Value]]] = [(process, {})]
    while waiting:
        body, scope = waiting.pop()
        for call in calls(body):
            values = tuple(_value(a, scope, world) for a in call.arguments)
            if call.name in ("IN", "OUT", "STREAM"):
                found[call.name, values[0]] = None
            elif (call.name, values) not in seen:
                seen.add((call.name, values))
                waiting += [(s.body, _scope(s, values)) for s in world.program.clauses(call.name)]
    return Traffic(*(frozenset(p for n, p in found if n == name) for name in ("IN", "OUT", "STREAM")))


def _scope(schema: Schema, values: tuple[Value, ...]) -> dict[str, Value]:
    return {h.name: v for h, v in zip(schema.head, values, strict=False) if isinstance(h, Parameter) and v is not None}


def _value(expression: Expression, scope: dict[str, Value], world: World) -> Value:
    """The value if it is a name: of others it does not matter."""
    try:
        value = evaluate(expression, scope, world.functions)
    except (EvaluationError, ValueError):
        return None
    return value if isinstance(value, str) else None


def open_ports(components: Iterable[Process], world: World) -> frozenset[Value]:
    """The ports of which the network has only one side: the other is the world outside."""
    found = [traffic(component, world) for component in components]
    reads: frozenset[Value] = frozenset().union(*(t.reads for t in found))
    writes: frozenset[Value] = frozenset().union(*(t.writes | t.streams for t in found))
    return (reads ^ writes) - {None}


def subnet(process: Process, world: World, ports: Collection[str]) -> tuple[Process, ...]:
    """Snet: the components that matter for these ports, in their order. InputError for a port that nobody uses."""
    components = network(process, world).components
    found = {i: traffic(c, world) for i, c in enumerate(components)}
    known = sorted({str(p) for t in found.values() for p in t.ports if p is not None})
    for port in ports:
        if port not in known:
            raise InputError(f"no component uses port {port}, {nearest(port, known) or f'there are: {known}'}")
    matters = {i for i, t in found.items() if t.ports & set(ports)}
    waiting = sorted(matters)
    while waiting:
        here = waiting.pop()
        more = sorted(i for i, t in found.items() if i not in matters and found[here].needs(t))
        matters.update(more)
        waiting += more
    return tuple(c for i, c in enumerate(components) if i in matters)


def folded(tree: Network, now: Iterator[Process | None], world: World) -> Process | None:
    """The network again after components have changed: as one call where a definition says so, else part by part.

    `now` gives what each component is now, in their order; None if it is gone.
    """
    if not tree.parts:
        return next(now)
    parts = [folded(part, now, world) for part in tree.parts]
    if all(new == old.call for new, old in zip(parts, tree.parts, strict=True)):
        return tree.call
    left = [part for part in parts if part is not None]
    if isinstance(tree.call, Call) and len(left) == len(parts):
        refolded = _refolded(tree.call, left, world)
        if refolded is not None:
            return refolded
    flat = [p for part in left for p in (part.parts if isinstance(part, Par) else (part,))]
    return Par(tuple(flat)) if len(flat) > 1 else flat[0] if flat else None


def _refolded(call: Call, parts: list[Process], world: World) -> Call | None:
    """The same definition with the arguments that make its body these parts, if there are any."""
    values = tuple(evaluate(a, {}, world.functions) for a in call.arguments)
    schema = world.select(call.name, values)
    assert schema is not None
    body = schema.body
    given = {h.name: v for h, v in zip(schema.head, values, strict=True) if isinstance(h, Parameter)}
    for name, value in _bindings(body, parts, world):
        if name in given:
            before = given[name]
            given[name] = value if before == dict(_own(schema, values))[name] else before
    arguments = tuple(given.get(h.name) if isinstance(h, Parameter) else h.value for h in schema.head)
    again = Call(call.name, tuple(map(constant, arguments)))
    made = with_arguments(schema, arguments)
    return again if isinstance(made, Par) and [_valued(p, world) for p in made.parts] == parts else None


def _own(schema: Schema, values: tuple[Value, ...]) -> Iterator[tuple[str, Value]]:
    return ((h.name, v) for h, v in zip(schema.head, values, strict=True) if isinstance(h, Parameter))


def _bindings(body: Process, parts: list[Process], world: World) -> Iterator[tuple[str, Value]]:
    """What bare parameters in the calls of a body stand for, if its parts are these."""
    assert isinstance(body, Par)
    for pattern, part in zip(body.parts, parts, strict=True):
        if isinstance(pattern, Call) and isinstance(part, Call) and pattern.name == part.name:
            for argument, given in zip(pattern.arguments, part.arguments, strict=False):
                if isinstance(argument, Variable):
                    yield argument.name, evaluate(given, {}, world.functions)


def _valued(process: Process, world: World) -> Process:
    """A call with its arguments worked out."""
    if not isinstance(process, Call):
        return process
    return Call(
        process.name, tuple(constant(evaluate(a, {}, world.functions)) for a in process.arguments), process.results
    )
