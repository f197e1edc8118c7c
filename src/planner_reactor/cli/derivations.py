"""`dynamics`: action schemas from a model of the environment."""

from __future__ import annotations

from typing import Annotated, Any

import typer

from planner_reactor.cli import options
from planner_reactor.cli.application import command
from planner_reactor.cli.evolutions import File, Process, Settings
from planner_reactor.cli.printing import print_json, reserved_output


@command(
    "tracking.rsl 'TEM[p, a]' --host planner_reactor.workcell.environments.dynamics",
    "belt.rsl 'BEM[p, a, pr]' --host planner_reactor.workcell.environments.dynamics --set mu=-0.1 --json",
)
def dynamics(
    file: File,
    process: Process,
    host: options.HostModule = None,
    settings: Settings = None,
    interface: Annotated[
        str | None,
        typer.Option("--interface", metavar="P,Q,...", help="Sensory and motor processes [default: found by ports]."),
    ] = None,
    goal: Annotated[
        str, typer.Option("--goal", metavar="P,Q,...", help="Look only at what matters for these ports of the agent.")
    ] = "",
    reaction: Annotated[
        str, typer.Option("--reaction", metavar="P,Q,...", help="Check the timing of these processes of the file.")
    ] = "",
    cost: Annotated[
        str | None,
        typer.Option("--cost", metavar="S|measured", help="Seconds for a step of the executer: does the reaction fit?"),
    ] = None,
    as_json: options.Json = False,
) -> int:
    """Derive action schemas from a model of the environment: exit status 1 if a reaction does not keep up with it."""
    from planner_reactor.calls import deriving, evolving

    given = evolving.given_values(settings or ())
    with reserved_output():
        result = deriving.dynamics(
            file, process, host=host, given=given, interface=interface, goal=goal, reaction=reaction, cost=cost
        )
    if as_json:
        print_json(result)
    else:
        _show(result)
    late = result["timing"] is not None and result["timing"]["stable"] is False
    return 1 if late or (result["schedule"] is not None and not result["schedule"]["fits"]) else 0


def _show(result: dict[str, Any]) -> None:
    width = max((len(entry["condition"]) for entry in result["dynamics"]), default=0)
    for entry in result["dynamics"]:
        print(f"{entry['condition']:{min(width, 40)}}  ->  {entry['term']}")
        print(f"{'':{min(width, 40)}}      {', '.join(entry['actions']) or 'no action: ' + str(entry['why'])}")
    for action in result["actions"]:
        print(f"\n{action['schema']}\n{action['rs']}")
    if result["timing"] is not None:
        print()
        for line in (*result["timing"]["failures"], *(check["text"] for check in result["timing"]["checks"])):
            print(line)
    if result["schedule"] is not None:
        print(result["schedule"]["text"])
