"""The same core on the wall clock: programs run in real time, and what waits costs nothing."""

from __future__ import annotations

import threading
import time

from planner_reactor.rs.parser import parse_process, parse_program
from planner_reactor.runtime import Budgets, Executer, Host, Scheduler, Signal, WallClock


def test_a_program_runs_in_real_time() -> None:
    executer = Executer(parse_program(""), scheduler=Scheduler(WallClock()))
    root = executer.start_process(parse_process("Delay[0.02] ; Delay[0.02]"))
    begun = time.monotonic()
    executer.run(until=5)
    assert root.outcome == "stop"
    assert 0.035 <= time.monotonic() - begun < 3.0


def test_a_sensor_thread_posts_a_signal() -> None:
    host, bell, scheduler = Host("h"), Signal("bell"), Scheduler(WallClock())

    @host.process(results=("x",), limit=5)
    async def Hear() -> object:
        return await bell

    executer = Executer(parse_program(""), scheduler=scheduler, host=host)
    root = executer.start_process(parse_process("Hear<x>"))
    threading.Timer(0.02, lambda: scheduler.post(lambda: bell.fire(3))).start()
    executer.run(until=5)
    assert root.results == {"x": 3}


def test_ten_thousand_waiting_reactions_take_no_steps() -> None:
    executer = Executer(
        parse_program("All[n] = if GTR[n,0] then ((IN[n]<x> :; STOP) | All[n-1]) else NIL"),
        scheduler=Scheduler(WallClock()),
        budgets=Budgets(turns=10**6),
    )
    executer.start_process(parse_process("All[10000]"))
    executer.run(until=0.0)
    steps = executer.statistics().steps
    executer.run(until=executer.scheduler.clock.read() + 0.1)
    assert executer.statistics().steps == steps
    assert executer.statistics().processes_live > 20_000
