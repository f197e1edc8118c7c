"""The executer: RS programs run here, on a virtual clock or on the wall clock (R §9.1, RS-L3).

Where to look: `clock` and `scheduler` own time, order, randomness and what comes in from other threads; `signals` and
`host` are what a host module is written with; `compiler` turns terms into linked `instructions` and `leaves`; `kernel`
runs strands through them; `executer` is the face of it all. Nothing here knows situations or the planner: the reactor
plugs its processes in as `Control`s (see `outcomes`).
"""

from __future__ import annotations

from planner_reactor.runtime.budgets import Budgets
from planner_reactor.runtime.clock import Clock, VirtualClock, WallClock
from planner_reactor.runtime.definitions import Clause
from planner_reactor.runtime.executer import Executer, Statistics
from planner_reactor.runtime.host import Host, Watchdog, World
from planner_reactor.runtime.outcomes import Control, Label, Outcome
from planner_reactor.runtime.scheduler import Scheduler, Timer
from planner_reactor.runtime.sensing import Caution, Reading
from planner_reactor.runtime.signals import Aborted, Signal, sleep
from planner_reactor.runtime.strands import Body, Root, Strand

__all__ = [
    "Aborted",
    "Body",
    "Budgets",
    "Caution",
    "Clause",
    "Clock",
    "Control",
    "Executer",
    "Host",
    "Label",
    "Outcome",
    "Reading",
    "Root",
    "Scheduler",
    "Signal",
    "Statistics",
    "Strand",
    "Timer",
    "VirtualClock",
    "WallClock",
    "Watchdog",
    "World",
    "sleep",
]
