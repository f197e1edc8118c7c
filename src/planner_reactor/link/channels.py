"""Channels between the two sides, in one process.

Adaptations go one way in order; perceptions go the other way numbered 1, 2, … without a gap. A perception that repeats
one not yet taken is not a new message: its count grows (law 10: at least once, in order, gapless, coalesced and
counted). What latency a link has is for whoever drives the channel: nothing here knows time.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable

import msgspec

from planner_reactor.link.messages import Adaptation, Perception, PerceptionKind

COALESCED: frozenset[PerceptionKind] = frozenset(
    {"assumption_failure", "assumption_holds", "situation_failure", "stub_trigger"}
)
"""Kinds of which a repeat says nothing new until the first has been taken."""


class PerceptionChannel:
    """Reactor to planner. `arrived` is called when there is something to take."""

    def __init__(self, arrived: Callable[[], None] = lambda: None) -> None:
        self.arrived = arrived
        self.sent = 0
        self.taken = 0
        self._waiting: dict[int, Perception] = {}
        self._open: dict[tuple[str, str, str], int] = {}

    def report(
        self,
        kind: PerceptionKind,
        subject: str,
        *,
        time: float,
        cause: str = "",
        instance: int | None = None,
        values: tuple[object, ...] = (),
        epoch: int = 0,
    ) -> Perception:
        """Send a perception, or count a repeat of one that waits; the perception as it now stands."""
        key = (kind, subject, cause)
        if kind in COALESCED and (number := self._open.get(key)) is not None:
            repeated = self._waiting[number]
            self._waiting[number] = repeated = msgspec.structs.replace(repeated, count=repeated.count + 1)
            return repeated
        self.sent += 1
        perception = Perception(
            number=self.sent, time=time, kind=kind, subject=subject, cause=cause, instance=instance, values=values,
            epoch=epoch,
        )  # fmt: skip
        self._waiting[self.sent] = perception
        if kind in COALESCED:
            self._open[key] = self.sent
        self.arrived()
        return perception

    def take(self) -> list[Perception]:
        """Everything that waits, in order. From here on repeats are new perceptions."""
        taken = list(self._waiting.values())
        self._waiting.clear()
        self._open.clear()
        self.taken += len(taken)
        return taken

    def __len__(self) -> int:
        return len(self._waiting)


class AdaptationChannel:
    """Planner to reactor, in order."""

    def __init__(self, arrived: Callable[[], None] = lambda: None) -> None:
        self.arrived = arrived
        self.sent = 0
        self._waiting: deque[Adaptation] = deque()

    def send(self, adaptation: Adaptation) -> None:
        self.sent += 1
        self._waiting.append(adaptation)
        self.arrived()

    def take(self) -> Adaptation | None:
        return self._waiting.popleft() if self._waiting else None

    def __len__(self) -> int:
        return len(self._waiting)
