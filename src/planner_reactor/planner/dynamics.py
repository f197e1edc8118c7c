"""Dynamics of an environment, and how an agent can exploit them: from a model to action schemas (X §4.4, §5, §6).

`derive` reads the limit set of an environment and keeps the entries in which the agent can take part:

    sensible     the entry ends in a process that writes a port which a sensory process of the interface reads
    effectable   the entry waits for a value at a port which a motor process of the interface writes
    drifting     neither: the environment moves by itself, in one direction, towards what the agent can sense

and of these the ones whose ports are dense. What each is good for is worked out, not listed (`exploiting`): which
values make another entry's condition true (LOOK and MOVECAMERA keep an object in view), which reduce a distance that a
sensor reports the end of (MOVETOWARDS and WAITFOROBJECT lead to CONTACT). What is left out is told with its reason.

The names LOOK, MOVECAMERA, … are made from what an action does (its role) and the component that it moves.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping
from typing import Any

import msgspec
from msgspec.structs import replace

from planner_reactor.analysis.conditions import events_of
from planner_reactor.analysis.conditions import text as condition_text
from planner_reactor.analysis.denseness import Denseness, Failure, Netlist, asked, opened
from planner_reactor.analysis.interface import Connector, carried, interface, sensors
from planner_reactor.analysis.limits import Limit, limit_set
from planner_reactor.analysis.subnets import network, subnet, traffic
from planner_reactor.errors import InputError, nearest
from planner_reactor.planner.exploiting import of_drift, of_motor, of_sensor
from planner_reactor.planner.exploiting_text import DerivedAction, written
from planner_reactor.planner.uses import Model, Use
from planner_reactor.rs.configurations import World
from planner_reactor.rs.given import constant
from planner_reactor.rs.parser import parse_process
from planner_reactor.rs.printer import show
from planner_reactor.rs.terms import Call, Expression, Number, Par, Parameter, Process, Program, Symbol, calls
from planner_reactor.rs.unknowns import Symbolic, Unknown
from planner_reactor.rs.vocabulary import Signature

FIRST_NUMBER = 54
"""The paper's prototype was at this number when it printed the two schemas of X §6.3: reportpos-57 is the second."""


class Rejected(msgspec.Struct, frozen=True):
    """An entry of the limit set that no action comes from, and why."""

    condition: str
    term: str
    why: str


class Dynamics(msgspec.Struct, frozen=True):
    """All that an environment offers to an agent."""

    actions: tuple[DerivedAction, ...]
    rejected: tuple[Rejected, ...]
    limits: tuple[Limit, ...]
    interface: tuple[Connector, ...]
    sensors: tuple[str, ...]


def schemas(
    program: Program | World,
    environment: Process | str = "TEM",
    interface: Iterable[str] | None = None,
    *,
    signatures: Mapping[str, Signature] | None = None,
    given: Mapping[str, float] | None = None,
    goal: Collection[str] = (),
) -> tuple[DerivedAction, ...]:
    """The action schemas of an environment model: see `derive`."""
    return derive(program, environment, interface, signatures=signatures, given=given, goal=goal).actions


def derive(
    program: Program | World,
    environment: Process | str = "TEM",
    interface_processes: Iterable[str] | None = None,
    *,
    signatures: Mapping[str, Signature] | None = None,
    given: Mapping[str, float] | None = None,
    goal: Collection[str] = (),
) -> Dynamics:
    """What an agent can do in an environment, from the text of its model.

    `environment` is the process, `TEM` or `TEM[p, a]`; `interface_processes` the sensory and motor processes (default:
    all definitions of the text that connect a port of the environment); `signatures` those of a host, `given` what open
    names are. With `goal`, ports of the agent's side, only what matters for these is looked at (Snet, X §7). InputError
    for an environment, a process or a port that the text does not have.
    """
    world = program if isinstance(program, World) else opened(program, signatures, given=given)
    process = _environment(environment, world, given or {})
    named = None if interface_processes is None else [_called(name) for name in interface_processes]
    found = interface(process, world, named)
    if goal:
        process, found = _focused(process, found, goal, world)
    bounds = sensors(process, world, [c.outer for c in found if c.kind == "sensory"])
    limits = limit_set(process, world, sensors=bounds)
    nets = Netlist(process, world, *dict.fromkeys(c.process for c in found))
    uses, rejected = _uses(Model(process, world, nets, found, limits.limits))
    return Dynamics(written(uses, nets, found, FIRST_NUMBER), tuple(rejected), limits.limits, found, bounds)


def _focused(
    process: Process, found: tuple[Connector, ...], goal: Collection[str], world: World
) -> tuple[Process, tuple[Connector, ...]]:
    """The subnet that matters for these ports of the agent, and the interface to it."""
    known = {c.inner: c.outer for c in found}
    for port in goal:
        if port not in known:
            hint = nearest(port, known) or f"there are: {', '.join(sorted(known))}"
            raise InputError(f"no port {port} of the interface, {hint}")
    kept = subnet(process, world, [known[port] for port in goal])
    whole: Process = kept[0] if len(kept) == 1 else Par(kept)
    ports = traffic(whole, world).ports
    return whole, tuple(c for c in found if c.outer in ports)


def _called(text: str) -> Call:
    process = parse_process(text)
    if not isinstance(process, Call):
        raise InputError(f"{text} is no process of an interface, expected the name of a definition")
    return process


def _environment(environment: Process | str, world: World, given: Mapping[str, Any]) -> Process:
    """The process with unknowns for its parameters, named as its head names them if it gives none."""
    process = parse_process(environment) if isinstance(environment, str) else environment
    for call in calls(process):
        clauses = world.program.clauses(call.name)
        if not clauses:
            hint = nearest(call.name, world.program.names) or f"there are: {', '.join(sorted(world.program.names))}"
            raise InputError(f"no process {call.name}, {hint}")
        if not call.arguments and (head := clauses[0].head) and process == call:
            own = tuple(constant(Unknown(h.name, -1) if isinstance(h, Parameter) else h.value) for h in head)
            return replace(call, arguments=own)
    return _lifted(asked(process, world, given), world)


def _lifted(process: Process, world: World) -> Process:
    """Numbers at which components begin are unknowns: what can be done does not depend on where the world stands."""
    if isinstance(process, Call):
        process = replace(process, arguments=tuple(_open(process, world)))
    components = network(process, world).components
    lifted = tuple(replace(c, arguments=tuple(_open(c, world))) if isinstance(c, Call) else c for c in components)
    return process if lifted == components else Par(lifted) if len(lifted) > 1 else lifted[0]


def _open(call: Call, world: World) -> Iterator[Expression]:
    """The arguments of a call, those that are numbers, or names but not of ports, as unknowns."""
    clauses = world.program.clauses(call.name)
    ports = traffic(call, world).ports
    for n, argument in enumerate(call.arguments):
        head = clauses[0].head[n] if len(clauses) == 1 and n < len(clauses[0].head) else None
        match argument:
            case Number(value) if isinstance(head, Parameter) and not isinstance(value, Symbolic):
                yield constant(Unknown(head.name, -1))
            case Symbol(name) if isinstance(head, Parameter) and name not in ports:
                yield constant(Unknown(name, -1))
            case _:
                yield argument


# ---------------------------------------------------------------------------------------------------- selection


def _uses(model: Model) -> tuple[list[Use], list[Rejected]]:
    uses: list[Use] = []
    rejected: list[Rejected] = []
    for limit in model.limits:
        found, why = _of_limit(limit, model)
        kept = [use for use in found if isinstance(use, Use)]
        uses += kept
        if not kept:
            rejected.append(Rejected(condition_text(limit.condition), show(limit.term), why))
    return [*uses, *_always(model)], rejected


def _of_limit(limit: Limit, model: Model) -> tuple[list[Use], str]:
    """What an entry of the limit set is good for, or why it is good for nothing."""
    if limit.kind == "bound":
        return _sensible(limit, model)
    if limit.kind != "recursion":
        return [], "nothing goes on from here that could be exploited"
    ports = [str(e.arguments[0]) for e in events_of(limit.condition) if e.kind == "outside" and e.name == "IN"]
    if not ports:
        return of_drift(limit, model)
    return _effectable(limit, ports, model)


def _sensible(limit: Limit, model: Model) -> tuple[list[Use], str]:
    """`sensible`: the pseudo-bound writes a port that a sensory process reads, and the agent's side of it is dense."""
    assert limit.reached is not None
    own = traffic(limit.reached, model.world)
    joined = [c for c in model.interface if c.kind == "sensory" and c.outer in own.writes | own.streams]
    if not joined:
        return [], f"no sensory process reads what {show(limit.reached)} writes"
    uses, why = [], ""
    for connector in joined:
        timing = model.nets.dense(connector.inner, {})
        if isinstance(timing, Failure):
            why = str(timing)
            continue
        found, why = of_sensor(limit, connector, carried(connector.outer, model.nets), timing, model)
        uses += found
    return uses, why


def _effectable(limit: Limit, ports: Collection[str], model: Model) -> tuple[list[Use], str]:
    """`effectable`: motor processes write all the ports that the entry waits for, as densely as they are written to."""
    joined = [next((c for c in model.interface if c.kind == "motor" and c.outer == p), None) for p in ports]
    missing = [p for p, c in zip(ports, joined, strict=True) if c is None]
    if missing:
        return [], f"no motor process writes {', '.join(missing)}"
    connectors = tuple(c for c in joined if c is not None)
    timings: list[Denseness] = []
    for connector in connectors:
        timing = model.nets.dense(connector.outer, {connector.inner: (0, 0)})
        if isinstance(timing, Failure):
            return [], str(timing)
        timings.append(timing)
    return of_motor(limit, connectors, timings, model)


def _always(model: Model) -> Iterator[Use]:
    """Components that say where they are all the time, at a port that a sensory process reads: under no condition."""
    reached = [limit.reached for limit in model.limits if limit.kind == "bound" and limit.reached is not None]
    bound = {port for process in reached for port in traffic(process, model.world).ports}
    for connector in model.interface:
        if connector.kind == "sensory" and connector.outer not in bound:
            timing = model.nets.dense(connector.inner, {})
            value = carried(connector.outer, model.nets)
            if isinstance(timing, Denseness) and value is not None and not timing.given:
                yield from of_sensor(None, connector, value, timing, model)[0]
