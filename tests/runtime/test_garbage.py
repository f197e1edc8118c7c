"""Runs on the wall clock are not interrupted by the collector, and leave it as it was."""

from __future__ import annotations

import gc

import pytest

from planner_reactor.calls import looping
from planner_reactor.runtime.garbage import SELDOM, seldom_collected


def test_it_looks_seldom_and_not_at_what_was_there_and_is_then_as_before() -> None:
    before, frozen = gc.get_threshold(), gc.get_freeze_count()
    with seldom_collected():
        assert gc.get_threshold() == SELDOM
        assert gc.get_freeze_count() > frozen
    assert gc.get_threshold() == before
    assert gc.get_freeze_count() == 0


@pytest.mark.parametrize(("clock", "seldom"), [("wall", True), ("virtual", False)])
def test_runs_on_the_wall_clock_are_such(clock: str, seldom: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    seen: list[bool] = []
    monkeypatch.setattr(looping.Loop, "run", lambda self, **_: seen.append(gc.get_threshold() == SELDOM))
    looping.kit(clock=clock, until=0.01)  # type: ignore[arg-type]
    assert seen[0] is seldom
