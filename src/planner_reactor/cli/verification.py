"""`verify`: what holds of every run of a process."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Annotated, Any

import typer

from planner_reactor.cli import options
from planner_reactor.cli.adaptations import verify_adaptation
from planner_reactor.cli.application import command
from planner_reactor.cli.printing import print_json, reserved_output

VERDICTS = {True: "holds", False: "does not hold", None: "not decided within the limit"}


@command(
    "cell.rsl Main",
    "cell.rsl Main --property 'always (asserted Kit -> eventually succeeded Kit) under weak fairness' --json",
    "reactor.rsl Reactor --adapt 'KILL[2] : POST[4]' --mode drain",
)
def verify(
    file: Annotated[Path, typer.Argument(metavar="FILE.rsl", help="The program.", show_default=False)],
    process: Annotated[str, typer.Argument(metavar="'NAME[args]'", help="The process, with values as arguments.")],
    property: Annotated[
        list[str] | None, typer.Option("--property", metavar="TEXT", help="What every run is to have; may be repeated.")
    ] = None,
    refines: Annotated[
        str | None, typer.Option("--refines", metavar="'OLD[args]'", help="Can it do at least what this one can?")
    ] = None,
    seeing: Annotated[
        list[str] | None, typer.Option("--seeing", metavar="ATOM", help="What is seen of both; may be repeated.")
    ] = None,
    host: options.HostModule = None,
    limit: Annotated[int, typer.Option("--limit", metavar="N", help="Look at no more states.")] = 100_000,
    adapt: Annotated[
        str | None, typer.Option("--adapt", metavar="SCRIPT", help="Verify this adaptation of it instead.")
    ] = None,
    mode: options.ModeName = "drain",
    as_json: options.Json = False,
) -> int:
    """Check every run of a process: exit status 1 if something does not hold or is not decided."""
    if adapt is not None:
        return verify_adaptation(file, process, adapt, mode=mode, host=host, limit=limit, as_json=as_json)
    from planner_reactor.calls import verifying

    with reserved_output():
        result = verifying.verify(
            file, process, properties=property or (), refines=refines, seeing=seeing or (), host=host, limit=limit
        )
    if as_json:
        print_json(result)
    else:
        _show(result, refines)
    return 0 if all(verdict is True for _, verdict in _verdicts(result, refines)) else 1


def _verdicts(result: dict[str, Any], refines: str | None) -> Iterator[tuple[str, bool | None]]:
    yield "deadlock_free", result["deadlock_free"]
    yield "zeno_free", result["zeno_free"]
    if refines is not None:
        yield f"refines {refines}", result["refines"]
    for found in result["properties"]:
        yield found["property"], found["holds"]


def _show(result: dict[str, Any], refines: str | None) -> None:
    for name, verdict in _verdicts(result, refines):
        print(f"{name}: {VERDICTS[verdict]}")
    if result["refuted"] is not None:
        print(f"counterexample to {result['refuted']}{', replayed in the executer' if result['replayed'] else ''}:")
        _show_steps(result["counterexample"], result["cycle"], result["then"])
    print(f"{result['states']} states" + ("" if result["complete"] else ", and more that were not looked at"))


def _show_steps(steps: list[str], cycle: int, then: str) -> None:
    for number, step in enumerate(steps, 1):
        if number == len(steps) - cycle + 1:
            print("  and then for ever")
        print(f"  {number:3}  {step}")
    if then == "nothing":
        print("  and then nothing more can happen")
