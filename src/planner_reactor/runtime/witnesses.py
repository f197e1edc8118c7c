"""Who is told of all that an executer does: enough to follow it from outside, step by step."""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Mapping
from typing import Protocol

from planner_reactor.rs.terms import Process, Schema, Value
from planner_reactor.runtime.outcomes import Label
from planner_reactor.runtime.strands import Root


class Witness(Protocol):
    """Told of each event inside the step to which it belongs; it must change nothing."""

    def loaded(self, schemas: Iterable[Schema]) -> None:
        """Definitions have been added."""

    def unloaded(self, schemas: Iterable[Schema]) -> None:
        """Definitions are gone."""

    def began(self, root: Root, process: Process, bound: Mapping[str, Value]) -> None:
        """A root has begun to run this process, in which these names are bound."""

    def took(self, label: Label, sites: tuple[Hashable, ...]) -> None:
        """A step, by the leaves that stand at these places in the text."""

    def ended(self, root: Root, *, killed: bool) -> None:
        """A root has ended by itself, or was `killed` from outside."""
