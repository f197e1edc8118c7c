"""The executer's own figures: steps, rendezvous, delays, reactions, what waits, what is aborted.

A *process step* is a test, a basic process that does nothing, or a tail call; a round of `P` below is three. Reactions
are bodies of a `::`, as a reactor has them, so that their code is shared and what is measured is their state.
"""

from __future__ import annotations

import gc
import random
import time
import tracemalloc
from collections.abc import Iterator

from measuring import percentiles, timed

from planner_reactor.rs.parser import parse_process, parse_program
from planner_reactor.runtime import Budgets, Executer, Host, Label, Scheduler, Signal, VirtualClock, WallClock

UNBOUNDED = Budgets(turns=10**12)
FIFO = Budgets(turns=10**12, slice=1)

STEPS = "P[n] = GTR[n, 0] : Nop : P[n - 1]"
MEETINGS = """
Write     = OUT[p, 1] :; STOP
Read      = IN[p]<x> :; STOP
Serve     = IN[p]<x> :; OUT[q, x]
Ask[n]    = OUT[p, n] : IN[q]<x> : GTR[n, 0] : Ask[n - 1]
"""
DELAYS = "Tick[period] = Delay[period] :; STOP"
REACTIONS = """
Feed[n]      = GTR[n, 0] : OUT[make, n - 1] : Feed[n - 1]
AtPorts      = IN[make]<i> :: (IN[i]<x> :; Act)
AtSensors    = IN[make]<i> :: (Sense[i] :; Act)
Sensing[i]   = Sense[i] :; OUT[i, 1]
"""


class Bench:
    """A host with a process that does nothing, and signals that reactions wait for."""

    def __init__(self, count: int = 0) -> None:
        self.host = host = Host("bench")
        self.signals = [Signal() for _ in range(count)]
        self.acted: list[float] = []

        @host.process(window=(0, 0))
        def Nop() -> None: ...

        @host.process(window=(0, 0))
        def Act() -> None:
            self.acted.append(time.perf_counter())

        @host.process(limit=1e9)
        def Sense(index: float) -> Iterator[Signal]:
            yield self.signals[int(index)]

    def executer(
        self, program: str, budgets: Budgets = UNBOUNDED, *, observed: bool = False, wall: bool = False
    ) -> Executer:
        seen: list[Label] = []
        return Executer(
            parse_program(program),
            scheduler=Scheduler(WallClock() if wall else VirtualClock()),
            host=self.host,
            observer=seen.append if observed else None,
            budgets=budgets,
        )


def steps(count: int = 100_000, *, budgets: Budgets = UNBOUNDED, observed: bool = False) -> tuple[float, int]:
    executer = Bench().executer(STEPS, budgets, observed=observed)
    executer.start("P", (count,))
    return timed(executer.run), 3 * count


def steps_in_turns_observed() -> tuple[float, int]:
    """First in first out, a step a turn, with an observer that keeps every label."""
    return steps(budgets=FIFO, observed=True)


def rendezvous(count: int = 100_000) -> tuple[float, int]:
    """Two loops that meet; the budget of turns ends it."""
    executer = Bench().executer(MEETINGS, Budgets(turns=count))
    executer.start_process(parse_process("Read | Write"))
    seconds = timed(lambda: executer.run(0.0))
    return seconds, executer.statistics().rendezvous


def round_trips(count: int = 25_000) -> tuple[float, int]:
    executer = Bench().executer(MEETINGS)
    executer.start_process(parse_process(f"Ask[{count}] # Serve"))
    seconds = timed(executer.run)
    return seconds, executer.statistics().rendezvous // 2


def delays(processes: int, rounds: int) -> tuple[float, int]:
    """Periods of 1 to 7 s, as the peers' processes have them."""
    executer = Bench().executer(DELAYS)
    for index in range(processes):
        executer.start("Tick", (1 + index % 7,))
    executer.run(0.0)
    until = rounds * 7 / sum(1 / (1 + index) for index in range(7))
    seconds = timed(lambda: executer.run(until))
    return seconds, executer.statistics().steps


def waiting(count: int, bench: Bench, *, at: str, wall: bool = False) -> Executer:
    """So many reactions that wait."""
    executer = bench.executer(REACTIONS, wall=wall)
    executer.start_process(parse_process(f"{at} | Feed[{count}]"))
    executer.run(0.0)
    return executer


def reaction_latency(count: int, *, at: str, events: int = 2000) -> tuple[float, float]:
    """(p50, p99) microseconds from a signal of the world to the action of its reaction, among `count` that wait."""
    bench = Bench(count)
    executer = waiting(count, bench, at=at)
    if at == "AtPorts":
        executer.start("Sensing", (count // 2,))
        executer.run(0.0)
    scheduler, draw = executer.scheduler, random.Random(count)
    latencies = []
    gc.collect()
    for _ in range(events):
        signal = bench.signals[count // 2 if at == "AtPorts" else draw.randrange(count)]
        begun = time.perf_counter()
        signal.fire()
        scheduler.run(0.0)
        latencies.append(bench.acted[-1] - begun)
    return percentiles(latencies)


def bytes_waiting(*, at: str, count: int = 10_000) -> float:
    """Bytes for each reaction that waits."""
    bench = Bench(count)
    few, many = bench.executer(REACTIONS), bench.executer(REACTIONS)
    few.start_process(parse_process(f"{at} | Feed[10]"))
    few.run(0.0)
    gc.collect()
    tracemalloc.start()
    many.start_process(parse_process(f"{at} | Feed[{count}]"))
    many.run(0.0)
    gc.collect()
    used, _ = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    return used / count


def idle_cpu(count: int = 10_000, seconds: float = 2.0) -> float:
    """Percent of a core that so many waiting reactions take, on the wall clock."""
    bench = Bench(count)
    executer = waiting(count, bench, at="AtSensors", wall=True)
    begun, used = time.monotonic(), time.process_time()
    executer.run(executer.scheduler.clock.read() + seconds)
    return 100 * (time.process_time() - used) / (time.monotonic() - begun)


def cancelling(count: int = 10_000) -> tuple[float, int]:
    """Reactions aborted together."""
    executer = waiting(count, Bench(count), at="AtPorts")
    (root,) = executer.roots
    executer.kill(root)
    seconds = timed(lambda: executer.run(0.0))
    assert executer.statistics().processes_live == 0
    return seconds, count
