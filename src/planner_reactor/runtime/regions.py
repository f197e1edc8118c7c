"""Regions of names: which slot of the frame a name has, and which names leave a process.

`exported` follows the rules of docs/language.md: what a process binds leaves it, except that the bodies of loops hide
theirs (N8); what a definition binds does not reach this far, for a call binds its results only.
"""

from __future__ import annotations

from planner_reactor.rs.terms import Call, Loop, Process, Spawn, operands
from planner_reactor.runtime.strands import UNBOUND, Frame


class Region:
    """Names and their slots, inside another region or at the top of a frame. `size` is that of the whole frame.

    `blank` is the frame as it begins: nothing is bound, and it holds what code needs of itself (`hold`).
    """

    __slots__ = ("_outer", "_slots", "blank")

    def __init__(self, outer: Region | None = None) -> None:
        self._outer = outer
        self._slots: dict[str, int] = {}
        self.blank: Frame = [] if outer is None else outer.blank

    @property
    def size(self) -> int:
        return len(self.blank)

    def new_slot(self) -> int:
        """A slot without a name."""
        self.blank.append(UNBOUND)
        return len(self.blank) - 1

    def bind(self, name: str) -> None:
        """Give the name a slot in this region."""
        if name not in self._slots:
            self._slots[name] = self.new_slot()

    def declare(self, process: Process) -> None:
        """Give a slot to every name that leaves the process."""
        for name in exported(process):
            self.bind(name)

    def slot(self, name: str) -> int:
        """The slot that the name has here; -1 if nothing binds it."""
        region: Region | None = self
        while region is not None:
            if name in region._slots:
                return region._slots[name]
            region = region._outer
        return -1


def exported(process: Process) -> tuple[str, ...]:
    """The names that leave the process when it ends, in order of their first binding."""
    found: dict[str, None] = {}
    waiting = [process]
    while waiting:
        term = waiting.pop()
        match term:
            case Call(_, _, results):
                found.update(dict.fromkeys(results))
            case Loop(condition, _) | Spawn(condition, _):
                waiting.append(condition)
            case _:
                waiting.extend(reversed(operands(term)))
    return tuple(found)
