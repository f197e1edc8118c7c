"""Either side of the loop may be killed at any instant, over a link that loses and repeats: the same kits come out."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from typing import Any

import pytest

from planner_reactor.experiments.linked import LinkedLoop
from planner_reactor.experiments.runs import the_domain
from planner_reactor.planner import Planner
from planner_reactor.simulation.wires import CLEAN, Weather
from planner_reactor.workcell.faults import Fault, FaultSchedule
from planner_reactor.workcell.host import host

DOMAIN = the_domain()
POOR = Weather(loss=0.2, repeat=0.2, delay=0.3)
TRAYS = 2
FAULTS = (Fault(20.0, "bad_parts"), Fault(45.0, "part_moved"))


def made(seed: int = 1, *, weather: Weather = CLEAN, faults: tuple[Fault, ...] = ()) -> LinkedLoop:
    loop = LinkedLoop(
        lambda: Planner(DOMAIN, verify=False), lambda s, t: host(s, target=TRAYS, trace=t), seed=seed, weather=weather,
        keep_trace=False,
    )  # fmt: skip
    world = loop.host.world
    assert world is not None
    FaultSchedule(faults, world, loop.scheduler)
    return loop


def is_sound(loop: LinkedLoop) -> bool:
    assert loop.violations == []
    assert loop.host.world is not None
    report: Mapping[str, Any] = loop.host.world.report()
    assert report["kits"]["completed"] == TRAYS
    committed = loop.reactor.journal.state.committed
    segments = {s.name: s.version for s in loop.planner.model}
    return loop.planner.ideal and segments.items() <= committed.versions.items()


def at_each(loop: LinkedLoop, kind: str, every: int, kill: Callable[[], object], most: int) -> None:
    """Kill, in the middle of whatever is done, at every so-manieth event of a kind, so often at most."""
    seen = 0

    def watch(event: Any) -> None:
        nonlocal seen
        seen += event.kind == kind
        if event.kind == kind and seen % every == 0 and seen <= most * every:
            kill()

    loop.trace.sinks.append(watch)


def planner_of(loop: LinkedLoop) -> Callable[[], object]:
    return lambda: loop.scheduler.soon(loop.crash_planner)


def test_over_a_poor_link_as_many_kits_come_out_by_the_same_adaptations() -> None:
    clean, poor = made(), made(weather=POOR)
    for loop in (clean, poor):
        loop.run(until=2000.0)
        assert is_sound(loop)
    assert poor.issued == clean.issued
    assert poor.reactor.text() == clean.reactor.text()


@pytest.mark.parametrize(("kind", "every"), [("planner_step", 17), ("adaptation_issued", 3), ("draining", 5)])
def test_a_planner_that_is_killed_again_and_again_loses_no_kit_and_leaves_the_same_reactor(
    whole: LinkedLoop, kind: str, every: int
) -> None:
    loop = made(faults=FAULTS)
    at_each(loop, kind, every, planner_of(loop), 5)
    loop.run(until=2000.0)
    assert is_sound(loop)
    assert loop.crashes["planner"] >= 3
    assert sorted(clauses(loop)) == sorted(clauses(whole))
    assert loop.reactor.counts["applied"] <= whole.reactor.counts["applied"]  # none is needless


@pytest.fixture(scope="module")
def whole() -> LinkedLoop:
    """Nobody is killed."""
    loop = made(faults=FAULTS)
    loop.run(until=2000.0)
    assert is_sound(loop)
    return loop


def clauses(loop: LinkedLoop) -> list[str]:
    return [text.partition(" = ")[2] for text in loop.reactor.journal.state.committed.clauses.values()]


POINTS = ["draining", "removed", "added", "adaptation_applied"]


@pytest.mark.parametrize("power", [False, True], ids=["killed", "power loss"])
@pytest.mark.parametrize("point", POINTS)
def test_a_reactor_that_ends_inside_an_adaptation_goes_on_with_the_same_planner(point: str, power: bool) -> None:
    loop = made(weather=POOR)
    at_each(loop, point, 7, partial(loop.crash_reactor, power=power), 4)
    loop.run(until=3000.0)
    assert loop.crashes["power" if power else "reactor"] >= 3
    assert is_sound(loop)
    assert loop.planners == 1


def test_both_sides_are_killed_again_and_again() -> None:
    loop = made(weather=POOR, faults=FAULTS)
    at_each(loop, "adaptation_applied", 9, partial(loop.crash_reactor, power=True), 3)
    at_each(loop, "adaptation_issued", 8, planner_of(loop), 3)
    loop.run(until=3000.0)
    assert loop.crashes["power"] >= 2
    assert loop.crashes["planner"] >= 2
    assert is_sound(loop)
