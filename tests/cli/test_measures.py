"""`experiment` and `bench`."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

import planner_reactor
from planner_reactor.errors import InputError
from planner_reactor.experiments.registry import EXPERIMENTS, Experiment
from tests.cli.conftest import Call


def toy(out: Path, *, trials: int | None, workers: int, watch: Callable[[int, int], object]) -> dict[str, Any]:
    """Writes down that it was run."""
    watch(1, 1)
    (out / "toy.txt").write_text("done")
    return {"trials": trials, "workers": workers, "rows": [{"seed": 1, "kits": 2}, {"seed": 2, "kits": 3}]}


@pytest.fixture
def with_toy(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(EXPERIMENTS, "toy", Experiment("A toy.", toy))


@pytest.mark.usefixtures("with_toy")
def test_an_experiment_is_run_by_name_and_writes_into_its_directory(call: Call, place: Path) -> None:
    found = call("experiment", "toy", "--out", "new/results", "--trials", "2", "--json").object
    assert (found["trials"], found["workers"]) == (2, 1)
    assert (place / "new" / "results" / "toy.txt").read_text() == "done"
    shown = call("experiment", "toy", "--out", "new/results").out
    assert "toy: rows" in shown
    assert "workers: 1" in shown


@pytest.mark.usefixtures("with_toy")
@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("tyo", "--out", "new"), "unknown experiment tyo, did you mean toy?"),
        (("toy", "--out", "new", "--trials", "0"), "trials is 0, expected a whole number, 1 or more"),
        (("toy", "--out", "new", "--workers", "-1"), "workers is -1, expected a whole number, 1 or more"),
        (("toy", "--out", "cell.rsl"), "cell.rsl is a file, expected a directory"),
        (("toy",), "missing option '--out'"),
    ],
)  # fmt: skip
def test_a_wrong_experiment_makes_no_directory(call: Call, place: Path, arguments: tuple[str, ...], said: str) -> None:
    assert call("experiment", *arguments).refused(said)
    assert not (place / "new").exists()


def benchmarks(folder: Path, script: str) -> Path:
    folder.mkdir()
    (folder / "__main__.py").write_text(script)
    return folder


def test_bench_runs_the_benchmarks_of_a_checkout(place: Path) -> None:
    script = "import json, sys\nprint('warming up', file=sys.stderr)\nprint(json.dumps({'arguments': sys.argv[1:]}))\n"
    folder = benchmarks(place / "benchmarks", script)
    assert planner_reactor.bench(peers=True, folder=folder) == {"arguments": ["--json", "--peers"]}


@pytest.mark.parametrize(
    ("script", "said"),
    [("raise SystemExit(3)", "ended with status 3"), ("print('fast')", "printed no JSON")],
)
def test_benchmarks_that_fail_are_told(place: Path, script: str, said: str) -> None:
    with pytest.raises(InputError, match=said):
        planner_reactor.bench(folder=benchmarks(place / "benchmarks", script))


def test_without_a_checkout_there_are_no_benchmarks(place: Path) -> None:
    with pytest.raises(InputError, match="expected a checkout"):
        planner_reactor.bench(folder=place)
