"""Timed events: what happened, when, in order.

A `Trace` is the one record of a run. Every event has a time (seconds on the run's clock), a kind, and plain data; it
goes to the sinks at once (a JSONL file, a list, a law checker) and into a running SHA-256, so that two runs can be
compared by one hash. Nothing here knows what the events mean.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Iterator
from typing import IO, TYPE_CHECKING, Any

import msgspec

if TYPE_CHECKING:
    from pathlib import Path

Sink = Callable[["Event"], None]


CHECKPOINT = 1_000
"""After so many events the hash is kept, so that beginnings of runs can be compared."""


class Event(msgspec.Struct, frozen=True):
    """One timed event. `data` is JSON-able."""

    number: int
    time: float
    kind: str
    data: dict[str, Any]


_encode = msgspec.json.Encoder(enc_hook=str, order="deterministic").encode


class Trace:
    """Collects events. `clock` gives the time of each; `keep` holds them in memory as well."""

    def __init__(self, clock: Callable[[], float] = lambda: 0.0, *, keep: bool = True) -> None:
        self.clock = clock
        self.count = 0
        self.events: list[Event] = []
        self.sinks: list[Sink] = []
        self.checkpoint_hash = ""
        self._keep = keep
        self._digest = hashlib.sha256()

    def record(self, kind: str, **data: Any) -> None:
        """Record that something of this kind happened now."""
        self.count += 1
        event = Event(self.count, self.clock(), kind, data)
        self._digest.update(_encode(event))
        if self.count == CHECKPOINT:
            self.checkpoint_hash = self.hash
        if self._keep:
            self.events.append(event)
        for sink in self.sinks:
            sink(event)

    def of(self, *kinds: str) -> Iterator[Event]:
        """The kept events of these kinds, in order."""
        return (e for e in self.events if e.kind in kinds)

    @property
    def hash(self) -> str:
        """SHA-256 of everything recorded so far: same seed and inputs, same hash."""
        return self._digest.hexdigest()


class JsonLines:
    """A sink that writes one JSON object a line."""

    def __init__(self, path: Path) -> None:
        self._file: IO[bytes] = path.open("wb")

    def __call__(self, event: Event) -> None:
        self._file.write(_encode(event))
        self._file.write(b"\n")

    def close(self) -> None:
        self._file.close()


def read(path: Path) -> Iterator[Event]:
    """The events of a JSONL trace, in order."""
    decode = msgspec.json.Decoder(Event).decode
    with path.open("rb") as lines:
        for line in lines:
            yield decode(line)
