"""A small reactor to test with: a root that asserts `work`, which needs `part` done; processes take pinned times."""

from __future__ import annotations

from collections.abc import Iterator

from planner_reactor.link.channels import PerceptionChannel
from planner_reactor.link.messages import Adaptation, Change, Perception
from planner_reactor.reactor.journal import Journal
from planner_reactor.reactor.reactor import Reactor
from planner_reactor.runtime import Aborted, Budgets, Host, Scheduler, VirtualClock
from planner_reactor.trace import Trace


class Bench:
    """A reactor on a virtual clock, with everything at hand that a test asks about."""

    def __init__(
        self,
        *,
        journal: Journal | None = None,
        host: Host | None = None,
        scheduler: Scheduler | None = None,
        budgets: Budgets | None = None,
    ) -> None:
        self.scheduler = scheduler or Scheduler(VirtualClock(), seed=1)
        self.trace = Trace(lambda: self.scheduler.now)
        self.flags: dict[str, bool | None] = {"A": True, "B": True}
        self.failing: set[str] = set()
        self.abandoned: list[str] = []
        self.host = host or self._host()
        self.reactor = Reactor(
            self.scheduler, host=self.host, perceptions=PerceptionChannel(), trace=self.trace, journal=journal,
            budgets=budgets,
        )  # fmt: skip
        self.reactor.start()

    def _host(self) -> Host:
        host = Host("bench")

        @host.process(window=(0.0, 5.0))
        def Do(what: str, seconds: float) -> Iterator[float]:
            try:
                yield seconds
            except GeneratorExit:
                self.abandoned.append(what)
                raise
            if what in self.failing:
                raise Aborted(f"{what} failed")

        @host.process(window=(0.0, 500.0))
        def Long() -> Iterator[float]:
            yield 400.0

        for name in self.flags:
            host.assumption(name)(lambda name=name: self.flags[name])  # type: ignore[misc]
        return host

    def at(self, time: float, adaptation: Adaptation) -> None:
        self.scheduler.call_at(time, lambda: self.reactor.receive(adaptation))

    def run(self, until: float) -> None:
        self.reactor.executer.run(until=until)

    def times(self, kind: str, **fields: object) -> list[float]:
        return [e.time for e in self.trace.of(kind) if fields.items() <= e.data.items()]

    def perceptions(self) -> list[Perception]:
        return self.reactor.perceptions.take()


def change(situation: str, base: int = 0, *assumptions: str) -> Change:
    return Change(situation=situation, base=base, assumptions=assumptions, fresh=base == 0)


FIRST = Adaptation(
    id=1,
    definitions="""
    P[0] = STOP :; ASSERT[work]
    P[1] = SIT[work]<k> :; (~(REASSERT[part] : SUCCEED[work, k]) : FAIL[work, k])
    P[2] = SIT[part]<k> :; (~(Do[old, 2] : SUCCEED[part, k]) : FAIL[part, k])
    P[3] = ASSUMONITOR[A, 1000]
    """,
    changes=(change("work", 0), change("part", 0, "A")),
    adds=(3, 2, 1, 0),
)

SECOND = Adaptation(
    id=2,
    definitions="P[4] = SIT[part]<k> :; (~(Do[new, 1] : SUCCEED[part, k]) : FAIL[part, k])",
    changes=(change("part", 1),),
    kills=(2, 3),
    adds=(4,),
)
