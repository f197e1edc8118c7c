"""Does the planner get anywhere? Equations (9) and (11) of R §6.2, asserted while it runs.

(11) What is lacking shrinks to nothing. A reduction closes one situation and may open others, so their number
says nothing; but what it opens lies strictly below what it closes: fewer abstract actions are left that could
stand under it, and there are finitely many. So the counts of open situations by that number, the greatest number
first, go down in the order of a dictionary, which cannot be done for ever. What has lost a caller may get another
reaction, too; it counts as below all that stood above it since assumptions changed (docs/regimes.md).

(9) Every relaxation leaves less that is unlikely: l(ω) is the sum of -log of the likelihoods of what is held.
"""

from __future__ import annotations

import math
from collections.abc import Iterable

import msgspec

from planner_reactor.logic.domain import Domain
from planner_reactor.planner.model import Segment

LEAST = 1e-9
"""An assumption that is certain still counts for so much."""


def lacking(domain: Domain, segments: Iterable[Segment]) -> tuple[int, ...]:
    """e: how many situations are open, by the number of abstract actions that may stand below them, the most first."""
    abstract = [schema.name for schema in domain.schemas.values() if schema.abstract]
    counts = [0] * (len(abstract) + 1)
    for segment in segments:
        if segment.is_open:
            counts[len(abstract) - sum(name not in segment.above for name in abstract)] += 1
    return tuple(counts)


def unlikelihood(domain: Domain, relaxed: Iterable[str]) -> float:
    """l(ω) of the assumptions that are held. Of one that is relaxed for some things alone half is left with each."""
    given_up = list(relaxed)
    total = 0.0
    for assumption in domain.assumptions.values():
        if assumption.name not in given_up:
            in_part = sum(name.startswith(f"{assumption.name}(") for name in given_up)
            total += max(LEAST, -math.log(max(assumption.likelihood, LEAST))) / 2**in_part
    return total


class Convergence(msgspec.Struct, eq=False):
    """Watches one planner; `breaches` say where it did not get nearer to its end."""

    breaches: list[str] = msgspec.field(default_factory=list)

    def reduced(self, closed: Segment, opened: Iterable[Segment]) -> None:
        """A situation was closed, others were opened: they must lie below it (11)."""
        for segment in opened:
            segment.stood_below |= closed.stood_below
            if not closed.above < segment.above:
                self.breaches.append(f"(11): {closed.name} was closed, and {segment.name}, not below it, was opened")

    def relaxed(self, name: str, before: float, after: float) -> None:
        """An assumption was given up: what is held must be less unlikely (9)."""
        if not 0 <= after < before:
            self.breaches.append(f"(9): without {name} l is {after:g}, it was {before:g}")
