"""A running situation is frozen: stopped in an orderly way, put in order, and let go again (R §5.5)."""

from __future__ import annotations

from typing import Any

import pytest

from planner_reactor.errors import InputError
from planner_reactor.reactor.holding import Holding
from planner_reactor.reactor.situations import Situations
from tests.reactor.driving import FIRST, SECOND, Bench


def frozen(at: float = 3.0, cleanup: str = "STOP", situation: str = "work") -> Bench:
    """The reactor is at work on `part`, from 2 s to 4 s, when `work` above it is frozen."""
    bench = Bench()
    bench.reactor.receive(FIRST)
    bench.scheduler.call_at(at, lambda: bench.reactor.freezer.freeze(situation, cleanup))
    return bench


def test_what_is_in_service_is_stopped_with_its_one_abandon_and_the_instance_stays_on() -> None:
    bench = frozen()
    bench.run(10.0)
    assert bench.abandoned == ["old"]
    assert bench.reactor.executer.statistics().basic_running == 0
    on = [i.situation.name for i in bench.reactor.situations.instances.values() if i.status == "on"]
    assert on == ["work"]
    assert bench.times("ended", situation="part", cause="cancelled") == [3.0]
    assert bench.times("delivered", situation="work")[-1] < 3.0


def test_it_is_no_interruption_by_an_adaptation_and_is_counted_apart() -> None:
    bench = frozen()
    bench.run(10.0)
    assert bench.reactor.laws.violations == []
    assert (bench.reactor.laws.interruptions, bench.reactor.laws.frozen) == (0, 2)


def test_the_cleanup_runs_while_nothing_of_it_is_served_and_thawing_serves_it_anew() -> None:
    bench = frozen(cleanup="Do[tidy, 1.5]")
    bench.scheduler.call_at(8.0, lambda: bench.reactor.freezer.thaw("work"))
    bench.run(9.0)
    assert bench.reactor.freezer.frozen == ()
    assert bench.times("delivered", situation="work")[-1] == 8.0
    assert bench.reactor.laws.violations == []
    bench.run(12.0)
    assert bench.times("completed", situation="part")[-1] >= 10.0


def test_an_adaptation_has_nothing_to_wait_for_in_what_is_frozen() -> None:
    bench = frozen(at=2.5, situation="part")
    bench.at(2.6, SECOND)
    bench.scheduler.call_at(3.5, lambda: bench.reactor.freezer.thaw("part"))
    bench.run(6.0)
    assert bench.times("adaptation_applied", id=2) == [2.6]  # without the freeze it waits for the body, until 4 s
    assert bench.times("delivered", situation="part")[-1] >= 3.5
    assert bench.reactor.laws.violations == []


def test_its_hold_ends_with_a_thaw_and_only_then() -> None:
    bench = frozen(cleanup="ABORT")
    bench.run(50.0)
    assert bench.reactor.freezer.frozen == ("work",)
    assert [s.name for s in bench.reactor.situations.held] == ["work"]
    bench.reactor.freezer.thaw("work")
    bench.run(51.0)
    assert bench.reactor.situations.held == []


def test_halting_ends_a_freeze_too() -> None:
    bench = frozen()
    bench.scheduler.call_at(5.0, bench.reactor.halt)
    bench.run(6.0)
    assert bench.reactor.freezer.frozen == ()
    with pytest.raises(InputError, match="halted"):
        bench.reactor.freezer.freeze("work")


@pytest.mark.parametrize(
    ("situation", "cleanup", "why"),
    [("work", "STOP", "frozen already"), ("part", "Doo[tidy, 1]", "did you mean Do"), ("part", "Do[tidy", "expected")],
)
def test_what_cannot_be_frozen_like_this_is_refused(situation: str, cleanup: str, why: str) -> None:
    bench = frozen()
    bench.run(5.0)
    with pytest.raises(InputError, match=why):
        bench.reactor.freezer.freeze(situation, cleanup)


def test_what_is_not_frozen_cannot_be_thawed() -> None:
    with pytest.raises(InputError, match="part is not frozen, frozen are: none"):
        Bench().reactor.freezer.thaw("part")


def test_law_2_sees_a_freeze_that_does_not_hold_the_situation(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Situations, "inhibit", lambda self, name, owner: None)
    bench = frozen()
    bench.run(3.0)
    assert 2 in {v.law for v in bench.reactor.laws.violations}


def test_law_2_sees_a_body_that_is_cut_without_a_freeze(monkeypatch: pytest.MonkeyPatch) -> None:
    usual: Any = Holding._freeze

    def cutting(self: Any, strand: Any, arguments: Any) -> Any:
        for body in list(self._sit.bodies):
            self._waker.executer._kernel.silent.clear()
            body.opener.closed.__self__._situations.leave(*body.context, cut=True)
        return usual(self, strand, arguments)

    monkeypatch.setattr(Holding, "_freeze", cutting)
    bench = frozen()
    bench.run(3.0)
    assert 2 in {v.law for v in bench.reactor.laws.violations}
