"""Options that several sub-commands share: how they are written and what their help says."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, TypeAlias

import typer

Json: TypeAlias = Annotated[bool, typer.Option("--json", help="Print exactly one JSON object.")]
HostModule: TypeAlias = Annotated[
    str | None,
    typer.Option("--host", metavar="MODULE", help="Module (or FILE.py) whose `host` brings processes and a world."),
]
Seed: TypeAlias = Annotated[int, typer.Option("--seed", metavar="S", help="Seed of everything random.")]
Until: TypeAlias = Annotated[
    float | None, typer.Option("--until", metavar="SECONDS", help="End at this instant of the run's clock.")
]
ClockName: TypeAlias = Annotated[str, typer.Option("--clock", metavar="virtual|wall", help="Whose time it runs in.")]
Goal: TypeAlias = Annotated[
    str | None, typer.Option("--goal", metavar="NAME", help="Goal of the domain to plan for [default: the first].")
]
Trays: TypeAlias = Annotated[
    int | None,
    typer.Option("--trays", metavar="N", help="Run until so many kits are completed [default: 5, without --until]."),
]
Domain: TypeAlias = Annotated[
    Path | None, typer.Option("--domain", metavar="FILE.itl", help="Another domain than the one shipped.")
]
Kit: TypeAlias = Annotated[
    Path | None, typer.Option("--kit", metavar="SPEC.toml", help="Another kit: part kinds, variants, slots, order.")
]
Faults: TypeAlias = Annotated[
    Path | None, typer.Option("--faults", metavar="FILE.toml", help="What goes wrong in the world, and when.")
]
Goals: TypeAlias = Annotated[
    Path | None, typer.Option("--goals", metavar="FILE.toml", help="What management says while it runs, and when.")
]
Response: TypeAlias = Annotated[
    float | None,
    typer.Option("--response", metavar="MS", help="Time that may go into one adaptation [default: the least]."),
]
CellName: TypeAlias = Annotated[
    str, typer.Option("--cell", metavar="events|physics|camera", help="How the workcell is simulated.")
]
PlannerSide: TypeAlias = Annotated[
    str, typer.Option("--planner", metavar="inline|process", help="Where the planner runs.")
]
PlannerTime: TypeAlias = Annotated[
    str,
    typer.Option(
        "--planner-time",
        metavar="measured|papers|SECONDS",
        help="What a step of the planner costs on the run's clock: its real processor time, the papers' durations, "
        "or so many seconds.",
    ),
]
ModeName: TypeAlias = Annotated[
    str, typer.Option("--mode", metavar="wait|drain|versions", help="How a running reactor is adapted.")
]
Verified: TypeAlias = Annotated[
    bool, typer.Option("--verify/--no-verify", help="Verify every adaptation before it is issued.")
]
Relax: TypeAlias = Annotated[
    str, typer.Option("--relax", metavar="all|none|AQ,AS,...", help="Which assumptions may be relaxed.")
]
TraceFile: TypeAlias = Annotated[
    Path | None, typer.Option("--trace", metavar="OUT.jsonl", help="Write every event, one JSON object a line.")
]
Figures: TypeAlias = Annotated[
    Path | None, typer.Option("--figures", metavar="DIR", help="Draw the figures of the papers into this directory.")
]
Conform: TypeAlias = Annotated[
    bool, typer.Option("--conform", help="Hold every step of the run against the semantics, as it is taken.")
]
