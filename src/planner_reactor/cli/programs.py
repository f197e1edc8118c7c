"""`run` and `check`: programs in RS, and domains as far as texts go."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any

import typer

from planner_reactor.cli import options
from planner_reactor.cli.application import command
from planner_reactor.cli.printing import Notes, print_json, reserved_output, say, show_conformance
from planner_reactor.errors import Diagnostic


@command("cell.rsl Main", "cell.rsl 'Serve[3, cap]' --until 60 --seed 1 --json", "demo.rsl Main --host my_cell")
def run(
    file: Annotated[Path, typer.Argument(metavar="FILE.rsl", help="The program.", show_default=False)],
    process: Annotated[
        str, typer.Argument(metavar="'NAME[args]'", help="The process to run, with values as arguments.")
    ],
    host: options.HostModule = None,
    seed: options.Seed = 0,
    until: options.Until = None,
    clock: options.ClockName = "virtual",
    conform: options.Conform = False,
    as_json: options.Json = False,
) -> int:
    """Run one process of a program until it ends."""
    from planner_reactor.calls import running

    notes = Notes()
    with reserved_output():
        result = running.run(
            file, process, host=host, seed=seed, until=until, clock=clock, conform=conform, told=notes
        )
    notes.close()
    if as_json:
        print_json(result)
    else:
        _show_run(process, result)
    return int(result.get("conformance", {}).get("disagreement") is not None)


def _show_run(process: str, result: dict[str, Any]) -> None:
    cause = f" ({result['cause']})" if result["cause"] else ""
    print(f"{process}: {result['outcome']}{cause} at {result['time_s']:.3f} s")
    for name, value in result["results"].items():
        print(f"  {name} = {value}")
    events, live = result["events"], result["processes_live"]
    processes = "process" if live == 1 else "processes"
    print(f"{events} event{'s'[: events != 1]}, {result['rendezvous']} rendezvous, {live} {processes} live")
    for port, side in result["waiting"].items():
        print(f"  {side} waits at port {port}")
    if "conformance" in result:
        show_conformance(result["conformance"])
    if result["zeno"]:
        say(f"{result['zeno']} went round and round at one instant, and was held up")


@command("cell.rsl", "cell.rsl kitting.itl --host planner_reactor.workcell.host --strict --json")
def check(
    files: Annotated[
        list[Path], typer.Argument(metavar="FILE.rsl|FILE.itl...", help="Programs and domains.", show_default=False)
    ],
    host: options.HostModule = None,
    strict: Annotated[bool, typer.Option("--strict", help="Exit with 1 if there is a warning.")] = False,
    as_json: options.Json = False,
) -> int:
    """Find what is wrong or doubtful about programs and domains."""
    from planner_reactor.calls import checking

    with reserved_output():
        found = checking.findings(*files, host=host)
    errors = sum(finding.severity == "error" for finding in found)
    for finding in found:
        say(_shown(finding))
    if as_json:
        print_json({"ok": not errors, "diagnostics": [checking.as_json(finding) for finding in found]})
    else:
        print(_verdict(files, errors, len(found) - errors))
    return 2 if errors else int(strict and bool(found))


def _shown(finding: Diagnostic) -> str:
    text = str(finding)
    if finding.severity == "error":
        return text
    place = f"{finding.place}: "
    return f"{place}{finding.severity}: {text.removeprefix(place)}"


def _verdict(files: Sequence[Path], errors: int, warnings: int) -> str:
    if not errors and not warnings:
        return f"{_count(len(files), 'file')}: nothing found"
    return f"{_count(len(files), 'file')}: {_count(errors, 'error')}, {_count(warnings, 'warning')}"


def _count(number: int, what: str) -> str:
    return f"{number} {what}" if number == 1 else f"{number} {what}s"
