"""A disk that crashes, tears and fills, for tests."""

from __future__ import annotations

from random import Random

from planner_reactor.errors import DiskError


class TornDisk:
    """What was appended and not synced may be lost or torn by a crash; it can be full, or fail to sync."""

    def __init__(self, content: bytes = b"") -> None:
        self.durable = content
        self.pending = b""
        self.room = 10**9
        self.sync_fails = False
        self.aside: list[bytes] = []
        self.syncs = 0

    def read(self) -> bytes:
        return self.durable + self.pending

    def append(self, content: bytes) -> None:
        fits = max(0, self.room - len(self.durable) - len(self.pending))
        self.pending += content[:fits]
        if fits < len(content):
            raise DiskError("no space left")

    def sync(self) -> None:
        self.syncs += 1
        if self.sync_fails:
            raise DiskError("input/output error")
        self.durable, self.pending = self.durable + self.pending, b""

    def replace(self, content: bytes) -> None:
        if len(content) > self.room or self.sync_fails:
            raise DiskError("no space left")
        self.durable, self.pending = content, b""

    def set_aside(self, content: bytes) -> None:
        self.aside.append(content)

    def crash(self, random: Random) -> None:
        """The power goes: of what was pending, some beginning is there."""
        self.durable += self.pending[: random.randint(0, len(self.pending))]
        self.pending = b""
