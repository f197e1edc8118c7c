"""A loop that is held up comes late to everything: what is bounded is refused, not applied late, and nothing is broken.

The clock is one that tests let go on: it stands while the reactor works, but where a process says that it took long.
"""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from planner_reactor.link.messages import Adaptation, Change
from planner_reactor.reactor.reactor import Reactor
from planner_reactor.runtime import Host, Scheduler
from planner_reactor.trace import Trace


class HeldUpClock:
    """A clock of the kind that waits, without the waiting: what holds up the loop adds to `held`."""

    jumps = False

    def __init__(self) -> None:
        self.held = 0.0

    def read(self) -> float:
        return self.held

    def reach(self, when: float) -> None:
        self.held = max(self.held, when)

    def interrupt(self) -> None:
        """Nothing waits on this clock."""


class Late:
    """A reactor of several situations, and a process that holds up the loop for some seconds."""

    def __init__(self, count: int) -> None:
        self.clock = HeldUpClock()
        self.scheduler = Scheduler(self.clock)
        self.trace = Trace(lambda: self.scheduler.now)
        host = Host("late")

        @host.process(window=(0.0, 1.0))
        def Work() -> Iterator[float]:
            yield 1.0

        self.reactor = Reactor(self.scheduler, host=host, trace=self.trace)
        self.reactor.start()
        for number in range(count):
            self.reactor.receive(self.adaptation(number, number + 1, 0))
        self.scheduler.run(0.5)

    def adaptation(self, which: int, number: int, base: int, deadline: float | None = None) -> Adaptation:
        label, before = 10 * number, 10 * (which + 1)
        served = f"P[{label}] = SIT[s{which}]<k> :; (Work : SUCCEED[s{which}, k])"
        root = f"P[{label + 1}] = Delay[1] :; ASSERT[s{which}]"
        return Adaptation(
            id=number,
            definitions=served if base else f"{served}\n{root}",
            changes=(Change(situation=f"s{which}", base=base, fresh=not base),),
            kills=(before,) if base else (),
            adds=(label,) if base else (label, label + 1),
            deadline=deadline,
        )

    def hold_up(self, seconds: float) -> None:
        self.clock.held += seconds

    def outcomes(self) -> dict[str, str]:
        return {p.subject: p.kind for p in self.reactor.perceptions.take() if p.kind != "guard_kill"}


@pytest.mark.parametrize("held", [0.0, 0.9, 1.1, 5.0])
def test_adaptations_that_came_together_before_the_loop_was_held_up_are_in_time_or_refused(held: float) -> None:
    late = Late(8)
    late.outcomes()
    for which in range(8):
        late.scheduler.post(lambda n=which: late.reactor.receive(late.adaptation(n, 9 + n, 1, deadline=1.0)))
    late.scheduler.soon(lambda: late.hold_up(held))
    late.scheduler.run(20.0)
    expected = "adaptation_applied" if held < 1.0 else "adaptation_timed_out"
    assert late.outcomes() == {str(9 + n): expected for n in range(8)}
    assert late.reactor.laws.violations == []


@pytest.mark.parametrize("at", [0.7, 1.2, 1.7, 2.2])
@pytest.mark.parametrize("held", [0.5, 1.5, 3.0])
def test_whenever_the_loop_is_held_up_adaptations_that_drain_are_in_time_or_refused(at: float, held: float) -> None:
    late = Late(5)
    late.outcomes()
    for which in range(5):
        deadline = 0.4 + 0.3 * which
        late.scheduler.call_at(
            1.1 + 0.05 * which,
            lambda n=which, d=deadline: late.reactor.receive(late.adaptation(n, 6 + n, 1, deadline=d)),
        )
    late.scheduler.call_at(at, lambda: late.hold_up(held))
    late.scheduler.run(20.0)
    assert set(late.outcomes()) == {str(6 + n) for n in range(5)}
    assert late.reactor.laws.violations == []
    for applied in late.trace.of("adaptation_applied"):
        if (number := applied.data["id"]) > 5:
            received = next(e.time for e in late.trace.of("adaptation_received") if e.data["id"] == number)
            assert applied.time <= received + 0.4 + 0.3 * (number - 6) + 1e-6
