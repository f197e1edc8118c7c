"""What to plan next (R §7.3): failed situations > failed assumptions > active stubs > quiescent stubs.

Among equals what comes first in the text of the reactor; what has taken long already comes after the others (its
`turn`). Situations that an adaptation under way touches are put aside until it is answered. Entries that have become
out of date (planned meanwhile, or raised) are dropped when they come up, so that nothing here depends on how many
situations there are.
"""

from __future__ import annotations

from heapq import heappop, heappush
from typing import TypeAlias

import msgspec

from planner_reactor.planner.model import Model, Segment
from planner_reactor.planner.situations import Situation

FAILED_SITUATION, FAILED_ASSUMPTION, ACTIVE_STUB, QUIESCENT = range(4)

_Entry: TypeAlias = tuple[int, int, tuple[int, ...], int, Situation]


class Agenda(msgspec.Struct, eq=False):
    """The open segments of a model, the most urgent first."""

    model: Model
    _entries: list[_Entry] = msgspec.field(default_factory=list)
    _aside: dict[int, list[_Entry]] = msgspec.field(default_factory=dict)
    _holders: dict[Situation, int] = msgspec.field(default_factory=dict)
    _count: int = 0

    def push(self, segment: Segment) -> None:
        """Something is to be done about this segment."""
        self._count += 1
        heappush(self._entries, (segment.urgency, segment.turn, segment.path, self._count, segment.situation))

    def let_others(self, segment: Segment) -> bool:
        """It comes after the others that are as urgent; False if there are none that could be worked on."""
        segment.turn += 1
        self.push(segment)
        other = self.next()
        return other is not None and other is not segment and other.urgency == segment.urgency

    def set_aside(self, segment: Segment, adaptation: int) -> None:
        """Nothing can be done about it until this adaptation is answered."""
        self._holders[segment.situation] = adaptation

    def release(self, adaptation: int) -> None:
        """The adaptation is answered."""
        for situation in [s for s, holder in self._holders.items() if holder == adaptation]:
            del self._holders[situation]
        for entry in self._aside.pop(adaptation, ()):
            heappush(self._entries, entry)

    def next(self) -> Segment | None:
        """The most urgent segment that is not held; it stays on the agenda until it is no longer open."""
        while self._entries:
            entry = self._entries[0]
            segment = self._valid(entry)
            holder = None if segment is None else self._holders.get(segment.situation, segment.pending)
            if segment is not None and holder is None:
                return segment
            heappop(self._entries)
            if holder is not None:
                self._aside.setdefault(holder, []).append(entry)
        return None

    def is_empty(self) -> bool:
        """Is nothing open, held or not?"""
        if self.next() is not None:
            return False
        return not any(self._valid(entry) for entries in self._aside.values() for entry in entries)

    def _valid(self, entry: _Entry) -> Segment | None:
        segment = self.model.segments.get(entry[-1])
        if segment is None or not segment.is_open or (segment.urgency, segment.turn) != entry[:2]:
            return None
        return segment
