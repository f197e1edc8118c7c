"""The sensors of the workshop: three assumptions, each sensed in its own way, and everything that sensors do wrong.

A0 is a bare yes or no. A1 says when it was taken and from which signal, so that what is late or stuck can be told from
news. A2 slips now and then: two of three readings make a failure, and the planner hears of one change in a hold-off.
A3 no sensor reads: only a process may notice.

What was truly read is kept apart for whoever watches (`Read`): he knows by himself what the reactor may believe, and
what it has to.
"""

from __future__ import annotations

from collections import Counter, deque
from collections.abc import Callable
from dataclasses import dataclass, field
from random import Random

from planner_reactor.runtime import Caution, Reading
from planner_reactor.runtime.sensing import PLAIN, Sensed

ASSUMPTIONS = ("A0", "A1", "A2")
NOTICED = "A3"
"""No monitor asks for it."""

PERIOD = 3.0
"""Seconds between two readings of a monitor."""

CAUTIONS = {"A1": Caution(stale=20.0, stuck=10.0), "A2": Caution(fails=2, window=3, hold_on=4.0, hold_off=15.0)}


def caution_of(assumption: str) -> Caution:
    return CAUTIONS.get(assumption, PLAIN)


@dataclass(slots=True)
class Read:
    """What was read of one assumption, as far as it is worth anything: the latest, and since when all of it was no."""

    latest: deque[bool]
    failing_since: float | None = None

    def note(self, holds: bool | None, now: float) -> None:
        if holds is None or holds:
            self.failing_since = None
        elif self.failing_since is None:
            self.failing_since = now
        if holds is not None:
            self.latest.append(holds)


@dataclass(slots=True)
class Sensors:
    """`truth`: what there is to be sensed. `late`: by how many seconds. `stuck`: at what they stick, and the signal."""

    draw: Random
    now: Callable[[], float]
    counts: Counter[str]
    truth: dict[str, bool | None] = field(default_factory=lambda: dict.fromkeys((*ASSUMPTIONS, NOTICED), True))
    stuck: dict[str, tuple[bool, int]] = field(default_factory=dict)
    noisy: set[str] = field(default_factory=set)
    late: dict[str, float] = field(default_factory=dict)
    read: dict[str, Read] = field(init=False)
    _signal: int = 0
    _same_since: dict[str, float] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.forget()

    def forget(self) -> None:
        """Whoever reads now has read nothing yet."""
        self.read = {name: Read(deque(maxlen=caution_of(name).window)) for name in (*ASSUMPTIONS, NOTICED)}
        self._same_since.clear()

    def sense(self, name: str) -> Sensed:
        """One reading."""
        self.counts["sensed"] += 1
        now, holds = self.now(), self.truth[name]
        self._signal += 1
        signal = self._signal
        if name in self.stuck:
            holds, signal = self.stuck[name]
        elif holds is not None and name in self.noisy and self.draw.random() < 0.2:
            self.counts["slips"] += 1
            holds = not holds
        self.counts[f"nothing of {name}"] += holds is None
        taken = now - self.late.get(name, 0.0)
        self.read[name].note(None if self._of_no_worth(name, taken, now) else holds, now)
        return Reading(holds, taken, signal) if name == "A1" else holds

    def reported(self, name: str, holds: bool) -> None:
        """A process has noticed by itself."""
        self.read[name].note(holds, self.now())

    def mend(self) -> None:
        """All of them are sound, and all that they sense holds; what nobody senses is as it is."""
        self.stuck.clear()
        self.noisy.clear()
        self.late.clear()
        self.truth.update(dict.fromkeys(ASSUMPTIONS, True))

    def _of_no_worth(self, name: str, taken: float, now: float) -> bool:
        """Is it too old, or the same for too long, to say anything?"""
        caution = caution_of(name)
        if name in self.stuck:
            since = self._same_since.setdefault(name, taken)
            return now - since > caution.stuck or now - taken > caution.stale
        self._same_since.pop(name, None)
        return now - taken > caution.stale
