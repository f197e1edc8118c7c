"""The experiments that the command knows: a plain dictionary from names to what runs them.

An entry imports what it needs when it is run, so that the list itself costs nothing.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol


class Run(Protocol):
    """Runs an experiment and writes its results into `out`; returns what was found, as plain data."""

    def __call__(
        self, out: Path, *, trials: int | None, workers: int, watch: Callable[[int, int], object]
    ) -> Mapping[str, Any]:
        """`trials`: how many runs (None: as many as it thinks right); `watch(done, of)` is told of progress."""


@dataclass(frozen=True, slots=True)
class Experiment:
    """`about`: one line that says what it shows."""

    about: str
    run: Run


EXPERIMENTS: dict[str, Experiment] = {}
