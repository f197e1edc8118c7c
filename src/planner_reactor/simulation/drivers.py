"""What one reactor sees of a host that outlives it: the same processes, with a ledger of commands (law 11).

When the reactor's process ends, its drivers see the connection go, and abandon what was begun on its behalf: sent =
done + failed + abandoned + live, nothing is abandoned twice, and nothing lives longer than the limit of its process.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Generator
from functools import partial
from types import GeneratorType
from typing import Any

from msgspec.structs import replace

from planner_reactor.runtime import Host
from planner_reactor.runtime.host import BasicProcess

LATE = 1e-3
"""Seconds by which a command may be late: rounding."""


class Drivers:
    """One incarnation's view of `base`: `host` is what its reactor is given."""

    def __init__(self, base: Host, counts: Counter[str], now: Callable[[], float] = lambda: 0.0) -> None:
        self.counts = counts
        self._now = now
        self.live: dict[int, Generator[Any, Any, Any]] = {}
        self._takes_back: dict[int, Callable[[], object]] = {}
        self.closed = 0  # abandoned because the process was gone
        self._sent = 0
        self.host = Host(base.name)
        self.host.functions = base.functions
        self.host.assumptions = base.assumptions
        self.host.cautions = base.cautions
        self.host.world = base.world
        self.host.watchdog = base.watchdog
        self.host.ports = base.ports
        for name, process in base.processes.items():
            self.host.processes[name] = replace(process, routine=partial(self._run, process))

    def _run(self, process: BasicProcess, *arguments: Any) -> Any:
        self.counts["sent"] += 1
        try:
            begun = process.routine(*arguments)
        except Exception:
            self.counts["failed"] += 1
            raise
        if not isinstance(begun, GeneratorType):
            self.counts["done"] += 1
            return begun
        self._sent += 1
        number = self._sent
        self.live[number] = driven = self._drive(number, begun, self._now() + process.limit + LATE)
        if process.abandon is not None:
            self._takes_back[number] = partial(process.abandon, *arguments)
        return driven

    def _drive(self, number: int, begun: Generator[Any, Any, Any], due: float) -> Generator[Any, Any, Any]:
        outcome = "abandoned"
        try:
            result = yield from begun
            outcome = "done"
            return result
        except GeneratorExit:
            raise
        except BaseException:
            outcome = "failed"
            raise
        finally:
            del self.live[number]
            self._takes_back.pop(number, None)
            self.counts[outcome] += 1
            self.counts["overdue"] += self._now() > due

    def close(self) -> int:
        """The process is gone: everything it commanded is abandoned; how much that was."""
        running, taken_back = dict(self.live), dict(self._takes_back)
        for number, command in running.items():
            command.close()
            taken_back.get(number, lambda: None)()
            if self.live.pop(number, None) is not None:  # it had not begun
                self.counts["abandoned"] += 1
        self.closed += len(running)
        return len(running)
