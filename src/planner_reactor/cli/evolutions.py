"""`evolve` and `limits`: what a process can become, read from its text with unknowns."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, TypeAlias

import typer

from planner_reactor.cli import options
from planner_reactor.cli.application import command
from planner_reactor.cli.printing import print_json, reserved_output, say

File: TypeAlias = Annotated[Path, typer.Argument(metavar="FILE.rsl", help="The program.", show_default=False)]
Process: TypeAlias = Annotated[
    str, typer.Argument(metavar="'NAME[args]'", help="The process; names among its arguments may be unknowns.")
]
Settings: TypeAlias = Annotated[
    list[str] | None, typer.Option("--set", metavar="NAME=NUMBER", help="What an open name is; may be repeated.")
]
Ports: TypeAlias = Annotated[
    str | None,
    typer.Option(
        "--ports",
        metavar="P,Q,...",
        help="Ports at which the world outside reads and writes [default: those with one side only].",
    ),
]

CUT = "the limit was reached: there is more"


@command(
    "tracking.rsl 'TEM[p, a]' --host planner_reactor.workcell.environments.dynamics", "knock.rsl 'Wait[3]' --all --json"
)
def evolve(
    file: File,
    process: Process,
    host: options.HostModule = None,
    settings: Settings = None,
    ports: Ports = None,
    every: Annotated[bool, typer.Option("--all", help="All that it can come to, not only the next steps.")] = False,
    limit: Annotated[int, typer.Option("--limit", metavar="N", help="Find no more terms (with --all).")] = 1_000,
    as_json: options.Json = False,
) -> None:
    """Show the steps that a process can take, with their conditions."""
    from planner_reactor.calls import evolving

    given = evolving.given_values(settings or ())
    with reserved_output():
        result = evolving.evolve(file, process, host=host, given=given, ports=ports, every=every, limit=limit)
    _show(result, "steps", as_json)


@command(
    "tracking.rsl 'TEM[p, a]' --sensors ReportPos --host planner_reactor.workcell.environments.dynamics --json"
)
def limits(
    file: File,
    process: Process,
    sensors: Annotated[
        str, typer.Option("--sensors", metavar="P,Q,...", help="Sensory processes: nothing is followed beyond them.")
    ] = "",
    host: options.HostModule = None,
    settings: Settings = None,
    ports: Ports = None,
    limit: Annotated[int, typer.Option("--limit", metavar="N", help="Look at no more states.")] = 20_000,
    as_json: options.Json = False,
) -> None:
    """Show the limit set of a process: where it comes to, and under which conditions."""
    from planner_reactor.calls import evolving

    given = evolving.given_values(settings or ())
    with reserved_output():
        result = evolving.limits(file, process, sensors=sensors, host=host, given=given, ports=ports, limit=limit)
    _show(result, "limits", as_json)


def _show(result: Mapping[str, Any], key: str, as_json: bool) -> None:
    if as_json:
        print_json(result)
        return
    entries = result[key]
    width = max((len(entry["condition"]) for entry in entries), default=0)
    for entry in entries:
        print(f"{entry['condition']:{min(width, 40)}}  ->  {entry['term']}")
    if not entries:
        print("nothing: it can take no step")
    if not result["complete"]:
        say(CUT)
