"""What a run leaves behind: a trace in a file, figures in a directory.

Both are tried before the run begins, and neither is touched before all else has been checked.
"""

from __future__ import annotations

from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from types import TracebackType
from typing import Self

from planner_reactor.calls.inputs import writable_file, writable_folder
from planner_reactor.errors import InputError
from planner_reactor.trace import JsonLines, Trace

FIGURES = "planner_reactor.experiments.figures"


class Outputs:
    """Opened by `with`; a run that ends well is drawn when it is left (`drawn`: the files)."""

    def __init__(self, trace: str | Path | None, figures: str | Path | None) -> None:
        """Refuses what could not be written, with InputError."""
        self._trace = None if trace is None else _trace_file(Path(trace))
        self._figures = None if figures is None else _figures_folder(figures)
        self.drawn: list[str] = []
        self._lines: JsonLines | None = None
        self._kept: Trace | None = None

    def __enter__(self) -> Self:
        if self._figures is not None:
            self._figures.mkdir(parents=True, exist_ok=True)
        if self._trace is not None:
            self._lines = JsonLines(self._trace)
        return self

    def attach(self, trace: Trace) -> None:
        """Write down what this trace records from now on."""
        self._kept = trace
        if self._lines is not None:
            trace.sinks.insert(0, self._lines)  # before those that record something more in answer

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, where: TracebackType | None
    ) -> None:
        if self._lines is not None:
            self._lines.close()
        if self._figures is not None and self._kept is not None and kind is None:
            self.drawn = [str(path) for path in import_module(FIGURES).draw(self._kept.events, self._figures)]


def _trace_file(trace: Path) -> Path:
    if trace.suffix == ".mcap":
        raise InputError(f"trace {trace}: *.mcap is not in this version, there is: *.jsonl")
    if trace.suffix != ".jsonl":
        raise InputError(f"trace {trace}: expected a name that ends in .jsonl")
    return writable_file(trace, called="trace")


def _figures_folder(figures: str | Path) -> Path:
    if find_spec("matplotlib") is None:
        raise InputError("figures: drawing needs matplotlib, the extra `figures`: pip install planner-reactor[figures]")
    return writable_folder(figures, called="figures")
