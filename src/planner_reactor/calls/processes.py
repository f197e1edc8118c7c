"""A process that a caller names, `Main` or `Serve[3, cap]`, beside the program of a file: checked together.

Every sub-command that takes `FILE.rsl 'NAME[args]'` begins here, so that all refuse the same things in the same words.
`subject` makes of it what `rs.evolves` and `analysis` work on: a configuration that has just begun, and its world.
"""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

import msgspec

from planner_reactor.calls.hosts import HostSource, find_host
from planner_reactor.calls.inputs import read_text
from planner_reactor.errors import RSError, SourceError
from planner_reactor.rs.checks import check
from planner_reactor.rs.configurations import Config, Ending, Oracle, World, spawned_situations
from planner_reactor.rs.evolves import started
from planner_reactor.rs.expressions import EvaluationError, evaluate
from planner_reactor.rs.parser import parse_process, read_program
from planner_reactor.rs.printer import show
from planner_reactor.rs.source import Source
from planner_reactor.rs.terms import Call, Expression, Program, Schema, Value
from planner_reactor.runtime import Host, Scheduler, VirtualClock

ROOT = "<process>"
"""The file that the process to be run is said to stand in."""


class Subject(msgspec.Struct, frozen=True):
    """A program with a process of it that has just begun: what an analysis starts from."""

    program: Program
    call: Call
    start: Config
    world: World


def subject(file: str | Path, process: str, *, host: HostSource | None = None) -> Subject:
    """The process `process` of a file `*.rsl`, begun. Raises SourceError for a wrong text, InputError for a wrong host.

    Processes of the host may end at any age within their windows, in any way that they declare; what they return is
    one value of which nothing is known but where it comes from (`Find.x`).
    """
    text, maker = read_text(file), find_host(host) if host is not None else None
    call = called(process)
    used = maker(Scheduler(VirtualClock())) if maker else Host("none")
    program = checked(text, str(file), process, call, used)
    for argument in call.arguments:
        value(argument, process, call, used)
    world = World(
        program, used.signatures, used.functions, endings=_endings(used), spawned=spawned_situations(program, call)
    )
    return Subject(program, call, started(call, world), world)


def _endings(host: Host) -> Oracle:
    def endings(name: str, arguments: tuple[Value, ...]) -> Iterable[Ending]:
        if name == "Ran":  # the ends of its range stand for what lies between
            return [(True, (number,)) for number in dict.fromkeys(arguments)]
        signature = host.signatures[name]
        values = tuple(f"{name}.{result}" for result in signature.results)
        return [(o == "stop", values if o == "stop" else ()) for o in ("stop", "abort") if o in signature.outcomes]

    return endings


def called(process: str) -> Call:
    """The process as a call; RSError if it is anything else."""
    term = parse_process(process, file=ROOT)
    if isinstance(term, Call):
        return term
    source = Source(process, ROOT)
    raise RSError([source.finding(0, "error", "no-call", "this is a composition", "expected NAME[arguments]")])


def checked(text: str, file: str, process: str, call: Call, host: Host) -> Program:
    """The program, if it and the call hold against the static checks as a whole."""
    program, found = read_program(text, file=file)
    errors = [f for f in found if f.severity == "error"]
    if not errors:
        root = Schema(ROOT, (), (), call, call.place)
        static = check(program.with_schemas([root]), signatures=host.signatures, functions=host.functions, roots=[ROOT])
        errors = [f for f in static if f.severity == "error"]
        errors = list(Source(process, ROOT).shown(Source(text, file).shown(errors)))
    if errors:
        raise RSError(sorted(errors, key=lambda f: f.place.file != ROOT))
    return program


def value(argument: Expression, process: str, call: Call, host: Host) -> Value:
    try:
        return evaluate(argument, {}, host.functions)
    except EvaluationError as error:
        place = getattr(argument, "place", None) or call.place
        source = Source(process, ROOT)
        offset = place.column - 1 if place is not None else 0
        finding = source.finding(offset, "error", "no-value", f"{show(argument)} has no value: {error}")
        raise SourceError([finding]) from error
