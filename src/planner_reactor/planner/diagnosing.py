"""Failures that no sensor shows: which assumption do the failed situations speak against (R §10, first flaw)?

The planner hears of failed situations, and knows on which assumptions each rests. What it does not hear is how often
one was tried; it takes that all were tried as often as the one that failed most. An assumption whose monitor works is
in little doubt, since its failure would have been told; one that nobody senses, or whose sensor is stale or stuck, is
in as much doubt as its likelihood says.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable

import msgspec

from planner_reactor.logic.diagnosis import Diagnosis, Record, diagnose
from planner_reactor.planner.beliefs import Beliefs, in_doubt
from planner_reactor.planner.model import Segment

OVERLOOKED = 0.05
"""With which probability a working monitor overlooks a failure for as long as it matters."""


CONVINCING = 0.5
"""The confidence from which on a diagnosis counts as a failed assumption, should the planner have to give one up."""


class Diagnosing(msgspec.Struct, eq=False):
    """Counts failures by situation, since the reactor was last changed for an assumption."""

    failures: Counter[str] = msgspec.field(default_factory=Counter)
    unexplained: Counter[str] = msgspec.field(default_factory=Counter)  # since they were borne last
    blind: set[str] = msgspec.field(default_factory=set)  # assumptions of which sensors say nothing of worth

    def failed(self, situation: str, count: int = 1) -> None:
        self.failures[situation] += count

    def runs_out(self, situation: str, patience: int | None) -> bool:
        """It failed once more, for no known reason: as often as is borne? Then it is counted anew."""
        self.unexplained[situation] += 1
        if not patience or self.unexplained[situation] < patience:
            return False
        self.unexplained[situation] = 0
        return True

    def begin_anew(self) -> None:
        """The reactor is to rest on other assumptions: what failed before tells nothing of what it will be."""
        self.failures.clear()

    def sensed(self, assumption: str, *, unknown: bool) -> None:
        """Something was told of an assumption: is it that nothing can be told?"""
        (self.blind.add if unknown else self.blind.discard)(assumption)

    def diagnoses(self, segments: Iterable[Segment], beliefs: Beliefs) -> tuple[Diagnosis, ...]:
        """What may be false, the most probable first; () if nothing has failed."""
        refined = [segment for segment in segments if segment.refinement is not None]
        trials = max((self.failures[segment.name] for segment in refined), default=0)
        records = [Record(segment.required, self.failures[segment.name], trials) for segment in refined]
        names = sorted({name for record in records for name in record.rests_on})
        return diagnose(records, {n: self._doubt(n, beliefs) for n in names if not in_doubt(n, beliefs.relaxed)})

    def _doubt(self, name: str, beliefs: Beliefs) -> float:
        likely = 1 - beliefs.assumption(name).likelihood
        return likely if name in self.blind else likely * OVERLOOKED


def suspects(diagnoses: Iterable[Diagnosis]) -> list[str]:
    """The assumptions of the diagnoses that convince, the most probable first."""
    return [name for diagnosis in diagnoses if diagnosis.confidence >= CONVINCING for name in diagnosis.assumptions]
