"""Where a program calls itself: which calls go back to a definition that is under way (X §4.3.2).

Every cycle of calls is entered somewhere; the calls that lead back to its entry are its recursions. In the cycle
without them there may be cycles still, with entries of their own, and so on. `bounded` makes each recursion a leaf
that never ends, `Object'`, which holds the new arguments and those at the entry: there an analysis stops and compares.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping

from msgspec.structs import replace

from planner_reactor.rs.configurations import World
from planner_reactor.rs.given import constant
from planner_reactor.rs.graphs import cycles, reachable
from planner_reactor.rs.terms import (
    Call,
    If,
    Loop,
    Not,
    Parameter,
    Process,
    Program,
    Schema,
    Spawn,
    Value,
    Variable,
    calls,
)
from planner_reactor.rs.vocabulary import NEVER_ENDS, Signature

MARK = "'"
"""Ends the name of a recursion: no name in a text does."""

FOREVER = (float("inf"), float("inf"))


def recursions(program: Program, roots: Collection[str]) -> frozenset[tuple[str, str]]:
    """(caller, callee) of every call that leads back to the entry of a cycle."""
    edges = {s.name: tuple(_called(program, s.name)) for s in program.schemas}
    reached = reachable(edges, [r for r in roots if r in edges])
    return frozenset(_back({n: edges[n] for n in reached}, roots))


def _called(program: Program, name: str) -> dict[str, None]:
    """The definitions that this one calls."""
    found = (call.name for schema in program.clauses(name) for call in calls(schema.body))
    return {callee: None for callee in found if program.clauses(callee)}


def _back(edges: Mapping[str, tuple[str, ...]], roots: Collection[str]) -> set[tuple[str, str]]:
    found: set[tuple[str, str]] = set()
    for cycle in cycles(edges):
        outside = {callee for caller, callees in edges.items() if caller not in cycle for callee in callees}
        entries = [n for n in cycle if n in outside or n in roots] or cycle[:1]
        back = {(caller, callee) for caller in cycle for callee in edges[caller] if callee in entries}
        inner = {n: tuple(c for c in edges[n] if c in cycle and (n, c) not in back) for n in cycle}
        found |= back | _back(inner, {c for n in entries for c in inner[n]})
    return found


def bounded(world: World, roots: Collection[str], sensors: Collection[str] = ()) -> World:
    """The world in which recursions and sensors are leaves that never end."""
    back = recursions(world.program, roots)
    schemas = [
        Schema(s.name, s.head, s.results, _marked(s.body, s, back, world.program), s.place)
        for s in world.program.schemas
        if s.name not in sensors
    ]
    bounds = [*(callee + MARK for _, callee in sorted(back)), *sensors]
    leaves = {name: Signature(name, window=FOREVER, outcomes=NEVER_ENDS) for name in bounds}
    return replace(world, program=Program(schemas), signatures={**world.signatures, **leaves})


def _marked(process: Process, within: Schema, back: Collection[tuple[str, str]], program: Program) -> Process:
    match process:
        case Call(name, arguments, results, place):
            if (within.name, name) not in back:
                return process
            own = tuple(Variable(h.name) if isinstance(h, Parameter) else h for h in within.head)
            entry = own if name == within.name else ()
            return Call(name + MARK, (*arguments, *entry), results, place)
        case Not(body):
            return Not(_marked(body, within, back, program))
        case Loop(condition, body) | Spawn(condition, body):
            return type(process)(_marked(condition, within, back, program), _marked(body, within, back, program))
        case If(test, then, otherwise):
            return If(*(_marked(part, within, back, program) for part in (test, then, otherwise)))
        case _:
            return replace(process, parts=tuple(_marked(part, within, back, program) for part in process.parts))


def invoked(name: str, values: tuple[Value, ...], program: Program) -> tuple[Call, tuple[Value, ...] | None]:
    """The call that a recursion stands for, and the arguments at its entry, if the caller knew them."""
    own = name.removesuffix(MARK)
    count = len(program.clauses(own)[0].head)
    entry = values[count:] if len(values) > count else (() if count == 0 else None)
    return Call(own, tuple(map(constant, values[:count]))), entry
