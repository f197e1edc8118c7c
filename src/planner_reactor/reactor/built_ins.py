"""All of the reactor's built-in processes over one store of situations, ready for an executer.

    built_in = BuiltIns(scheduler, assumptions)
    executer = Executer(program, scheduler=scheduler, controls=built_in.controls, on_end=…)
    built_in.attach(executer)
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from planner_reactor.reactor.controls import Controls, commits
from planner_reactor.reactor.guards import Guards
from planner_reactor.reactor.holding import Holding
from planner_reactor.reactor.monitors import Monitors
from planner_reactor.reactor.situations import Situations
from planner_reactor.reactor.wakers import ExecuterWaker
from planner_reactor.rs.terms import Value
from planner_reactor.runtime import Control, Executer, Scheduler
from planner_reactor.runtime.sensing import Sensed


def _unheard(*_: Any, **__: Any) -> None:
    """Nobody listens."""


class BuiltIns:
    """The store and its controls. Whoever owns the executer must pass each ended root to `situations.root_ended`."""

    def __init__(
        self,
        scheduler: Scheduler,
        assumptions: Mapping[str, Callable[[], Sensed]] | None = None,
        *,
        notice: Callable[..., None] = _unheard,
        read: Callable[..., None] = _unheard,
        reached: Callable[[str, int | None], None] = _unheard,
        told: Callable[[str, tuple[Value, ...]], None] = _unheard,
        commit: Callable[[int], bool] = lambda number: True,
        by_itself: Callable[[Value], None] = _unheard,
    ) -> None:
        self._waker = ExecuterWaker()
        self.situations = Situations(self._waker, notice)
        self.guards = Guards(self.situations, self._waker, notice, by_itself)
        situation_processes = self._processes = Controls(self.situations)
        self._waker.ended_wait = situation_processes.granted
        monitors = Monitors(scheduler, assumptions or {}, read, reached, told)
        holding = Holding(self.situations, situation_processes.sit, self._waker)
        self.controls: tuple[Control, ...] = (
            *situation_processes, *self.guards, *monitors, *holding, commits(commit)
        )  # fmt: skip

    def attach(self, executer: Executer) -> None:
        self._waker.executer = executer
        self._processes.functions = executer.functions
