"""What a host's processes wait for: signals, and time.

In a generator: `value = yield signal`, `fired = yield signal.within(seconds)`, `yield seconds`. In a coroutine the
same with `await signal`, `await signal.within(seconds)`, `await sleep(seconds)`. A signal is a moment, not a state:
`fire` wakes those who wait at that moment, in the order in which they came, and is forgotten.
"""

from __future__ import annotations

from collections.abc import Generator
from dataclasses import dataclass
from typing import Any, Protocol

import msgspec


class Aborted(Exception):  # an outcome of a process, not an error
    """Raised by a host's process to abort: an outcome like any other. The text goes to the trace."""


class Waiter(Protocol):
    """What waits for a signal."""

    def fired(self, value: object) -> None: ...


class Signal:
    """Something that happens now and then. Fire it from the scheduler's thread only (others: `Scheduler.post`)."""

    __slots__ = ("_waiters", "name")

    def __init__(self, name: str = "") -> None:
        self.name = name
        self._waiters: dict[Waiter, None] = {}

    def __repr__(self) -> str:
        return f"Signal({self.name!r})"

    def fire(self, value: object = None) -> None:
        """Wake all who wait, in order; each gets the value."""
        waiters, self._waiters = self._waiters, {}
        for waiter in waiters:
            waiter.fired(value)

    def within(self, seconds: float) -> Within:
        """Wait for this signal, but no longer than so many seconds: True if it was fired."""
        return Within(self, seconds)

    def add(self, waiter: Waiter) -> None:
        self._waiters[waiter] = None

    def remove(self, waiter: Waiter) -> None:
        self._waiters.pop(waiter, None)

    @property
    def waiting(self) -> int:
        return len(self._waiters)

    def __await__(self) -> Generator[Signal, Any, Any]:
        return (yield self)


class Within(msgspec.Struct, frozen=True):
    """Waiting for a signal with a limit of seconds."""

    signal: Signal
    seconds: float

    def __await__(self) -> Generator[Within, bool, bool]:
        return (yield self)


@dataclass(frozen=True, slots=True)
class sleep:  # used like a function: await sleep(3.0)
    """Waiting for so many seconds."""

    seconds: float

    def __await__(self) -> Generator[float, None, None]:
        yield self.seconds
