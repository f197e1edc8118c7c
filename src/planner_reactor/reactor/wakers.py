"""What the reactor's built-in processes ask of the executer, and the executer behind it."""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol

from planner_reactor.rs.terms import Value
from planner_reactor.runtime import Body, Executer, Outcome, Strand


class Waker(Protocol):
    """Ends and wakes strands that wait in a control."""

    def ended(self, strand: Strand, ok: bool, values: tuple[Value, ...], cause: str) -> None:
        """The process that this strand waits in ends, inside the present step."""

    def wake(self, strand: Strand) -> None:
        """The process that this strand waits in may try again, as a step of its own."""

    def cut(self, body: Body, cause: str) -> None:
        """A body in service aborts, inside the present step."""

    def resting(self, strand: Strand) -> bool:
        """Is nothing below this part of a guarded reaction in service?"""

    def watch(self, label: Value, told: Callable[[], object] | None) -> None:
        """Tell when something below this guard may have come to rest; None: no longer."""


class ExecuterWaker:
    """The waker that an executer is. `executer` is set once both exist; `ended_wait` hears of every end."""

    executer: Executer

    def __init__(self) -> None:
        self.ended_wait: Callable[[Strand], None] = lambda strand: None

    def ended(self, strand: Strand, ok: bool, values: tuple[Value, ...], cause: str) -> None:
        self.ended_wait(strand)
        self.executer.end(strand, Outcome(ok, values, cause))

    def wake(self, strand: Strand) -> None:
        self.executer.wake(strand)

    def cut(self, body: Body, cause: str) -> None:
        self.executer.cut(body, cause)

    def resting(self, strand: Strand) -> bool:
        return self.executer.resting(strand)

    def watch(self, label: Value, told: Callable[[], object] | None) -> None:
        if told is None:
            self.executer.unwatch(label)
        else:
            self.executer.watch(label, told)
