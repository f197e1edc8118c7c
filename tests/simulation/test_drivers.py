"""What a reactor sees of a host that outlives it is all that the host has, and what it commands is accounted for."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator

from planner_reactor.runtime import Host
from planner_reactor.simulation.drivers import Drivers
from planner_reactor.simulation.workshop import Dog

COPIED = {"processes", "functions", "assumptions", "cautions", "world", "watchdog", "name", "ports"}


def base(taken_back: list[str]) -> Host:
    host = Host("bench")

    @host.process(window=(0.0, 5.0), abandon=lambda what: taken_back.append(what))
    def Do(what: str) -> Iterator[float]:
        yield 3.0

    host.watchdog = Dog()
    return host


def test_everything_that_a_host_has_is_there() -> None:
    host = base([])
    seen = Drivers(host, Counter()).host
    assert {name for name in vars(host) if not name.startswith("_")} == COPIED
    for name in COPIED - {"processes"}:
        assert getattr(seen, name) is getattr(host, name)
    assert seen.processes.keys() == host.processes.keys()


def test_when_the_process_is_gone_what_it_commanded_is_taken_back_once() -> None:
    taken_back: list[str] = []
    drivers = Drivers(base(taken_back), Counter())
    commands = [drivers.host.processes["Do"].routine(name) for name in "ab"]
    next(commands[0])  # the other has not begun
    assert drivers.close() == 2
    assert taken_back == ["a", "b"]
    assert drivers.close() == 0
    assert drivers.counts["sent"] == drivers.counts["abandoned"] == 2


def test_what_lives_longer_than_its_limit_is_seen() -> None:
    now = [0.0]
    drivers = Drivers(base([]), Counter(), lambda: now[0])
    command = drivers.host.processes["Do"].routine("a")
    next(command)
    now[0] = 5.1
    assert next(command, None) is None
    assert drivers.counts["overdue"] == 1
