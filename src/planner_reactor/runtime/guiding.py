"""An executer whose free choices are made by somebody else: which strand has the next turn, who comes first at a port,
which of those that wait for this instant is told first, how long a `Term` lasts, what `Ran` draws.
Left alone the executer takes all of these in one order (first come, first served) or at random; the semantics leaves
them open. A guided run can follow any run that the semantics allows, a counterexample above all.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Sequence
from heapq import heappop
from typing import Any

from planner_reactor.runtime.clock import VirtualClock
from planner_reactor.runtime.executer import Executer
from planner_reactor.runtime.kernel import Kernel
from planner_reactor.runtime.ports import In, Out
from planner_reactor.runtime.scheduler import Scheduler
from planner_reactor.runtime.strands import OVER, READY, WOKEN, Instruction, Strand

Choose = Callable[[Sequence[str]], int]
"""Which of these? They are told by the names of the leaves that would act (`IN p` for a port), or, if it is asked who
comes first at a port, by what they write (`!3`)."""

Draw = Callable[[str, float, float], float]
"""A number for a leaf of this name, between the two."""


class GuidedScheduler(Scheduler):
    """Time as in any run, but what waits for one instant is told in the order that `choose` says."""

    __slots__ = ("choose", "draw")

    def __init__(self, choose: Choose, draw: Draw) -> None:
        super().__init__(VirtualClock())
        self.choose = choose
        self.draw = draw

    def random(self, stream: str) -> Any:
        return _Drawn(stream, self.draw)

    @property
    def due(self) -> list[str]:
        """What waits for the present instant, by name (a basic process has none here)."""
        if self._instants and self._instants[0] <= self.now:
            self._gather()
        self._present = [entry for entry in self._present if entry[0].awaits(entry)]
        return [_name_of(entry[1]) for entry in self._present]

    def fire(self, number: int) -> None:
        """Tell one of those that wait for this instant."""
        entry = self._present.pop(number)
        entry[0].elapsed(entry)

    def _run_jumping(self, limit: float) -> None:
        """As in any run, but for the choice among `present`: entries due at this instant are gathered as they come."""
        while not self._stopped:
            if self._soon:
                self._soon.popleft()()
            elif due := self.due:
                self.fire(self.choose(due) if len(due) > 1 else 0)
            elif self._instants and self._instants[0] <= limit:
                self.now = self._instants[0]
                self._gather()
            else:
                return

    def _gather(self) -> None:
        """What waits for the present instant stands side by side, to be chosen from."""
        bucket = self._buckets.pop(heappop(self._instants))
        self._present += bucket if isinstance(bucket, list) else [bucket]


class _Drawn:
    def __init__(self, stream: str, draw: Draw) -> None:
        self._stream = stream
        self._draw = draw

    def uniform(self, low: float, high: float) -> float:
        return self._draw(self._stream, low, high)


class _Ready(deque[Strand]):
    """The strands that are ready; the next to have its turn is chosen, or first one that waits for this instant."""

    def __init__(self, kernel: Kernel, scheduler: GuidedScheduler, waiting: deque[Strand]) -> None:
        super().__init__(waiting)
        self._kernel = kernel
        self._scheduler = scheduler

    def popleft(self) -> Strand:
        while True:
            for strand in [s for s in self if s.state not in (READY, WOKEN)]:
                self.remove(strand)  # it was aborted meanwhile
            offered = [*map(_name_of, self), *self._scheduler.due]
            if not offered:
                return self._nobody()
            number = self._scheduler.choose(offered) if len(offered) > 1 else 0
            if number < len(self):
                strand = self[number]
                del self[number]
                self._choose_partner(strand)
                return strand
            self._scheduler.fire(number - len(self))
            if self._kernel.due:
                self._kernel.settle()

    def _choose_partner(self, strand: Strand) -> None:
        """At a port where several wait for this strand, which comes first is chosen too."""
        leaf = strand.pc
        if not isinstance(leaf, In | Out) or (port := leaf.port_of(strand)) is None:
            return
        waiting = list(port.waiting()) if port.writers == isinstance(leaf, In) else []
        if len(waiting) > 1:
            chosen = waiting[self._scheduler.choose([f"!{other.value}" for other in waiting])]
            for other in (chosen, *(w for w in waiting if w is not chosen)):
                port.unlink(other)
                port.append(other)

    def _nobody(self) -> Strand:
        """One that has no turn: what was ready is no more."""
        strand = Strand.__new__(Strand)
        strand.state, strand.guard = OVER, None
        return strand


def guide(executer: Executer, scheduler: GuidedScheduler) -> None:
    """From now on the executer asks `scheduler.choose`; its budget `slice` must be 1, so that a turn is a step."""
    kernel: Any = executer._kernel
    kernel.ready = _Ready(kernel, scheduler, kernel.ready)

    def resume(strand: Strand, pc: Instruction) -> None:
        strand.link = None
        kernel.queue(strand, pc)
        kernel.arm()

    kernel.run = kernel.advance  # who has waited for time goes to its next leaf, and has its turn when it is chosen
    kernel.resume = resume


def _name_of(subject: object) -> str:
    leaf = getattr(subject, "pc", None)
    if isinstance(leaf, In | Out) and isinstance(subject, Strand) and (port := leaf.port_of(subject)) is not None:
        return f"{'IN' if isinstance(leaf, In) else 'OUT'} {port.name}"
    setting = getattr(leaf, "setting", None)
    return str(getattr(setting, "name", getattr(leaf, "name", "")))

