"""`dynamics`: what an agent can do in an environment, from a model of it (X §5, §6)."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from math import inf
from pathlib import Path
from typing import Any

from planner_reactor.analysis.conditions import text
from planner_reactor.analysis.denseness import Denseness, Failure, Netlist
from planner_reactor.analysis.interface import Connector
from planner_reactor.analysis.scheduling import Demand, schedule, steps_of
from planner_reactor.analysis.timing import Check, Stability, stability
from planner_reactor.calls.costing import cost_per_step
from planner_reactor.calls.evolving import Model, model
from planner_reactor.calls.hosts import HostSource
from planner_reactor.calls.inputs import names_in, read_text, unknown
from planner_reactor.calls.processes import called
from planner_reactor.errors import InputError
from planner_reactor.planner.dynamics import Dynamics, derive
from planner_reactor.planner.exploiting_text import DerivedAction
from planner_reactor.rs.parser import read_program
from planner_reactor.rs.prelude import QUANTUM
from planner_reactor.rs.printer import show
from planner_reactor.rs.terms import Call, Parameter, Program, Symbol
from planner_reactor.rs.unknowns import Symbolic
from planner_reactor.workcell.environments.dynamics import host as papers


def dynamics(
    file: str | Path,
    process: str,
    *,
    host: HostSource | None = None,
    given: Mapping[str, float] | None = None,
    interface: str | Iterable[str] | None = None,
    goal: str | Iterable[str] = (),
    reaction: str | Iterable[str] = (),
    cost: float | str | None = None,
) -> dict[str, Any]:
    """What an agent can exploit in the environment `process` of a file `*.rsl`. Without a `host` there is InView.

    `interface`: its sensory and motor processes (default: found from their ports); `goal`: ports of the agent's side,
    what does not matter for them is left out; `reaction`: processes of the file whose timing is checked against the
    environment, and, if a step of the executer costs `cost` seconds (or `measured`), whether they fit on it; else as
    for `evolve`. Returns `dynamics` (the limit set: condition, term, kind, and the actions that come of each entry, or
    why none does), `schemas` (text), `actions`, `interface`, `denseness` (of every port), `timing` with `stable` and
    `checks`, and `schedule`. Raises what `evolve` raises.
    """
    seconds = _cost(cost)
    program, _ = read_program(read_text(file), file=str(file))
    subject = model(file, _with_arguments(program, process), host=host or _sight(program), given=given)
    named = None if interface is None else [name for name in names_in(interface) if name]
    ports = [name for name in names_in(goal) if name]
    found = derive(subject.world, subject.call, named, goal=ports)
    nets = Netlist(subject.call, subject.world, *dict.fromkeys(c.process for c in found.interface))
    timing = _timing(subject, [name for name in names_in(reaction) if name], found)
    return {
        "dynamics": _entries(found),
        "schemas": "\n\n".join(t for a in found.actions for t in (a.printed, a.text)),
        "actions": [_action(action) for action in found.actions],
        "interface": [_connector(c) for c in found.interface],
        "sensors": list(found.sensors),
        "denseness": [_density(port, nets.dense(port, {})) for port in nets.ports],
        "timing": _told(timing),
        "schedule": _scheduled(subject, timing, [n for n in names_in(reaction) if n], found, seconds),
    }  # fmt: skip


def _sight(program: Program) -> HostSource | None:
    """Without a host the tests of the papers' models are there, unless the text has its own."""
    return None if program.names & set(papers.processes) else papers


def _with_arguments(program: Program, process: str) -> str:
    """`TEM` is `TEM[p, a]` if its definition says so."""
    call = called(process)
    clauses = program.clauses(call.name)
    heads = [h.name for h in clauses[0].head if isinstance(h, Parameter)] if clauses else []
    if call.arguments or not heads:
        return process
    return show(Call(call.name, tuple(Symbol(name) for name in heads)))


def _entries(found: Dynamics) -> list[dict[str, Any]]:
    why = {(r.condition, r.term): r.why for r in found.rejected}
    entries = []
    for limit in found.limits:
        key = text(limit.condition), show(limit.term)
        actions = [a.name for a in found.actions if (a.condition, a.dynamic) == key]
        entry = {"condition": key[0], "term": key[1], "kind": limit.kind, "actions": actions, "why": why.get(key)}
        entries.append(entry)
    return entries


def _connector(found: Connector) -> dict[str, str]:
    return {"process": found.process.name, "kind": found.kind, "agent": found.inner, "environment": found.outer}


def _action(action: DerivedAction) -> dict[str, Any]:
    plain = ("name", "role", "inputs", "outputs", "ports", "processes", "condition", "dynamic", "presumes", "label")
    told: dict[str, Any] = {name: getattr(action, name) for name in plain}
    told |= {"delay": value(action.delay), "resolution": value(action.resolution)}
    return told | {"rs": action.rs_text, "schema": action.text, "printed": action.printed}


def _density(port: str, found: Denseness | Failure) -> dict[str, Any]:
    if isinstance(found, Failure):
        return {"port": port, "dense": False, "process": found.process, "why": found.why}
    return {
        "port": port, "dense": True, "process": found.process, "form": found.form, "delay": value(found.delay),
        "resolution": value(found.resolution), "trend": found.trend, "given": text(found.given),
        "cut_by": list(found.cut_by), "restart": value(found.restart), "overlap": value(found.overlap),
    }  # fmt: skip


def _timing(subject: Model, names: list[str], found: Dynamics) -> Stability | None:
    if not names:
        return None
    for name in names:
        if not subject.world.program.clauses(called(name).name):
            raise unknown("process", called(name).name, sorted(subject.world.program.names))
    own = [called(name) for name in names]
    processes = [*own, *dict.fromkeys(c.process for c in found.interface if c.process not in own)]
    return stability(subject.call, processes, subject.world)


def _cost(cost: float | str | None) -> float | None:
    if cost is None:
        return None
    if cost == "measured":
        return cost_per_step()
    try:
        seconds = float(cost)
    except ValueError:
        seconds = -1.0
    if not 0 < seconds < inf:
        raise InputError(f"cost is {cost}, expected seconds for a step, more than 0, or measured")
    return seconds


def _scheduled(
    subject: Model, timing: Stability | None, names: list[str], found: Dynamics, cost: float | None
) -> dict[str, Any] | None:
    """Do the reactions fit? Each may be late by what its timing leaves free, and goes round as often as it can."""
    if cost is None or timing is None:
        return None
    left = [c.right - c.left for c in timing.checks if c.name in ("reads", "corrects")]
    if any(isinstance(slack, Symbolic) for slack in left) or not left:
        raise InputError("the delays that count are open names, give them with --set NAME=NUMBER")
    answer = schedule([_demand(subject, name, found, min(left)) for name in names], cost)
    return {
        "fits": answer.fits, "load": answer.load, "response_s": answer.response, "margin": answer.margin,
        "offender": answer.offender, "cost_s": cost, "text": str(answer),
    }  # fmt: skip


def _demand(subject: Model, name: str, found: Dynamics, slack: float) -> Demand:
    """Rounds follow each other no sooner than a STREAM hands over again, and than a motor process takes again."""
    nets = Netlist(called(name), subject.world, *dict.fromkeys(c.process for c in found.interface))
    ports = [p for p in nets.ports if 0 in nets.writers(p)]
    busy = [b for b in (nets.busy(p, {}) for p in ports) if not isinstance(b, Symbolic) and b != inf]
    return Demand(name, steps_of(called(name), subject.world), float(max([QUANTUM, *busy])), slack)


def _told(timing: Stability | None) -> dict[str, Any] | None:
    if timing is None:
        return None
    return {
        "stable": timing.stable,
        "loop": [value(end) for end in timing.loop],
        "checks": [_check(c) for c in timing.checks],
        "failures": [str(f) for f in timing.failures],
    }


def _check(check: Check) -> dict[str, Any]:
    return {
        "name": check.name, "port": check.port, "left": value(check.left), "right": value(check.right),
        "holds": check.holds, "offender": check.offender, "text": str(check),
    }  # fmt: skip


def value(found: Any) -> Any:
    """A duration as a number, or as text as far as names are open; None for one without end."""
    if isinstance(found, Symbolic):
        return repr(found)
    return None if found in (float("inf"), None) else round(found, 9) if isinstance(found, float) else found
