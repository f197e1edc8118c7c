"""The restart intensity limit, and the watchdog: when the executive gives itself up (docs/reactor.md)."""

from __future__ import annotations

from typing import Any

import msgspec
import pytest

from planner_reactor.errors import InputError
from planner_reactor.reactor.heartbeat import Heartbeat
from planner_reactor.reactor.journal import Journal
from planner_reactor.reactor.reactor import Reactor
from planner_reactor.reactor.storms import Intensity
from tests.reactor.disks import TornDisk
from tests.reactor.driving import FIRST, SECOND, Bench

LIMIT = Intensity(failures=3, window=30.0)


def stormy(*, journal: Journal | None = None, limit: Intensity | None = LIMIT, first: bool = True) -> Bench:
    """A bench whose `part` fails every 2 s, before its reactor is limited."""
    bench = Bench.__new__(Bench)
    usual = Reactor.__init__

    def limited(self: Reactor, *arguments: Any, **keywords: Any) -> None:
        usual(self, *arguments, **keywords, intensity=limit)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Reactor, "__init__", limited)
        Bench.__init__(bench, journal=journal)
    bench.failing.add("old")
    if first:
        bench.reactor.receive(FIRST)
    return bench


def test_a_situation_that_fails_too_often_is_disabled_and_that_is_told() -> None:
    bench = stormy()
    bench.run(60.0)
    assert bench.times("storm", situation="part") == [8.0]  # the fourth failure
    assert bench.reactor.situations.named("part").disabled
    assert len(bench.times("delivered", situation="part")) == 4
    assert [p.subject for p in bench.perceptions() if p.kind == "storm"] == ["part"]
    assert bench.reactor.laws.violations == []


def test_without_a_limit_it_goes_on_for_ever() -> None:
    bench = stormy(limit=None)
    bench.run(60.0)
    assert len(bench.times("delivered", situation="part")) == 31
    assert bench.times("storm") == []


def test_failures_that_are_far_apart_are_no_storm() -> None:
    bench = stormy(limit=Intensity(failures=3, window=5.0))
    bench.run(60.0)
    assert bench.times("storm") == []


def test_new_reactions_begin_with_a_clean_record() -> None:
    bench = stormy()
    bench.at(20.0, SECOND)
    bench.run(40.0)
    assert not bench.reactor.situations.named("part").disabled
    assert min(t for t in bench.times("delivered", situation="part") if t > 8.0) == 20.0
    assert bench.reactor.laws.violations == []


def test_a_storm_outlasts_a_crash() -> None:
    disk = TornDisk()
    stormy(journal=Journal(disk)).run(20.0)
    again = stormy(journal=Journal(disk), first=False)
    again.run(20.0)
    assert again.reactor.situations.named("part").disabled
    assert again.times("delivered", situation="part") == []
    assert again.reactor.laws.violations == []


def test_a_storm_of_a_root_s_situation_is_a_safe_stop() -> None:
    text = FIRST.definitions.replace("REASSERT[part]", "Do[old, 1]")
    bench = stormy(first=False)
    bench.reactor.receive(msgspec.structs.replace(FIRST, definitions=text))
    bench.run(60.0)
    assert bench.times("storm", situation="work") == bench.times("halted") == [4.0]
    assert bench.reactor.halted
    assert bench.reactor.commands() == 0
    assert bench.reactor.laws.violations == []


@pytest.mark.parametrize(("failures", "window"), [(0, 1.0), (1, 0.0)])
def test_a_limit_that_makes_no_sense_is_refused(failures: int, window: float) -> None:
    with pytest.raises(InputError, match="expected"):
        Intensity(failures=failures, window=window)


# ---------------------------------------------------------------------------------------------------- the watchdog


class Device:
    """A watchdog outside: trips when `patience` seconds pass without a kick, and stays so until it is reset."""

    period = 0.5
    patience = 1.2

    def __init__(self) -> None:
        self.kicked = 0.0
        self.tripped: float | None = None

    def passes(self, now: float) -> None:
        """The device's own clock."""
        if self.tripped is None and now > self.kicked + self.patience:
            self.tripped = self.kicked + self.patience

    def kick(self, now: float) -> bool:
        self.passes(now)
        if self.tripped is None:
            self.kicked = now
        return self.tripped is None

    def reset(self, now: float) -> None:
        self.tripped, self.kicked = None, now


def watched() -> tuple[Bench, Device]:
    device = Device()
    bench = Bench()
    bench.host.watchdog = device
    bench.reactor.heartbeat.start()
    bench.reactor.receive(FIRST)
    return bench, device


def test_it_is_kicked_as_long_as_the_executive_turns_its_loop() -> None:
    bench, device = watched()
    bench.run(60.0)
    device.passes(60.0)
    assert device.tripped is None
    assert bench.reactor.heartbeat.kicks == 121


def test_a_hung_executive_is_stopped_from_outside_and_does_not_resume_by_itself() -> None:
    bench, device = watched()
    bench.run(10.0)
    device.passes(15.0)  # nobody turned the loop meanwhile
    assert device.tripped == pytest.approx(11.2)
    bench.run(20.0)  # it turns again: its first life sign is refused
    assert bench.reactor.halted
    assert bench.reactor.commands() == 0
    bench.reactor.reset()
    bench.run(21.0)
    assert bench.reactor.halted  # the device has not been reset
    device.reset(21.0)
    bench.reactor.reset()
    bench.run(40.0)
    assert not bench.reactor.halted
    assert bench.times("completed", situation="part")[-1] > 21.0
    assert bench.reactor.laws.violations == []


def test_a_reactor_whose_laws_are_broken_gives_no_life_sign() -> None:
    bench, device = watched()
    bench.scheduler.call_at(10.0, lambda: bench.reactor.laws.breach(5, "as announced"))
    bench.run(20.0)
    device.passes(20.0)
    assert device.tripped == pytest.approx(10.7)  # the last kick was at 9.5 s


def test_the_check_can_fail(monkeypatch: pytest.MonkeyPatch) -> None:
    """A heartbeat that takes no notice of the device goes on after it has tripped."""

    def deaf(self: Heartbeat, watchdog: Device) -> None:
        watchdog.kick(self._reactor.scheduler.now)
        self._reactor.scheduler.call_after(watchdog.period, lambda: deaf(self, watchdog))

    monkeypatch.setattr(Heartbeat, "_beat", deaf)
    bench, device = watched()
    bench.run(10.0)
    device.passes(15.0)
    bench.run(20.0)
    assert not bench.reactor.halted
