"""The experiment `papers`: the papers' run replayed, as figures, one page, and plain data in `papers.json`."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from msgspec.structs import asdict

from planner_reactor.experiments.page import write_page
from planner_reactor.experiments.papers_run import Pays, Replay, replay, what_relaxing_buys
from planner_reactor.workcell import telling


def experiment(
    out: Path,
    *,
    trials: int | None = None,
    workers: int = 1,
    watch: Callable[[int, int], object] = lambda done, of: None,
) -> Mapping[str, Any]:
    """The registry's entry: figures, page and `papers.json` in `out`. There is one trial, by one process."""
    watch(0, 3)
    replayed = replay()
    watch(1, 3)
    pays = what_relaxing_buys()
    watch(2, 3)
    written = write_page(out, replayed, pays)
    watch(3, 3)
    return as_data(replayed, pays, written, out)


def as_data(replayed: Replay, pays: list[Pays], written: list[Path], out: Path) -> dict[str, Any]:
    """What was found, as plain data; also written to `papers.json`."""
    found = {
        "rows": [asdict(row) for row in replayed.rows],
        "relaxing": [asdict(row) for row in pays],
        "notes": list(telling.PAPERS_NOTES),
        "violations": [*replayed.theirs.came_to["violations"], *replayed.ours.came_to["violations"]],
        "trace_hash": replayed.theirs.came_to["trace_hash"],
        "page": str(out / "index.html"),
        "figures": [path.name for path in written],
    }
    (out / "papers.json").write_text(json.dumps(found, indent=1) + "\n", encoding="utf-8")
    return found
