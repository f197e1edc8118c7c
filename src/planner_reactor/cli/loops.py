"""`loop` and `kit`: the whole system, planner, reactor and world."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from planner_reactor.cli import options
from planner_reactor.cli.application import command
from planner_reactor.cli.printing import Advance, Notes, print_json, reserved_output, say, show_conformance, table

if TYPE_CHECKING:
    from planner_reactor.experiments.loop import Loop

SAMPLED = 1000
"""Events between two looks at how far a run has come."""


@command(
    "--trays 50 --seed 1 --json",
    "--trays 20 --faults faults.toml --relax AQ,AM --trace run.jsonl",
    "--until 400 --planner-time papers --figures out",
)
def kit(
    ctx: typer.Context,
    trays: options.Trays = None,
    seed: options.Seed = 0,
    domain: options.Domain = None,
    kit: options.Kit = None,
    faults: options.Faults = None,
    goals: options.Goals = None,
    response_ms: options.Response = None,
    until: options.Until = None,
    cell: options.CellName = "events",
    clock: options.ClockName = "virtual",
    planner: options.PlannerSide = "inline",
    planner_time: options.PlannerTime = "0.001",
    mode: options.ModeName = "drain",
    verify: options.Verified = True,
    relax: options.Relax = "all",
    trace: options.TraceFile = None,
    figures: options.Figures = None,
    conform: options.Conform = False,
    as_json: options.Json = False,
) -> int:
    """Build kits in a simulated workcell, while the planner keeps rewriting the reactor."""
    from planner_reactor.calls import looping

    return _run(ctx, lambda **given: looping.kit(domain=domain, **given))


@command(
    "my_domain.itl --host my_cell --until 600", "kitting.itl --host planner_reactor.workcell.host --trays 5 --json"
)
def loop(
    ctx: typer.Context,
    domain: Annotated[Path, typer.Argument(metavar="DOMAIN.itl", help="The planning domain.", show_default=False)],
    host: Annotated[
        str, typer.Option("--host", metavar="MODULE", help="Module (or FILE.py) whose `host` brings the world.")
    ],
    goal: options.Goal = None,
    trays: options.Trays = None,
    seed: options.Seed = 0,
    kit: options.Kit = None,
    faults: options.Faults = None,
    goals: options.Goals = None,
    response_ms: options.Response = None,
    until: options.Until = None,
    cell: options.CellName = "events",
    clock: options.ClockName = "virtual",
    planner: options.PlannerSide = "inline",
    planner_time: options.PlannerTime = "0.001",
    mode: options.ModeName = "drain",
    verify: options.Verified = True,
    relax: options.Relax = "all",
    trace: options.TraceFile = None,
    figures: options.Figures = None,
    conform: options.Conform = False,
    as_json: options.Json = False,
) -> int:
    """Run planner and reactor for any domain in the world of a host."""
    from planner_reactor.calls import looping

    return _run(ctx, lambda **given: looping.loop(domain, host=host, goal=goal, **given))


def _run(ctx: typer.Context, call: Callable[..., dict[str, Any]]) -> int:
    """Call with the options of the command line; 1 if a law or the semantics was broken, or the world not finished."""
    from planner_reactor.calls.looping import LoopOptions

    given = {name: ctx.params[name] for name in LoopOptions.__annotations__ if name in ctx.params}
    notes = Notes()
    with reserved_output(), Advance("running") as advance:
        result = call(**given, told=notes, watch=lambda made: _follow(made, advance, given["until"]))
    notes.close()
    unfinished = not result["finished"] and given["until"] is None
    if unfinished:
        say(f"nothing was left to do at {result['simulated_s']:.3f} s, and the world is not finished")
    if ctx.params["as_json"]:
        print_json(result)
    else:
        _show(result)
    disagreement = result.get("conformance", {}).get("disagreement")
    return int(bool(result["violations"]) or disagreement is not None or unfinished)


def _follow(made: Loop, advance: Advance, until: float | None) -> None:
    if not advance.shown:
        return
    world = made.host.world
    target: int = getattr(world, "target", 0)

    def look(event: Any) -> None:
        if event.number % SAMPLED:
            return
        kits = world.report().get("kits") if world is not None else None
        if target and isinstance(kits, Mapping):
            advance.at(kits["completed"], target, f"{kits['completed']} of {target} kits, {event.time:.0f} s")
        else:
            advance.at(event.time, until, f"{event.time:.0f} s")

    made.trace.sinks.append(look)


def _show(result: dict[str, Any]) -> None:
    """The run as tables."""
    conformance = result.pop("conformance", None)
    table("The run", (), [(name.replace("_", " "), value) for name, value in _figures(result)])
    relaxations = [tuple(r.values()) for r in result["relaxations"]]
    table("Relaxations", ("assumption", "cause", "decided s", "issued s", "applied s"), relaxations)
    faults = result.get("faults", ())
    table("Faults", tuple(faults[0]) if faults else (), [tuple(fault.values()) for fault in faults])
    for drawn in result["figures"]:
        print(drawn)
    table("Violations", ("law",), [(violation,) for violation in result["violations"]])
    if conformance is not None:
        show_conformance(conformance)


def _figures(result: Mapping[str, Any]) -> list[tuple[str, object]]:
    """What is one number or a few, by name."""
    shown: list[tuple[str, object]] = []
    for name, value in result.items():
        if isinstance(value, Mapping):
            if value:
                shown.append((name, ", ".join(f"{key} {_listed(part)}" for key, part in value.items())))
        elif not isinstance(value, list):
            shown.append((name, value))
    return [*shown, ("violations", len(result["violations"])), ("laws checked", result["laws_checked"])]


def _listed(part: object) -> str:
    return (" ".join(map(str, part)) or "none") if isinstance(part, list) else str(part)
