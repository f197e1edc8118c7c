"""`lts`: the labelled transition system of a process."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from planner_reactor.cli import options
from planner_reactor.cli.application import command
from planner_reactor.cli.printing import print_json, reserved_output


@command("cell.rsl Main -o cell.aut", "cell.rsl 'Pair[1]' --reduce branching --hide p,q -o pair.dot --json")
def lts(
    file: Annotated[Path, typer.Argument(metavar="FILE.rsl", help="The program.", show_default=False)],
    process: Annotated[str, typer.Argument(metavar="'NAME[args]'", help="The process, with values as arguments.")],
    out: Annotated[
        Path | None, typer.Option("-o", "--out", metavar="OUT", help="Write it to OUT.aut, OUT.dot or OUT.pml.")
    ] = None,
    reduce: Annotated[
        str, typer.Option("--reduce", metavar="HOW", help="none, strong, branching, or orders (deadlocks only).")
    ] = "none",
    hide: Annotated[
        str, typer.Option("--hide", metavar="P,Q", help="Ports whose rendezvous are not seen (branching).")
    ] = "",
    host: options.HostModule = None,
    limit: Annotated[int, typer.Option("--limit", metavar="N", help="Build no more states.")] = 200_000,
    as_json: options.Json = False,
) -> None:
    """Build the transition system of a process, and write it for other tools."""
    from planner_reactor.calls import transitions

    with reserved_output():
        result = transitions.lts(file, process, out=out, host=host, reduce=reduce, hide=hide or (), limit=limit)
    if as_json:
        print_json(result)
    else:
        _show(result)


def _show(result: dict[str, Any]) -> None:
    print(f"{result['states']} states, {result['transitions']} transitions, {result['deadlocks']} deadlocks")
    for name in ("deadlock", "zeno", "livelock"):
        if (found := result.get(name)) is not None:
            print(f"{name}:")
            for number, step in enumerate(found["steps"], 1):
                if number == len(found["steps"]) - found["cycle"] + 1:
                    print("  and then for ever")
                print(f"  {number:3}  {step}")
