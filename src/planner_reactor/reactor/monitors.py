"""What the reactor notices by itself: stubs that are reached, assumptions that fail or hold again (R §7.3, §8.3).

ASSUMONITOR[a,ms] asks once a period and reports as long as a does not hold; HOLDMONITOR[a,ms] is its mirror for an
assumption that was given up and may be reinstated. Some assumptions have no polled monitor: a process that notices
says so through the host. "Unknown" (None) is neither: nothing is reported.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping

from planner_reactor.reactor.controls import ERROR, STOPPED, BuiltIn, owner_of
from planner_reactor.rs.terms import Value
from planner_reactor.runtime import Outcome, Scheduler, Strand, Timer
from planner_reactor.runtime.sensing import Sensed


class Monitors:
    """STUB, ASSUMONITOR, HOLDMONITOR and REPORT. `read(a, reading, returns=…)` is given every reading.

    Only what a HOLDMONITOR reads `returns`: says that a failed assumption holds again.
    """

    def __init__(
        self,
        scheduler: Scheduler,
        sensed: Mapping[str, Callable[[], Sensed]],
        read: Callable[..., None],
        reached: Callable[[str, int | None], None],
        told: Callable[[str, tuple[Value, ...]], None],
    ) -> None:
        self._scheduler = scheduler
        self._sensed = sensed
        self._read = read
        self._reached = reached
        self._told = told
        self._timers: dict[Strand, Timer] = {}

    def __iter__(self) -> Iterator[BuiltIn]:
        yield BuiltIn("STUB", self._stub)
        yield BuiltIn("REPORT", self._report)
        yield BuiltIn("ASSUMONITOR", self._monitor(reports=False), self._left, resting=True)
        yield BuiltIn("HOLDMONITOR", self._monitor(reports=True), self._left, resting=True)

    def _stub(self, strand: Strand, arguments: tuple[Value, ...]) -> Outcome:
        instance = owner_of(strand)
        if instance is not None:
            instance.stub = True
        self._reached(str(arguments[0]), None if instance is None else instance.number)
        return STOPPED

    def _report(self, strand: Strand, arguments: tuple[Value, ...]) -> Outcome:
        self._told(str(arguments[0]), arguments[1:])
        return STOPPED

    def _monitor(self, *, reports: bool) -> Callable[[Strand, tuple[Value, ...]], Outcome | None]:
        """A monitor that reports while its assumption's truth is `reports`; the other reading only counts."""

        def begin(strand: Strand, arguments: tuple[Value, ...]) -> Outcome | None:
            assumption, period = str(arguments[0]), arguments[1]
            if isinstance(period, bool) or not isinstance(period, int | float) or period <= 0:
                return ERROR
            sense = self._sensed.get(assumption, lambda: None)

            def check() -> None:
                self._timers[strand] = self._scheduler.call_after(period / 1000, check)
                self._read(assumption, sense(), returns=reports, fails=not reports)

            # A step may not change the world it belongs to: the first reading is an event of its own. What may come
            # back is read after a period at the earliest: so one that flaps comes back once a period at most.
            self._timers[strand] = self._scheduler.call_after(period / 1000 if reports else 0.0, check)
            return None

        return begin

    def _left(self, strand: Strand) -> None:
        self._timers.pop(strand).cancel()
