"""`plan` and `network`: what the planner and its logic come to, without a reactor."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from planner_reactor.cli import options
from planner_reactor.cli.application import command
from planner_reactor.cli.printing import print_json, reserved_output, say


@command("kitting.itl", "kitting.itl --without AQ,AM --steps 2 --json", "kitting.itl --steps 1 --explain")
def plan(
    file: Annotated[Path, typer.Argument(metavar="FILE.itl", help="The planning domain.", show_default=False)],
    without: Annotated[str, typer.Option("--without", metavar="AQ,...", help="Assumptions to do without.")] = "",
    steps: Annotated[
        int | None, typer.Option("--steps", metavar="K", help="Stop after so many segments [default: all].")
    ] = None,
    goal: options.Goal = None,
    explain: Annotated[bool, typer.Option("--explain", help="Say why each segment is there.")] = False,
    as_json: options.Json = False,
) -> int:
    """Show the segments of a reactor as the planner would send them."""
    from planner_reactor.calls import planning

    with reserved_output():
        result = planning.plan(file, without=without, steps=steps, goal=goal, explain=explain)
    for warning in result["warnings"]:
        say(f"warning: {warning}")
    for situation, why in result["impossible"].items():
        say(f"no plan for {situation}: {why}")
    if as_json:
        print_json(result)
    else:
        _show_plan(result)
    return int(bool(result["impossible"]))


def _show_plan(result: dict[str, Any]) -> None:
    for number, segment in enumerate(result["segments"], start=1):
        print(f"// {number}. {segment['purpose']} ({segment['issued_s'] * 1000:.1f} ms)")
        for name in ("assumptions", "stubs", "perceptions", "kills"):
            if segment[name]:
                print(f"// {name}: {', '.join(map(str, segment[name]))}")
        for line in segment.get("explained", "").splitlines()[1:]:
            print(f"//{line}")
        print(segment["text"])
    print(f"// {len(result['segments'])} segments, {'complete' if result['ideal'] else 'not complete'}")


@command("times.txt", "times.txt --json")
def network(
    file: Annotated[Path, typer.Argument(metavar="FILE", help="Lines such as `i1 (b m o) i2`.", show_default=False)],
    as_json: options.Json = False,
) -> int:
    """Is a network of intervals consistent, what follows from it, and how could it be?"""
    from planner_reactor.calls import networks

    with reserved_output():
        result = networks.network(file)
    if as_json:
        print_json(result)
    else:
        _show_network(result)
    return int(not result["consistent"])


def _show_network(result: dict[str, Any]) -> None:
    if not result["consistent"]:
        print("not consistent: no world holds all of this, and each of it is needed for that")
        for said in result["explanation"]:
            print(f"  line {said['line']}: {said['text']}")
        return
    print("consistent")
    print("closure:")
    for edge in result["closure"]:
        print(f"  {edge['first']} ({' '.join(edge['relations'])}) {edge['second']}")
    print("scenario:")
    for edge in result["scenario"]:
        print(f"  {edge['first']} ({edge['relation']}) {edge['second']}")
    if result["metric"]:
        print("timeline, in milliseconds:")
        for interval, (start, end) in result["timeline"].items():
            print(f"  {interval} {start:.10g} .. {end:.10g}")
