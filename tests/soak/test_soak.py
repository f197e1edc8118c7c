"""Nothing of a situation stays behind when it has ended. A million of them: `python -m tests.soak`."""

from __future__ import annotations

import sys
from pathlib import Path

from tests.soak.soak import Sample, Soak, slope

ROUND = 700
FEW = 0.1
"""Blocks of memory a situation, as the interpreter counts them: so little comes and goes with what was adapted last."""


def lived(soak: Soak, rounds: int) -> list[Sample]:
    """How many blocks are held after each round, once everything that grows only at first has grown."""
    soak.live(3 * ROUND)
    samples = []
    for _ in range(rounds):
        soak.live(ROUND)
        samples.append(soak.sample(sys.getallocatedblocks))
    return samples


def test_of_ten_situations_not_one_object_stays(tmp_path: Path) -> None:
    soak = Soak(tmp_path / "reactor.journal")
    samples = lived(soak, 14)
    assert abs(slope(samples)) < FEW
    assert {(s.threads, s.files) for s in samples} == {(samples[0].threads, samples[0].files)}
    assert soak.situations > 10_000
    assert soak.applied > 8
    assert soak.reactor.laws.violations == []


def test_a_crowd_comes_and_goes(tmp_path: Path) -> None:
    soak = Soak(tmp_path / "reactor.journal")
    soak.crowd(1_000)
    assert soak.most >= 1_000
    assert len(soak.reactor.situations.instances) < 50
    assert soak.reactor.laws.violations == []


def test_what_stays_is_seen(tmp_path: Path) -> None:
    soak = Soak(tmp_path / "reactor.journal", leaves=True)
    assert slope(lived(soak, 3)) > FEW
