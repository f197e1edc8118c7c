"""One process hangs, one raises, one takes no time: each fails within its limit, and nobody else is a moment late."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator

from planner_reactor.rs.parser import parse_process, parse_program
from planner_reactor.runtime import Budgets, Executer, Host, Scheduler, Signal, VirtualClock
from planner_reactor.trace import Trace

MANY = 1_000
HANGS, RAISES, SPINS = 417, 512, 613

PROGRAM = """
Feed[n]  = GTR[n, 0] : OUT[make, n - 1] : Feed[n - 1]
Reactions = IN[make]<i> :: (Delay[1] :; Act[i])
"""


def test_one_that_hangs_and_one_that_raises_among_a_thousand() -> None:
    never, acted, abandoned = Signal(), defaultdict[int, list[float]](list), list[float]()
    scheduler = Scheduler(VirtualClock())
    trace = Trace(lambda: scheduler.now)
    host = Host("isolation")

    @host.process(limit=2.0, abandon=lambda index: abandoned.append(index))
    def Act(index: float) -> Iterator[Signal]:
        if index == HANGS:
            yield never
        if index == RAISES:
            raise ZeroDivisionError("as it happens")
        if index == SPINS:
            while True:
                yield 0  # type: ignore[misc]  # waits for no time at all, for ever
        acted[int(index)].append(scheduler.now)

    budgets = Budgets(turns=10_000)
    executer = Executer(parse_program(PROGRAM), scheduler=scheduler, host=host, trace=trace, budgets=budgets)
    executer.start_process(parse_process(f"Reactions | Feed[{MANY}]"))
    calm = [n for n in range(MANY) if n not in (HANGS, RAISES, SPINS)]
    _observe(executer, trace, acted, abandoned, calm)


def _observe(
    executer: Executer, trace: Trace, acted: dict[int, list[float]], abandoned: list[float], calm: list[int]
) -> None:
    executer.run(10.5)
    on_time = [float(t) for t in range(1, 11)]
    assert [n for n in calm if acted[n] != on_time] == []
    assert [e.time for e in trace.of("error")] == on_time  # the one that raises, each time at once
    limits = [round(e.time, 6) for e in trace.of("limit")]
    assert limits.count(3.0) >= 1
    assert set(limits) <= {3.0, 6.0, 9.0}  # what hangs is given up after two seconds, and begins again a second later
    assert HANGS in abandoned
    assert [e.time for e in trace.of("zeno")] == on_time  # what waits for no time, for ever, uses up its turns
    assert SPINS in abandoned
