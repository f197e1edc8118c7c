"""The experiments that the command knows: a plain dictionary from names to what runs them.

An entry imports what it needs when it is run, so that the list itself costs nothing.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from importlib import import_module
from pathlib import Path
from typing import Any, Protocol

import msgspec


class Run(Protocol):
    """Runs an experiment and writes its results into `out`; returns what was found, as plain data."""

    def __call__(
        self, out: Path, *, trials: int | None, workers: int, watch: Callable[[int, int], object]
    ) -> Mapping[str, Any]:
        """`trials`: how many runs (None: as many as it thinks right); `watch(done, of)` is told of progress."""


class Experiment(msgspec.Struct, frozen=True):
    """`about`: one line that says what it shows."""

    about: str
    run: Run


def _of(module: str) -> Run:
    """The function `experiment` of a module of this package, which is imported when it is called."""

    def run(out: Path, *, trials: int | None, workers: int, watch: Callable[[int, int], object]) -> Mapping[str, Any]:
        found: Mapping[str, Any] = import_module(f"planner_reactor.experiments.{module}").experiment(
            out, trials=trials, workers=workers, watch=watch
        )
        return found

    return run


EXPERIMENTS: dict[str, Experiment] = {
    "papers": Experiment("the papers' run on their clock and on ours: figures, tables, one page", _of("papers")),
    "faults": Experiment("random faults, seed after seed, with relaxing and without", _of("fault_trials")),
    "load": Experiment("how long an adaptation waits while instances overlap, in each mode", _of("load")),
    "startup": Experiment("how long the planner thinks: to act, to be ideal, to relax", _of("startup")),
    "ideal": Experiment("are the planner's reactors ω-ideal? every run, where assumptions hold and where they fail",
                        _of("ideal_reactors")),
    "assumptions": Experiment("are the nine assumptions real? reactors built on each and without it, in worlds with it "
                              "and without", _of("assumptions")),
    "reactors": Experiment("every reactor that can be built on the nine assumptions, run where they hold and where not",
                           _of("every_reactor")),
    "dynamics": Experiment("the second paper's figures 2 to 8, from the texts of the models and from runs of them",
                           _of("figures_signals")),
    "tracking": Experiment("TRACK, found from a model: an object kept in view, until it is not dense enough",
                           _of("tracking")),
    "acquiring": Experiment("GuardedMove and GuardedWait, found from models: a thousand runs each, and the change",
                            _of("acquiring")),
    "picking": Experiment("parts that slide away, picked by a derived reaction and by the hand-written one",
                          _of("picking")),
}
