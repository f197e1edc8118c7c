"""One run: when it ends, and what it is charged."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from planner_reactor.experiments.loop import Loop
from planner_reactor.logic.reader import read_domain
from planner_reactor.planner import Planner
from planner_reactor.runtime import Host, Scheduler
from planner_reactor.trace import Trace

DOMAIN = """
atp_goal Rest forall h: Hour(h) => Quiet(h);
atp_actionschema Await <><h>
intervals i1;
    effects: Hour(h) @ i1 and ITL(Await, meets, i1);
endactionschema
atp_actionschema Rested <h><>
intervals i1;
    effects: Quiet(h) @ i1 and ITL(Rested, meets, i1);
endactionschema
"""


class Silent:
    """A world that is finished after five seconds, and tells nobody."""

    faults: Mapping[str, Mapping[str, Any]] = {}

    def __init__(self) -> None:
        self.ticks = 0

    def start(self, scheduler: Scheduler) -> None:
        def tick() -> None:
            self.ticks += 1
            scheduler.call_after(1.0, tick)

        scheduler.call_after(1.0, tick)

    def ledger(self) -> Mapping[str, int]:
        return {}

    def balanced(self) -> bool:
        return True

    def finished(self) -> bool:
        return self.ticks >= 5

    def report(self) -> Mapping[str, object]:
        return {}

    def strike(self, kind: str, **parameters: Any) -> bool:
        return False


def quiet(scheduler: Scheduler, trace: Trace) -> Host:
    host = Host("quiet")
    host.world = Silent()

    @host.process(results=("h",), window=(0.0, 10_000.0))
    def Await() -> Any:
        yield 9_000.0
        return "h1"

    @host.process(window=(0.0, 0.0))
    def Rested(h: str) -> None: ...

    return host


def test_a_run_ends_when_its_world_is_finished_though_nothing_is_traced() -> None:
    loop = Loop(Planner(read_domain(DOMAIN)), quiet)
    loop.run(until=10_000.0)
    assert loop.scheduler.now < 7.0
