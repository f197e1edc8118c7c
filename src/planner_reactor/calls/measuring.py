"""`experiment` and `bench`: many runs, and how fast the machinery is beside its peers.

An experiment is one entry of `experiments.registry`; the benchmarks stand in the folder `benchmarks/` of a checkout,
not in the installed package, and are run in a process of their own, so that nothing here weighs on them.
"""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import planner_reactor
from planner_reactor.calls.inputs import unknown, whole, writable_folder
from planner_reactor.errors import InputError
from planner_reactor.experiments.registry import EXPERIMENTS


def experiment(
    name: str,
    *,
    out: str | Path,
    trials: int | None = None,
    workers: int = 1,
    watch: Callable[[int, int], object] = lambda done, of: None,
) -> dict[str, Any]:
    """Run an experiment of the registry and write its results into the directory `out`.

    `trials` runs (default: as many as the experiment thinks right) by `workers` processes; `watch` is told how many
    are done, of how many. Returns what the experiment found.
    """
    if name not in EXPERIMENTS:
        raise unknown("experiment", name, EXPERIMENTS)
    if trials is not None:
        whole("trials", trials, 1)
    whole("workers", workers, 1)
    folder = writable_folder(out, called="out")
    folder.mkdir(parents=True, exist_ok=True)
    return dict(EXPERIMENTS[name].run(folder, trials=trials, workers=workers, watch=watch))


def bench(*, peers: bool = False, folder: str | Path | None = None) -> dict[str, Any]:
    """Run the benchmarks of this checkout, with `peers` also those systems that we are measured against.

    Returns what `benchmarks/__main__.py --json` prints, one object; its progress goes to standard error.
    """
    script = _benchmarks(folder) / "__main__.py"
    if not script.is_file():
        raise InputError(f"no benchmarks here ({script} is not there), expected a checkout of planner-reactor")
    command = [sys.executable, str(script), "--json", *(["--peers"] if peers else [])]
    ran = subprocess.run(command, stdout=subprocess.PIPE, check=False)
    if ran.returncode != 0:
        raise InputError(f"the benchmarks ended with status {ran.returncode}")
    try:
        found = json.loads(ran.stdout)
    except ValueError as error:
        raise InputError(f"the benchmarks printed no JSON: {error}") from error
    return found if isinstance(found, dict) else {"results": found}


def _benchmarks(folder: str | Path | None) -> Path:
    """The folder given, or the one of the checkout that this package is in, or the one in the current directory."""
    if folder is not None:
        return Path(folder)
    beside = Path(planner_reactor.__file__).resolve().parents[2] / "benchmarks"
    return beside if beside.is_dir() else Path("benchmarks")
