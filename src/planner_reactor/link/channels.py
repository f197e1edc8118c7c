"""Channels between the two sides, in one process.

Adaptations go one way in order; perceptions go the other way numbered 1, 2, … without a gap. A perception that repeats
one not yet taken is not a new message: its count grows (law 10: at least once, in order, gapless, coalesced and
counted). If something else was said of its subject meanwhile it is heard after that: what was said last of an
assumption is heard last, however often it failed and held again before anybody listened. What latency a link has is for
whoever drives the channel: nothing here knows time.
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

Key = tuple[str, str, str]
"""Kind, subject, and cause; of what is not coalesced a number of its own."""


class PerceptionChannel:
    """Reactor to planner. `arrived` is called when there is something to take."""

    def __init__(self, arrived: Callable[[], None] = lambda: None) -> None:
        self.arrived = arrived
        self.sent = 0
        self.taken = 0
        self._waiting: dict[Key, Perception] = {}  # in the order in which they are taken
        self._latest: dict[str, Key] = {}  # of each subject of which something waits

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
        key = (kind, subject, cause) if kind in COALESCED else (kind, subject, str(self.sent + 1))
        if (repeated := self._waiting.get(key)) is not None:
            self._waiting[key] = repeated = msgspec.structs.replace(repeated, count=repeated.count + 1)
            return repeated if self._latest[subject] == key else self._last(key, time)
        self.sent += 1
        perception = Perception(
            number=self.sent, time=time, kind=kind, subject=subject, cause=cause, instance=instance, values=values,
            epoch=epoch,
        )  # fmt: skip
        self._waiting[key] = perception
        self._latest[subject] = key
        self.arrived()
        return perception

    def _last(self, key: Key, time: float) -> Perception:
        """What waits under this key comes after all that waits: the numbers keep their order."""
        numbers = [perception.number for perception in self._waiting.values()]
        moved = msgspec.structs.replace(self._waiting.pop(key), time=time)
        self._latest[moved.subject] = key
        self._waiting[key] = moved
        for number, (waiting, perception) in zip(numbers, self._waiting.items(), strict=True):
            self._waiting[waiting] = msgspec.structs.replace(perception, number=number)
        return self._waiting[key]

    def take(self) -> list[Perception]:
        """Everything that waits, in order. From here on repeats are new perceptions."""
        taken = list(self._waiting.values())
        self._waiting.clear()
        self._latest.clear()
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
