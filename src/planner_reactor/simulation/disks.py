"""A disk that crashes, tears, fills and fails, and what one process sees of it.

What was appended and not synced survives the end of a process (the system has it), and may be torn when the power
goes. A `Mount` is one process's view: with its process dead it does nothing more.
"""

from __future__ import annotations

from collections.abc import Callable
from random import Random
from typing import Literal

from planner_reactor.errors import DiskError
from planner_reactor.reactor.disks import Disk

Moment = Literal["appending", "appended", "synced", "replaced"]
"""Inside what a journal does: half of it written; written, not synced; durable; all of it put in place anew."""


class SimulatedDisk:
    """What was appended and not synced may be lost or torn by a crash; it can be full, or fail to sync."""

    def __init__(self, content: bytes = b"") -> None:
        self.durable = content
        self.pending = b""
        self.room = 10**9
        self.sync_fails = False
        self.aside: list[bytes] = []
        self.syncs = 0
        self.refused = 0
        self.torn = 0

    def read(self) -> bytes:
        return self.durable + self.pending

    def append(self, content: bytes) -> None:
        fits = max(0, self.room - len(self.durable) - len(self.pending))
        self.pending += content[:fits]
        if fits < len(content):
            raise self._cannot("no space left")

    def sync(self) -> None:
        self.syncs += 1
        if self.sync_fails:
            raise self._cannot("input/output error")
        self.durable, self.pending = self.durable + self.pending, b""

    def replace(self, content: bytes) -> None:
        if len(content) > self.room:
            raise self._cannot("no space left")
        if self.sync_fails:
            raise self._cannot("input/output error")
        self.durable, self.pending = content, b""

    def set_aside(self, content: bytes) -> None:
        self.aside.append(content)

    def crash(self, random: Random) -> None:
        """The power goes: of what was pending, some beginning is there."""
        kept = random.choice((0, len(self.pending), random.randint(0, len(self.pending))))
        self.torn += kept < len(self.pending)
        self.durable += self.pending[:kept]
        self.pending = b""

    def fill(self, *, spare: int = 0) -> None:
        """From now on it is full, but for so many bytes."""
        self.room = len(self.durable) + len(self.pending) + spare

    def mend(self) -> None:
        """There is room, and what is synced is durable."""
        self.room, self.sync_fails = 10**9, False

    def _cannot(self, why: str) -> DiskError:
        self.refused += 1
        return DiskError(why)


class Mount:
    """A disk as one process sees it. `at` is told of every moment at which the process may be struck."""

    def __init__(self, disk: Disk, at: Callable[[Moment], object] = lambda moment: None) -> None:
        self._disk = disk
        self._at = at
        self.alive = True

    def read(self) -> bytes:
        return self._disk.read()

    def append(self, content: bytes) -> None:
        if self.alive:
            half = len(content) // 2
            self._disk.append(content[:half])
            self._at("appending")
            self._disk.append(content[half:])
            self._at("appended")

    def sync(self) -> None:
        if self.alive:
            self._disk.sync()
            self._at("synced")

    def replace(self, content: bytes) -> None:
        if self.alive:
            self._disk.replace(content)
            self._at("replaced")

    def set_aside(self, content: bytes) -> None:
        if self.alive:
            self._disk.set_aside(content)
