"""What acts while a situation is disabled: default safety reactions and cleanups (R §10, second flaw; T)."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from planner_reactor.link.messages import Adaptation
from planner_reactor.reactor.journal import Journal
from planner_reactor.runtime import Host
from tests.reactor.disks import TornDisk
from tests.reactor.driving import Bench, change

ROVER = Adaptation(
    id=1,
    definitions="""
    P[0] = SeeChasm :; ASSERT[avoid]
    P[1] = SIT[avoid]<k> :; (~(Swerve : SUCCEED[avoid, k]) : FAIL[avoid, k])
    P[2] = DISABLED[avoid] :; ASSERT[stand]
    P[3] = SIT[stand]<k> :; (~(Brake : SUCCEED[stand, k]) : FAIL[stand, k])
    P[4] = (DISABLED[avoid] : WAIT[avoid]) :; (ASSERT[fold] ; ENABLED[avoid])
    P[5] = SIT[fold]<k> :; (~(FoldArm : SUCCEED[fold, k]) : FAIL[fold, k])
    P[6] = ASSUMONITOR[Map, 1000]
    P[7] = HOLDMONITOR[Map, 1000]
    """,
    changes=(change("avoid", 0, "Map"), change("stand"), change("fold")),
    adds=(7, 6, 5, 4, 3, 2, 1, 0),
)
"""A rover that swerves before a chasm, by its map. Without one it stands still; and it folds its arm, once."""

class Rover:
    """The world: what was done when, and whether the map is right."""

    def __init__(self, *, journal: Journal | None = None) -> None:
        self.did: list[tuple[float, str]] = []
        self.map_is_right: bool | None = True
        self.bench = Bench(host=self._host(), journal=journal)

    def _host(self) -> Host:
        host = Host("rover")

        def does(name: str, seconds: float) -> None:
            def act() -> Iterator[float]:
                self.did.append((self.bench.scheduler.now, name))
                yield seconds

            host.process(window=(0.0, seconds), name=name)(act)

        for name, seconds in {"SeeChasm": 4.0, "Swerve": 2.0, "Crawl": 3.0, "Brake": 1.0, "FoldArm": 2.5}.items():
            does(name, seconds)
        host.assumption("Map")(lambda: self.map_is_right)
        return host

    def when(self, name: str) -> list[float]:
        return [time for time, what in self.did if what == name]

    def loses_its_map(self, at: float, until: float | None = None) -> None:
        self.bench.scheduler.call_at(at, lambda: setattr(self, "map_is_right", False))
        if until is not None:
            self.bench.scheduler.call_at(until, lambda: setattr(self, "map_is_right", True))


@pytest.fixture
def rover() -> Rover:
    made = Rover()
    made.bench.reactor.receive(ROVER)
    return made


def test_the_reaction_that_remains_acts_as_long_as_the_other_is_disabled(rover: Rover) -> None:
    rover.loses_its_map(7.5, until=20.5)
    rover.bench.run(40.0)
    brakes = rover.when("Brake")
    assert brakes == [8.0 + n for n in range(13)]  # from the monitor's reading at 8 s to that at 21 s
    assert [time for time in rover.when("Swerve") if 8.0 < time < 21.0] == []
    assert max(rover.when("Swerve")) > 21.0
    assert rover.bench.reactor.laws.violations == []


def test_a_cleanup_runs_once_when_what_is_in_service_has_ended(rover: Rover) -> None:
    rover.loses_its_map(4.5, until=30.5)  # it swerves from 4 to 6 s
    rover.bench.run(60.0)
    assert rover.when("FoldArm") == [6.0]
    assert rover.when("Brake")[0] == 5.0
    assert rover.bench.reactor.laws.violations == []


def test_both_are_reactions_like_any_other_and_an_adaptation_takes_them_away(rover: Rover) -> None:
    by_sight = Adaptation(
        id=2,
        definitions="P[8] = SIT[avoid]<k> :; (~(Crawl : SUCCEED[avoid, k]) : FAIL[avoid, k])",
        changes=(change("avoid", 1),),
        removed=("stand", "fold"),
        kills=(1, 2, 3, 4, 5, 6, 7),
        adds=(8,),
    )
    rover.loses_its_map(7.5)
    rover.bench.at(12.3, by_sight)
    rover.bench.run(30.0)
    (applied,) = rover.bench.times("adaptation_applied", id=2)
    assert applied <= 13.0 + 1e-9  # it waits for the brake in service, and for nothing else
    assert max(rover.when("Brake")) < applied
    assert min(rover.when("Crawl")) >= applied
    assert rover.bench.reactor.laws.violations == []


def test_a_safety_reaction_is_committed_and_acts_again_after_a_crash() -> None:
    disk = TornDisk()
    rover = Rover(journal=Journal(disk))
    rover.bench.reactor.receive(ROVER)
    rover.loses_its_map(7.5)
    rover.bench.run(10.2)
    again = Rover(journal=Journal(disk))
    again.map_is_right = False
    again.bench.run(3.0)
    assert again.when("Brake")[:2] == [0.0, 1.0]
    assert again.when("Swerve") == []
    assert again.bench.reactor.laws.violations == []


def test_law_14_sees_a_safety_reaction_that_does_not_begin(rover: Rover) -> None:
    rover.bench.reactor.situations.flipped = lambda name: None
    rover.loses_its_map(7.5)
    rover.bench.run(12.0)
    assert {v.law for v in rover.bench.reactor.laws.violations} == {14}
