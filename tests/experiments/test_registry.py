"""The experiments as the command runs them: what they write, and what they find."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import pytest

from planner_reactor.experiments import demo
from planner_reactor.experiments.fault_trials import drawn
from planner_reactor.experiments.papers_run import what_relaxing_buys
from planner_reactor.experiments.registry import EXPERIMENTS
from planner_reactor.experiments.trials import interval, middle, run_trials
from planner_reactor.workcell.evidence import ASSUMPTIONS

from .conftest import Written


def test_the_papers_run_leaves_a_page_that_needs_no_network(written: Written) -> None:
    page = (written.folder / "index.html").read_text(encoding="utf-8")
    found = written.found
    assert written.progress == [(0, 3), (1, 3), (2, 3), (3, 3)]
    assert page.count("data:image/svg+xml;base64,") == 12
    assert "http" not in page
    assert json.loads((written.folder / "papers.json").read_text())["rows"] == found["rows"]
    assert found["violations"] == []
    assert {row["paper"] for row in found["rows"]} >= {"26 s", "40 s", "152 s", "215 s", "357 s"}


def test_relaxing_buys_products() -> None:
    """The same faults: with relaxing the work goes on to the end, without it stops."""
    rows = what_relaxing_buys(until=900.0)
    for with_all, with_none in (rows[:2], rows[2:]):
        assert (with_all.relax, with_none.relax) == ("all", "none")
        assert with_all.completed >= 3 * with_none.completed
        assert with_all.rejected == 0
        assert with_all.last_s is not None
        assert with_all.last_s > 850.0
    assert rows[3].rejected == 1
    assert rows[3].lost_to == ("bad_parts",)


def test_the_demo_tells_prints_and_says_where_the_page_is(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(demo, "what_relaxing_buys", lambda: what_relaxing_buys(until=160.0))
    monkeypatch.setattr("planner_reactor.experiments.page.draw", lambda events, out, **options: [])
    assert demo.main(["--out", str(tmp_path / "demo")]) == 0
    printed = capsys.readouterr().out
    assert "begins to act; the planner goes on thinking" in printed
    assert "The papers' figures and ours" in printed
    assert "What relaxing buys" in printed
    assert "index.html" in printed
    assert (tmp_path / "demo" / "index.html").is_file()


def test_random_faults_are_survived_and_counted(tmp_path: Path) -> None:
    found = EXPERIMENTS["faults"].run(tmp_path, trials=6, workers=1, watch=lambda done, of: None)
    assert found["ok"] == found["trials"] == 6
    with_all, with_none = found["relaxing"]
    assert with_all["completed_mean"] == 15
    assert with_none["completed"] < with_all["completed"] / 2
    assert all(kind["struck"] == kind["sensed"] for kind in found["kinds"])
    assert found["relaxations"]["normal"] > 0
    assert found["relaxations"]["forced"] > 0
    with (tmp_path / "faults.csv").open(encoding="utf-8") as rows:
        assert [row["seed"] for row in csv.DictReader(rows)] == ["1", "2", "3", "4", "5", "6"]


def test_trials_differ_in_pace_and_in_what_is_relaxed_by_choice() -> None:
    trials = [drawn(seed, ASSUMPTIONS) for seed in range(40)]
    assert trials == [drawn(seed, ASSUMPTIONS) for seed in range(40)]
    assert len({trial.planner_s for trial in trials}) == 3
    assert len({trial.by_choice for trial in trials}) > 10
    assert any(trial.by_choice == "all" for trial in trials)


def test_several_processes_find_what_one_finds(tmp_path: Path) -> None:
    squares = run_trials(abs, [-3, -1, -2], workers=2, watch=lambda done, of: None)
    assert squares == run_trials(abs, [-3, -1, -2], workers=1, watch=lambda done, of: None) == [3, 1, 2]


def test_how_long_the_planner_takes_is_measured(tmp_path: Path) -> None:
    found = EXPERIMENTS["startup"].run(tmp_path, trials=1, workers=1, watch=lambda done, of: None)
    times = {line["what"]: line for line in found["times"]}
    assert set(times) >= {
        "domain read",
        "first adaptation",
        "first ideal reactor",
        *(f"relax {a}" for a in ASSUMPTIONS),
    }
    assert 0 < times["first adaptation"]["median_ms"] <= times["first ideal reactor"]["median_ms"]
    assert times["first adaptation"]["aim_ms"] == 5.0


def test_means_have_intervals_and_shares_have_bounds() -> None:
    assert interval([4.0, 4.0, 4.0]) == (4.0, 0.0)
    assert interval([2.0]) == (2.0, 0.0)
    assert interval([1.0, 3.0])[1] == pytest.approx(1.96, abs=0.01)
    assert (middle([3, 1, 2]), middle([]), middle([1, 2, 3, 4], 0.9)) == (2, None, 4)
