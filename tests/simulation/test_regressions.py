"""What chaos found once stays mended."""

from __future__ import annotations

from pathlib import Path

import pytest

from planner_reactor.simulation.cases import Case
from planner_reactor.simulation.keeping import read_cases, written
from planner_reactor.simulation.running import run

CASES = read_cases(Path(__file__).with_name("regressions.toml").read_text())


@pytest.mark.parametrize("case", CASES, ids=lambda case: f"{case.world}-{case.seed}-{len(case.faults)}")
def test_a_case_that_failed_once_fails_no_more(case: Case) -> None:
    assert run(case).violations == ()


def test_a_case_is_kept_as_it_is() -> None:
    assert read_cases("".join(written(case, "why") for case in CASES)) == CASES
