"""Which `#` is decided next, and how (N5).

When everything silent is done, the `#`s of which a part has ended are decided one at a time: the innermost first (most
`#`s around it), leftmost among equals; each verdict may end others, or make them void. One is the rule, several are
rare: only then are they ranked.
"""

from __future__ import annotations

from heapq import heappop, heappush

from planner_reactor.runtime.strands import FORKED, Fork


class Verdicts:
    """The `#`s that wait for their verdict; `new` holds those not ranked yet (outside a verdict: all)."""

    __slots__ = ("new", "ranked")

    def __init__(self) -> None:
        self.new: list[Fork] = []
        self.ranked: list[tuple[int, tuple[int, ...], Fork]] = []

    def __bool__(self) -> bool:
        return bool(self.new or self.ranked)

    def add(self, fork: Fork) -> None:
        """A part of this `#` has ended."""
        if not fork.due:
            fork.due = True
            self.new.append(fork)

    def next(self) -> Fork:
        """The innermost, leftmost among equals."""
        if not self.ranked and len(self.new) == 1:
            return self.new.pop()
        for fork in self.new:
            heappush(self.ranked, (-fork.depth, fork.path(), fork))
        self.new.clear()
        return heappop(self.ranked)[2]


def is_void(fork: Fork) -> bool:
    """Has the strand that met this `#` been aborted meanwhile?"""
    return fork.parent.state != FORKED or fork.parent.link is not fork


def verdict(fork: Fork) -> tuple[int, bool, str]:
    """(the part that decides, its outcome, its cause): a stop before an abort, then the leftmost."""
    return min(fork.ended, key=lambda end: (not end[1], end[0]))
