"""The experiment `load`: the papers' mode waits for ever where instances overlap, ours do not."""

from __future__ import annotations

from pathlib import Path

import pytest

from planner_reactor.experiments.figures_load import draw
from planner_reactor.experiments.load import LONGEST, PATIENCE, Trial, _line, one

SEEDS = (1, 2, 3)


@pytest.mark.parametrize("overlapping", [1, 3, 8])
def test_versions_act_at_once_and_a_drain_within_one_instance(overlapping: int) -> None:
    for seed in SEEDS:
        assert one(Trial("versions", overlapping, seed))["applied_s"] == 0.0
        assert one(Trial("drain", overlapping, seed))["applied_s"] <= LONGEST


def test_waiting_for_an_idle_instant_takes_for_ever_under_load() -> None:
    assert one(Trial("wait", 1, 1))["applied_s"] < 20.0
    assert one(Trial("wait", 8, 1))["applied_s"] is None


def test_no_law_is_broken_and_the_figure_is_drawn(tmp_path: Path) -> None:
    rows = [one(Trial(mode, n, 1)) for mode in ("wait", "drain", "versions") for n in (1, 8)]  # type: ignore[arg-type]
    lines = [_line(rows, mode, n) for mode in ("wait", "drain", "versions") for n in (1, 8)]  # type: ignore[arg-type]
    assert sum(line["violations"] for line in lines) == 0
    assert [line["never"] for line in lines if line["mode"] == "wait"] == [0.0, 1.0]
    assert max(line["median_s"] or 0.0 for line in lines) < PATIENCE
    assert all(file.stat().st_size > 5_000 for file in draw(lines, tmp_path))
