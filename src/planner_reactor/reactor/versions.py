"""Which reactions serve which instances, where old and new stand beside each other (mode `versions`, R §5.5).

RENEW[s] begins the next version of s: an instance takes the newest when it is asserted and keeps it to its end. A
reaction serves the versions from the one with which it was posted to the one with which it was retired. Who was there
from the beginning, and has no guard, serves all.
"""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass
from math import inf


@dataclass(slots=True, eq=False)
class Lifetime:
    """The first and the last version of its situation that a reaction belongs to, as adaptations have it."""

    first: int
    last: float = inf


class Versions:
    """Version numbers of situations, and the first and last that each guarded reaction serves."""

    def __init__(self) -> None:
        self._newest: dict[str, int] = {}
        self._born: dict[Hashable, dict[str, int]] = {}
        self._retired: dict[Hashable, dict[str, int]] = {}

    def newest(self, situation: str) -> int:
        return self._newest.get(situation, 0)

    def renew(self, situation: str) -> None:
        self._newest[situation] = self.newest(situation) + 1

    def born(self, label: Hashable) -> None:
        """A reaction is posted now."""
        if self._newest:
            self._born[label] = dict(self._newest)

    def retire(self, label: Hashable) -> None:
        """A reaction serves nothing that is asserted after the next RENEW."""
        self._retired.setdefault(label, dict(self._newest))

    def forget(self, label: Hashable) -> None:
        """Its guard is gone."""
        self._born.pop(label, None)
        self._retired.pop(label, None)

    def served(self, label: Hashable, situation: str) -> tuple[int, float]:
        """The first and the last version of this situation that the reaction with this guard serves."""
        first = self._born[label].get(situation, 0) if label in self._born else 0
        last: float = self._retired[label].get(situation, 0) if label in self._retired else inf
        return first, last
