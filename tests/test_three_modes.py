"""The kit in all three modes of adaptation: the same kits, nothing interrupted; only the waiting differs (R §5.5)."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import Any

import pytest

import planner_reactor
from planner_reactor.analysis.adaptations import SMALL_VERSIONS, Verifier
from planner_reactor.trace import Event, read
from tests.analysis.test_adaptations import FILL, PRESENT, verdict

MODES = ("drain", "wait", "versions")


@cache
def kit(mode: str) -> dict[str, Any]:
    return planner_reactor.kit(trays=10, seed=1, mode=mode)


@pytest.mark.parametrize("mode", MODES)
def test_ten_kits_come_out_and_nothing_is_interrupted(mode: str) -> None:
    found = kit(mode)
    books = found["adaptations"]
    assert found["kits"] == {"completed": 10, "rejected": 0}
    assert found["interruptions"] == 0
    assert found["violations"] == []
    assert books["issued"] == books["applied"]
    assert len(found["relaxations"]) == 9


def last_applied(mode: str) -> float:
    applied: list[float] = [r["applied_s"] for r in kit(mode)["relaxations"]]
    return max(applied)


def test_beside_each_other_versions_wait_for_nobody() -> None:
    assert last_applied("versions") < 1.0
    assert last_applied("versions") < last_applied("drain") <= last_applied("wait")


def test_what_was_retired_has_gone_at_the_end(tmp_path: Path) -> None:
    trace = tmp_path / "run.jsonl"
    planner_reactor.kit(trays=2, seed=1, mode="versions", trace=trace)
    events: list[Event] = list(read(trace))
    retired = {e.data["label"] for e in events if e.kind == "retired"}
    removed = {e.data["label"] for e in events if e.kind == "removed"}
    assert len(retired) > 5
    assert retired <= removed


@pytest.mark.parametrize("mode", MODES)
def test_an_assumption_that_fails_is_coped_with_in_every_mode(mode: str, tmp_path: Path) -> None:
    faults = tmp_path / "faults.toml"
    faults.write_text('[[fault]]\nat = 60.0\nkind = "part_removed_from_tray"\n')
    found = planner_reactor.kit(trays=5, seed=3, faults=faults, relax=("AS",), until=3000, mode=mode)
    assert found["kits"]["completed"] == 5
    assert found["violations"] == []
    assert found["interruptions"] == 0
    assert ("ACT", "forced") in {(r["assumption"], r["cause"]) for r in found["relaxations"]}


def test_no_look_at_versions_is_long() -> None:
    """What is too large is looked at situation by situation, and what is still too large has a known form."""
    crowd = PRESENT.replace("ASSERT[kit]", "(ASSERT[cap, 1] | ASSERT[cap, 2])").replace(" :; (~", " :: (~")
    found = verdict(FILL, Verifier(mode="versions"), present=crowd)
    assert found.holds
    assert found.states <= 3 * SMALL_VERSIONS
