"""Bounds on what a program may use up, so that no text can eat the machine (reactor's law 13).

Reaching one is not an error of the executer: it aborts the nearest enclosing served body with cause `budget`, and the
statistics name the definition. What no body encloses is a root; a root is never aborted by its budget of steps: its
next round waits one quantum (docs/language.md, STREAM).
"""

from __future__ import annotations

import msgspec

from planner_reactor.errors import InputError
from planner_reactor.rs.prelude import QUANTUM


class Budgets(msgspec.Struct, frozen=True, kw_only=True):
    """`turns`: how often the strands of one served body, or of one root, may run at one instant, beyond once for each
    strand alive (the Zeno budget); a strand that runs on without waiting is charged for each instruction.

    `quantum`: seconds that a root waits once it has used them up. `processes`: strands alive at once. `depth`: calls
    within calls of one strand that are not tail calls. `slice`: instructions that a strand runs before it goes to the
    end of the queue (1: a step each, first in first out).
    """

    turns: int = 100_000
    quantum: float = QUANTUM
    processes: int = 1_000_000
    depth: int = 100_000
    slice: int = 64

    def __post_init__(self) -> None:
        for name in ("turns", "quantum", "processes", "depth", "slice"):
            if not getattr(self, name) > 0:
                raise InputError(f"budget {name} must be more than 0, not {getattr(self, name)!r}")
