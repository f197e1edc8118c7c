"""`experiment` and `bench`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from planner_reactor.cli import options
from planner_reactor.cli.application import command
from planner_reactor.cli.printing import Advance, print_json, reserved_output, table
from planner_reactor.errors import InputError


@command("papers --out out", "faults --out out --trials 200 --workers 2 --json")
def experiment(
    name: Annotated[str, typer.Argument(metavar="NAME", help="Which experiment.", show_default=False)],
    out: Annotated[Path, typer.Option("--out", metavar="DIR", help="Directory for the results.")],
    trials: Annotated[int | None, typer.Option("--trials", metavar="N", help="How many runs.")] = None,
    workers: Annotated[int, typer.Option("--workers", metavar="N", help="How many processes run them.")] = 1,
    scheduler: Annotated[
        str | None, typer.Option("--scheduler", metavar="ADDRESS", help="Not in this version.")
    ] = None,
    as_json: options.Json = False,
) -> None:
    """Run an experiment and write down what it found."""
    from planner_reactor.calls import measuring

    if scheduler is not None:
        raise InputError("--scheduler is not in this version, there is: --workers")
    with reserved_output(), Advance(name) as advance:
        result = measuring.experiment(name, out=out, trials=trials, workers=workers, watch=advance.count)
    if as_json:
        print_json(result)
    else:
        _show(name, result)


@command("", "--peers --json")
def bench(
    peers: Annotated[bool, typer.Option("--peers", help="Also measure the systems we are compared with.")] = False,
    as_json: options.Json = False,
) -> None:
    """Run the benchmarks of a checkout."""
    from planner_reactor.calls import measuring

    with reserved_output():
        result = measuring.bench(peers=peers)
    if as_json:
        print_json(result)
    else:
        _show("bench", result)


def _show(title: str, result: dict[str, Any]) -> None:
    """Rows of equal form as tables, the rest line by line."""
    for name, value in result.items():
        if isinstance(value, list) and value and all(isinstance(row, dict) for row in value):
            columns = tuple(dict.fromkeys(key for row in value for key in row))
            table(f"{title}: {name}", columns, [tuple(row.get(key) for key in columns) for row in value])
        else:
            print(f"{name}: {value}")
