"""What the situation store consists of: situations, their instances, and who may serve them (R §5.1, §5.2).

Mutable records without behaviour of their own; `situations` keeps them consistent.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Hashable
from dataclasses import dataclass, field
from heapq import heappop, heappush
from math import inf
from typing import Any, Literal, TypeAlias

Status: TypeAlias = Literal["on", "ok", "ab"]
Kind: TypeAlias = Literal["inhibit", "drain", "assumption"]
Reaction: TypeAlias = tuple[object, Hashable]
Strand: TypeAlias = Any  # the executer's own; never looked into here


@dataclass(slots=True, eq=False)
class Instance:
    """One assertion of a situation."""

    number: int
    situation: Situation
    arguments: tuple[object, ...]
    owner: Instance | None
    awaiter: Strand | None
    again: bool = False  # asserted by a REASSERT
    version: int = 0
    status: Status = "on"
    values: tuple[object, ...] = ()
    withdrawn: bool = False
    stub: bool = False
    cause: str = ""
    bodies: int = 0
    children: dict[int, Instance] = field(default_factory=dict)
    queued: dict[int, QueuedAssert] = field(default_factory=dict)

    @property
    def gone(self) -> bool:
        """Ended, or being withdrawn: it can assert nothing more."""
        return self.status != "on" or self.withdrawn


@dataclass(slots=True, eq=False)
class QueuedAssert:
    """An ASSERT held back. One that was migrated is `kept` if its process is removed: then it has no strand."""

    ticket: int
    situation: Situation
    arguments: tuple[object, ...]
    owner: Instance | None
    strand: Strand | None
    again: bool
    kept: bool = False


@dataclass(slots=True, eq=False)
class Served:
    """A reaction of a situation: whom it may serve next, least recently served first, and who waits at its SIT.

    `fresh` was never served; `again` is a heap by last service of those that are not in service now. Both may hold
    instances that have ended meanwhile: they are dropped when they come up.
    """

    fresh: deque[Instance] = field(default_factory=deque)
    first: int = 0  # the versions that it serves, from this one
    last: float = inf  # to this one
    again: list[tuple[int, int, Instance]] = field(default_factory=list)
    stamps: dict[int, int] = field(default_factory=dict)
    waiting: deque[Strand] = field(default_factory=deque)

    def take(self, stamp: int) -> Instance | None:
        """The instance to serve now, stamped; it is not offered again before `give_back`."""
        while self.fresh or self.again:
            instance = self.fresh.popleft() if self.fresh else heappop(self.again)[2]
            if not instance.gone:
                self.stamps[instance.number] = stamp
                return instance
            self.stamps.pop(instance.number, None)
        return None

    def give_back(self, instance: Instance) -> None:
        """No longer in service: it may be served again, in its turn."""
        if instance.gone:
            self.stamps.pop(instance.number, None)
        else:
            heappush(self.again, (self.stamps[instance.number], instance.number, instance))


@dataclass(slots=True, eq=False)
class Inhibition:
    owner: Hashable
    kind: Kind


@dataclass(slots=True, eq=False)
class Situation:
    name: str
    instances: dict[int, Instance] = field(default_factory=dict)
    reactions: dict[Reaction, Served] = field(default_factory=dict)
    inhibitions: list[Inhibition] = field(default_factory=list)
    drains: list[Hashable] = field(default_factory=list)
    queue: dict[int, QueuedAssert] = field(default_factory=dict)
    waiters: list[tuple[str, Strand, Hashable]] = field(default_factory=list)
    waiting_old: list[tuple[int, Strand]] = field(default_factory=list)  # for the end of all older versions
    disabled: int = 0
    held_back: int = 0  # drains in progress, and inhibitions that also queue ASSERTs

    @property
    def blocked(self) -> bool:
        """Is nothing of it delivered now?"""
        return bool(self.inhibitions or self.drains)
