"""Limit sets against runs: no run comes to a limit that the symbolic set lacks, and each of its limits is reached.

`EXECUTIONS=10000` makes as many runs (about a minute for each model); some hundreds are made by default.
"""

from __future__ import annotations

import os

import pytest

from planner_reactor.analysis.conditions import text
from tests.analysis.executions import campaign
from tests.analysis.models import CALLS, SENSORS, limits, shipped

EXECUTIONS = int(os.environ.get("EXECUTIONS", "240"))


@pytest.mark.timeout(900 if EXECUTIONS > 1_000 else 20)
@pytest.mark.parametrize("name", CALLS)
def test_runs_come_to_the_limits_of_the_set_and_to_no_others(name: str) -> None:
    symbolic = shipped(name)
    entries = limits(symbolic).limits
    unforetold, unreached, ended = campaign(name, EXECUTIONS // 3, 7, SENSORS, entries, symbolic)
    assert unforetold == []
    assert [text(entry.condition) for entry in unreached] == []
    assert ended >= EXECUTIONS // 3 * 0.9


def test_a_limit_that_the_set_lacks_is_seen() -> None:
    """The check can fail: without one entry, some run is foretold by none."""
    symbolic = shipped("tracking")
    entries = limits(symbolic).limits
    for left_out in entries:
        kept = tuple(e for e in entries if e is not left_out)
        unforetold, _, _ = campaign("tracking", 60, 3, SENSORS, kept, symbolic)
        assert unforetold
