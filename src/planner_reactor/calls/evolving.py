"""`evolve` and `limits`: what a process can become, read from its text with unknowns (X §4.3, §5).

Names that stand for numbers and that nothing binds are unknowns, those among the arguments of the process included;
`given` says what some of them are. Basic processes come from a host, of which only what it declares is used.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import msgspec

from planner_reactor.analysis import evolution
from planner_reactor.analysis.conditions import Condition, path_text, text
from planner_reactor.analysis.limits import LIMIT, limit_set
from planner_reactor.analysis.renaming import renamed
from planner_reactor.analysis.residuals import Noting, Residuals
from planner_reactor.analysis.subnets import network, open_ports
from planner_reactor.calls.hosts import HostSource, find_host
from planner_reactor.calls.inputs import names_in, read_text, unknown, whole
from planner_reactor.calls.processes import ROOT, called
from planner_reactor.errors import InputError, RSError
from planner_reactor.rs.checks import check
from planner_reactor.rs.configurations import Config, World, spawned_situations
from planner_reactor.rs.facts import names
from planner_reactor.rs.given import with_values
from planner_reactor.rs.linking import Linked
from planner_reactor.rs.open_names import open_names
from planner_reactor.rs.parser import read_program
from planner_reactor.rs.printer import show
from planner_reactor.rs.source import Source
from planner_reactor.rs.terms import Call, Process, Program, Schema, Symbol, Value, calls
from planner_reactor.rs.unknowns import Unknown
from planner_reactor.rs.vocabulary import BUILT_IN
from planner_reactor.runtime import Host, Scheduler, VirtualClock


class Model(msgspec.Struct, frozen=True):
    """A process and its world in which open names are unknowns, or what they were given to be."""

    call: Call
    world: World


def evolve(
    file: str | Path,
    process: str,
    *,
    host: HostSource | None = None,
    given: Mapping[str, float] | None = None,
    ports: str | Iterable[str] | None = None,
    every: bool = False,
    limit: int = 1_000,
) -> dict[str, Any]:
    """The steps that a process can take next, or with `every` all that it can come to (poss, poss*).

    `ports` are those at which the world outside reads and writes (default: those of which the program has one side
    only), `limit` is the most terms that `every` finds. Returns `steps` (each `condition` and `term`, as text) and
    `complete`. Raises SourceError for a wrong text, InputError for a wrong argument.
    """
    limit = whole("limit", limit, 1)
    subject = model(file, process, host=host, given=given)
    world = Noting(**{name: getattr(subject.world, name) for name in World.__struct_fields__})
    open_to = _ports(subject, ports)
    found: list[tuple[tuple[Condition, ...], evolution.State]] = []
    complete = True
    for start in evolution.beginnings(subject.call, world):
        if every:
            reached, all_of_it = evolution.reachable(start, world, open_ports=open_to, limit=limit)
            found, complete = [*found, *reached], complete and all_of_it
        else:
            found += [((e.condition,), e.after) for e in evolution.poss(start, world, open_ports=open_to)]
    residuals = Residuals.of(list(world.noted), world)
    steps = [_shown(path, state.config, residuals, world) for path, state in found]
    return {"steps": steps, "complete": complete}


def _shown(path: tuple[Condition, ...], config: Config, residuals: Residuals, world: World) -> dict[str, str]:
    """A step as text, in which no unknown has the name of a result that is still to come."""
    coming = {name for call in calls(residuals.network(config, world)) for name in call.results}
    told, after = renamed((path, config), taken=coming)
    return {"condition": path_text(told), "term": show(residuals.network(after, world))}


def limits(
    file: str | Path,
    process: str,
    *,
    sensors: str | Iterable[str] = (),
    host: HostSource | None = None,
    given: Mapping[str, float] | None = None,
    ports: str | Iterable[str] | None = None,
    limit: int = LIMIT,
) -> dict[str, Any]:
    """The limit set of a process. `sensors`: the processes that are pseudo-bounds; else as for `evolve`.

    Returns `limits` (each `condition`, `term`, `kind` recursion, bound, end or stuck, and `component`, the part of the
    network that has changed), `states` and `complete`.
    """
    limit = whole("limit", limit, 1)
    subject = model(file, process, host=host, given=given)
    bounds = tuple(name for name in names_in(sensors) if name)
    known = {*subject.world.program.names, *(set(subject.world.signatures) - set(BUILT_IN))}
    for name in bounds:
        if name not in known:
            raise unknown("sensor", name, sorted(known))
    found = limit_set(subject.call, subject.world, sensors=bounds, ports=_ports(subject, ports), limit=limit)
    listed = [
        {
            "condition": text(entry.condition),
            "term": show(entry.term),
            "kind": entry.kind,
            "component": show(entry.component) if entry.component is not None else None,
        }
        for entry in found.limits
    ]
    return {"limits": listed, "states": found.states, "complete": found.complete}


def given_values(settings: Iterable[str]) -> dict[str, float]:
    """What `NAME=NUMBER` settings say; InputError for anything else."""
    found: dict[str, float] = {}
    for setting in settings:
        name, sign, number = setting.partition("=")
        try:
            found[name.strip()] = float(number) if "." in number or "e" in number.lower() else int(number)
        except ValueError:
            sign = ""
        if not sign or not name.strip().isidentifier():
            raise InputError(f"--set {setting}: expected NAME=NUMBER")
    return found


def model(
    file: str | Path, process: str, *, host: HostSource | None = None, given: Mapping[str, float] | None = None
) -> Model:
    """The process `process` of a file `*.rsl`, open names read as unknowns. Raises what `evolve` raises."""
    source, maker = read_text(file), find_host(host) if host is not None else None
    call = called(process)
    used = maker(Scheduler(VirtualClock())) if maker else Host("none")
    program, found = read_program(source, file=str(file))
    errors = [f for f in found if f.severity == "error"]
    if errors:
        raise RSError(Source(source, str(file)).shown(errors))
    together = _with_root(program, call)
    linked = Linked(together, {**used.signatures, **BUILT_IN}, used.functions)
    values = _values(open_names(linked), call, together, given or {})
    made = with_values(together, values)
    static = check(made, signatures=used.signatures, functions=used.functions)
    errors = [f for f in static if f.severity == "error"]
    if errors:
        shown = Source(process, ROOT).shown(Source(source, str(file)).shown(errors))
        raise RSError(sorted(shown, key=lambda f: f.place.file != ROOT))
    (root,) = made.clauses(ROOT)
    assert isinstance(root.body, Call)
    program = made.without([root])
    signatures, spawned = {**BUILT_IN, **used.signatures}, spawned_situations(program, root.body)
    return Model(root.body, World(program, signatures, used.functions, spawned=spawned))


def _with_root(program: Program, call: Call) -> Program:
    return program.with_schemas([Schema(ROOT, (), (), call, call.place)])


def _values(names: Iterable[str], call: Call, program: Program, given: Mapping[str, float]) -> dict[str, Value]:
    """Every open name with its unknown, those of the process itself first in every sum."""
    own = {a.name for a in call.arguments if isinstance(a, Symbol)}
    values: dict[str, Value] = {name: Unknown(name, -1 if name in own else 0) for name in names}
    symbols = {s for schema in program.schemas for c in calls(schema.body) for s in _symbols(c)}
    for name, value in given.items():
        if name not in symbols:
            raise unknown("constant", name, sorted(symbols))
        values[name] = value
    return values


def _symbols(call: Call) -> Iterable[str]:
    return (s.name for s in names(call.arguments) if isinstance(s, Symbol))


def _ports(subject: Model, ports: str | Iterable[str] | None) -> frozenset[Value]:
    parts: tuple[Process, ...] = network(subject.call, subject.world).components
    if ports is None:
        return open_ports(parts, subject.world)
    return frozenset(name for name in names_in(ports) if name)
