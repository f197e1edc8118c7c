"""`make demo`: the papers' run, told while it goes on; then the tables, the figures and a page.

python -m planner_reactor.experiments.demo --out out/demo
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path

from rich import box
from rich.console import Console
from rich.padding import Padding
from rich.table import Table
from rich.text import Text

from planner_reactor.experiments.loop import Loop
from planner_reactor.experiments.narrative import Narrator
from planner_reactor.experiments.papers import as_data
from planner_reactor.experiments.papers_run import Pays, Replay, replay, what_relaxing_buys
from planner_reactor.workcell import telling

TITLE = "A robot works while its program is being rewritten"
WIDTH = 100
"""Columns of what is printed to no terminal."""

COLOURS = {"planner": "blue", "reactor": "dark_orange3", "world": "green4"}


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the demo; 1 if a law of the system was broken in it, else 0."""
    parser = argparse.ArgumentParser(prog="demo", description="The papers' run, told while it goes on.")
    parser.add_argument("--out", type=Path, default=Path("out/demo"), help="directory for the page and the figures")
    out: Path = parser.parse_args(arguments).out
    console = Console(highlight=False)
    if not console.is_terminal:
        console.width = WIDTH
    out.mkdir(parents=True, exist_ok=True)
    console.print(
        "\n[bold]A robot works while its program is being rewritten[/bold]  (the papers' run, virtual time)\n"
    )
    replayed = replay(lambda loop: _listen(loop, console))
    pays = what_relaxing_buys()
    console.print()
    console.print(_comparison(replayed))
    for note in telling.PAPERS_NOTES:
        console.print(Padding(note, (0, 2)), style="dim")
    console.print()
    console.print(_relaxing(pays))
    from planner_reactor.experiments.page import write_page

    found = as_data(replayed, pays, write_page(out, replayed, pays), out)
    console.print(f"\n{len(found['figures'])} figures, and all of this on one page:  [bold]{out / 'index.html'}[/bold]")
    for violation in found["violations"]:
        console.print(f"law broken: {violation}", style="bold red")
    return 1 if found["violations"] else 0


def _listen(loop: Loop, console: Console) -> None:
    def say(time: float, who: str, what: str) -> None:
        line = Text(f"{time:7.1f} s  ", style="dim")
        console.print(line.append(f"{who:8}", style=COLOURS[who]).append(what, style="default not dim"))

    narrator = Narrator(say, telling.MEANING, telling.told)
    narrator.begin()
    loop.trace.sinks.insert(0, narrator)  # before those that record what follows from an event


def _comparison(replayed: Replay) -> Table:
    table = Table(title="The papers' figures and ours", box=box.SIMPLE_HEAD, title_justify="left", title_style="bold")
    table.add_column("", no_wrap=True)
    table.add_column("the papers")
    table.add_column("ours, on the\npapers' clock")
    table.add_column("ours, on\nour own")
    for row in replayed.rows:
        table.add_row(row.what, row.paper, row.on_their_clock, row.on_ours)
    return table


def _relaxing(pays: Sequence[Pays]) -> Table:
    from planner_reactor.experiments.page import pays_cells

    noun = telling.PRODUCTS
    table = Table(title="What relaxing buys", box=box.SIMPLE_HEAD, title_justify="left", title_style="bold")
    for column in ("faults", "relaxed", f"{noun}\ncompleted", f"{noun}\nrejected", "lost to", "last one\ncompleted at"):
        table.add_column(column)
    for row in pays:
        table.add_row(*pays_cells(row))
    return table


if __name__ == "__main__":
    raise SystemExit(main())
