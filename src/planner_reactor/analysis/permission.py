"""What is told of an adaptation, and what has to be known to tell it: values, without what works them out."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, TypeAlias

import msgspec

if TYPE_CHECKING:
    from planner_reactor.rs.configurations import Label
    from planner_reactor.rs.vocabulary import Signature
else:
    Label: TypeAlias = tuple[Any, ...]
    Signature: TypeAlias = Any


class Environment(msgspec.Struct, frozen=True):
    """What is known of the basic processes: signatures with their age windows, and limits beyond those (seconds)."""

    signatures: Mapping[str, Signature] = msgspec.field(default_factory=dict)
    limits: Mapping[str, float] = msgspec.field(default_factory=dict)


class Verdict(msgspec.Struct, frozen=True, kw_only=True):
    """What holds of an adaptation. `bound_s` is None where nothing is known of the basic processes.

    `counterexample` holds the labels of a shortest path to what is broken first (`why`), the last `cycle` of them going
    round for ever; `states` were looked at for it, 0 if it was known already.
    """

    consistent: bool = True
    safe: bool = True
    atomic: bool = True
    local: bool = True
    bounded: bool = True
    bound_s: float | None = None
    why: str = ""
    counterexample: tuple[Label, ...] = ()
    cycle: int = 0
    states: int = 0

    @property
    def holds(self) -> bool:
        """May the adaptation be issued?"""
        return self.consistent and self.safe and self.atomic and self.local and self.bounded
