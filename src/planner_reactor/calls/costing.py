"""What a step of the executer costs on this machine, in seconds of the processor: what `scheduling` is asked with."""

from __future__ import annotations

from time import process_time

from planner_reactor.rs.parser import parse_program
from planner_reactor.runtime import Executer, Scheduler, VirtualClock

PROBE = """Track = IN[s]<v> :; OUT[m, v]
Sensor[n] = (OUT[s, n] ; Delay[0.01]) ; Sensor[n + 1]
Motor = (IN[m]<v> : Delay[0.005]) :; STOP
Probe = Sensor[0] | Track | Motor
"""
"""A servo reaction between a sensor and a motor: what derived reactions are like."""

SECONDS = 200.0
"""Of virtual time: some hundred thousand steps."""


def cost_per_step() -> float:
    """Seconds of the processor for a step of a servo reaction, the middle of three measurements."""
    return sorted(_measured() for _ in range(3))[1]


def _measured() -> float:
    scheduler = Scheduler(VirtualClock(), seed=0)
    executer = Executer(parse_program(PROBE), scheduler=scheduler)
    executer.start("Probe")
    begun = process_time()
    executer.run(until=SECONDS)
    return (process_time() - begun) / max(1, executer.statistics().steps)
