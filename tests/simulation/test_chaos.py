"""Some minutes of chaos: no law is broken, whatever strikes, and what strikes does strike."""

from __future__ import annotations

from collections import Counter
from pathlib import Path

import pytest
from msgspec.structs import replace

from planner_reactor import simulation
from planner_reactor.reactor.journal import Journal
from planner_reactor.reactor.reactor import Reactor
from planner_reactor.simulation.cases import Case, Fault, Point, World, drawn
from planner_reactor.simulation.counters import ROWS, missing
from planner_reactor.simulation.disks import SimulatedDisk
from planner_reactor.simulation.running import run
from planner_reactor.simulation.shrinking import shrunk

SECONDS = 900.0


@pytest.mark.parametrize("seed", range(1, 17))
def test_whatever_strikes_no_law_is_broken(seed: int) -> None:
    result = run(drawn("workshop", seed, SECONDS))
    assert result.violations == ()
    assert result.adaptations > 5


@pytest.mark.parametrize("seed", [1, 2])
def test_the_cell_lives_through_it(seed: int) -> None:
    result = run(drawn("cell", seed, SECONDS))
    assert result.violations == ()
    assert result.rows["kits completed"] > 0


@pytest.mark.parametrize("world", ["workshop", "cell"])
def test_the_same_case_has_the_same_trace_whatever_the_time_of_day(world: World) -> None:
    jumps = tuple(Fault("jump", at, None) for at in (50.0, 100.0, 200.0))
    result = run(replace(drawn(world, 3, 300.0), faults=jumps), twice=True)
    assert result.rows["24 jumps of the time of day"] == 3
    assert result.violations == ()


@pytest.mark.parametrize("power", ["crash", "power"])
@pytest.mark.parametrize("point", ["appending", "appended", "synced", "removed", "retired", "added", "told"])
def test_a_crash_at_each_point_of_an_adaptation_strikes_inside_it(point: Point, power: str) -> None:
    every = 20.0 if point == "told" else 40.0  # as one is told, another has to be under way for it to count as inside
    faults = tuple(
        Fault(power, every * n, point) for n in range(1, int(320.0 / every))  # type: ignore[arg-type]  # one of the kinds
    )
    result = run(Case("workshop", 5, 400.0, faults))
    assert result.violations == ()
    assert result.inside.get(f"{power} at {point}", 0) >= 2
    assert result.rows[f"struck: {power}"] >= 2


def broken(monkeypatch: pytest.MonkeyPatch, seeds: range = range(1, 8)) -> Counter[str]:
    """The laws that are seen broken within some seeds."""
    found: Counter[str] = Counter()
    for seed in seeds:
        found.update(violation.split(" at ")[0] for violation in run(drawn("workshop", seed, SECONDS)).violations)
        if found:
            break
    return found


def test_a_commit_that_is_not_synced_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(SimulatedDisk, "sync", lambda self: None)
    monkeypatch.setattr(SimulatedDisk, "replace", lambda self, content: setattr(self, "pending", content))
    assert broken(monkeypatch)


def test_a_journal_that_forgets_what_failed_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Journal, "recover", lambda self: type(Journal(SimulatedDisk()).renew) and _empty(self))
    assert broken(monkeypatch)


def _empty(journal: Journal) -> object:
    from planner_reactor.reactor.journal import Recovery

    return Recovery(journal.state)


def test_a_reactor_that_does_not_come_back_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Reactor, "reset", lambda self: None)
    faults = (Fault("halt", 60.0, None, 5.0),)
    assert any("law 12" in v for v in run(Case("workshop", 1, 120.0, faults)).violations)


def test_every_row_has_a_counter_that_is_missed_when_it_is_nought() -> None:
    rows = dict.fromkeys(ROWS, 1)
    assert missing(rows) == []
    assert missing({**rows, "3 writes torn": 0}) == ["3 writes torn"]


def test_every_counter_is_counted_somewhere() -> None:
    counted = "".join(f.read_text() for f in Path(simulation.__file__).parent.glob("*.py") if f.stem != "counters")
    assert [name for name in ROWS if f'"{name}"' not in counted and not name.startswith("4 frames")] == []


def test_a_failing_case_is_made_as_small_as_it_can_be() -> None:
    case = drawn("workshop", 1, 5000.0)
    needed = {case.faults[3], case.faults[11]}
    small = shrunk(case, lambda c: needed <= set(c.faults))
    assert set(small.faults) == needed
