"""Which assumption is false, if no sensor says so? Diagnosis from what fails (R §10, first flaw).

What rests on assumptions and fails is a *conflict*: one of those that it rests on is false, or it failed by chance. A
*diagnosis* is a smallest set of assumptions that explains every conflict, a minimal hitting set of them (R. Reiter, *A
theory of diagnosis from first principles*, Artificial Intelligence 32, 1987); that nothing is false is one, too. They
are weighed by Bayes' rule: what is false with which probability beforehand, and how well it explains who failed and who
did not although it rests on the same.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from math import exp, log

import msgspec

MOST_AT_ONCE = 3
"""Assumptions that are taken to be false at once, at most."""

SUSPICIOUS = 2
"""Failures of one thing that make a conflict: once may be chance."""


class Record(msgspec.Struct, frozen=True):
    """What is known of one thing that rests on assumptions: it failed so often, of so many trials."""

    rests_on: frozenset[str]
    failures: int
    trials: int


class Diagnosis(msgspec.Struct, frozen=True):
    """These assumptions (sorted; none: chance) are false, with this confidence (the probabilities of all sum to 1)."""

    assumptions: tuple[str, ...]
    confidence: float


class Chances(msgspec.Struct, frozen=True):
    """How often a trial fails: where an assumption that it rests on is false, and otherwise."""

    false: float = 0.5
    otherwise: float = 0.02


USUAL = Chances()


def hitting_sets(conflicts: Iterable[Collection[str]], most: int = MOST_AT_ONCE) -> tuple[frozenset[str], ...]:
    """All minimal sets of at most `most` names that meet every conflict, smaller ones first, then by name.

    None if there is no such set; the empty set alone if there is no conflict.
    """
    wanted = [frozenset(c) for c in conflicts]
    found: list[frozenset[str]] = []
    level: list[frozenset[str]] = [frozenset()]
    for _ in range(most + 1):
        following: set[frozenset[str]] = set()
        for candidate in level:
            missed = next((c for c in wanted if c.isdisjoint(candidate)), None)
            if missed is None:
                found.append(candidate)
            elif len(candidate) < most:
                following.update(candidate | {name} for name in missed)
        level = sorted((c for c in following if not any(f <= c for f in found)), key=sorted)
    return tuple(found)


def diagnose(
    records: Sequence[Record], doubts: Mapping[str, float], chances: Chances = USUAL
) -> tuple[Diagnosis, ...]:
    """Every diagnosis of these records, the most probable first; () if nothing has failed.

    `doubts`: with which probability an assumption is false and nobody has said so; those not named are certain.
    """
    if not any(record.failures for record in records):
        return ()
    suspects = [
        frozenset(a for a in record.rests_on if doubts.get(a, 0.0) > 0.0)
        for record in records
        if record.failures >= SUSPICIOUS
    ]
    candidates = hitting_sets([s for s in suspects if s])
    weighed = {c: _weight(c, records, doubts, chances) for c in (*candidates, frozenset[str]())}
    best = max(weighed.values())
    total = sum(exp(weight - best) for weight in weighed.values())
    diagnoses = [Diagnosis(tuple(sorted(c)), exp(w - best) / total) for c, w in weighed.items()]
    return tuple(sorted(diagnoses, key=lambda d: (-d.confidence, d.assumptions)))


def _weight(
    candidate: frozenset[str], records: Sequence[Record], doubts: Mapping[str, float], chances: Chances
) -> float:
    """Logarithm of the probability that just these are false and the records are as they are."""
    weight = sum(log(doubt) if name in candidate else log(1 - doubt) for name, doubt in doubts.items() if 0 < doubt < 1)
    for record in records:
        fails = chances.otherwise if record.rests_on.isdisjoint(candidate) else chances.false
        weight += record.failures * log(fails) + (record.trials - record.failures) * log(1 - fails)
    return weight
