"""Partition refinement against brute force on random small systems."""

from __future__ import annotations

import random
from collections.abc import Iterator

import pytest

from planner_reactor.analysis.partitions import Moves, branching, quotient, strong

Relation = set[tuple[int, int]]


def random_moves(seed: int) -> tuple[list[list[tuple[str, int]]], list[object]]:
    draw = random.Random(seed)
    count = draw.randint(1, 6)
    moves = [
        [(draw.choice(["a", "b", "t", "t"]), draw.randrange(count)) for _ in range(draw.choice([0, 1, 1, 2, 3]))]
        for _ in range(count)
    ]
    ends = [draw.choice([None, True, False]) if not m else None for m in moves]
    return moves, ends  # type: ignore[return-value]


def strongly_alike(moves: Moves[str], ends: list[object]) -> Relation:
    """The greatest strong bisimulation, by its definition: pairs are struck out until none is wrong."""
    every = range(len(moves))
    related = {(p, q) for p in every for q in every if ends[p] == ends[q]}

    def holds(p: int, q: int) -> bool:
        return all(any(b == a and (s, t) in related for b, t in moves[q]) for a, s in moves[p])

    while wrong := {(p, q) for p, q in related if not (holds(p, q) and holds(q, p))}:
        related -= wrong
    return related


def branching_alike(moves: Moves[str], ends: list[object]) -> Relation:
    """The coarsest of all partitions that are divergence-preserving branching bisimulations, each tried by definition
    (R. van Glabbeek, B. Luttik, N. Trčka, Branching bisimilarity with explicit divergence, 2009)."""
    fitting = [p for p in partitions(len(moves)) if is_branching(moves, ends, p)]
    coarsest = min(fitting, key=lambda classes: len(set(classes)))
    assert all(pairs(other) <= pairs(coarsest) for other in fitting)
    return pairs(coarsest)


def partitions(count: int) -> Iterator[list[int]]:
    if count == 0:
        yield []
        return
    for classes in partitions(count - 1):
        for c in range(max(classes, default=-1) + 2):
            yield [*classes, c]


def is_branching(moves: Moves[str], ends: list[object], classes: list[int]) -> bool:
    every = range(len(moves))

    def inside(q: int) -> set[int]:
        """Where q gets by hidden moves inside its class."""
        found, waiting = {q}, [q]
        while waiting:
            for label, t in moves[waiting.pop()]:
                if label == "t" and classes[t] == classes[q] and t not in found:
                    found.add(t)
                    waiting.append(t)
        return found

    def diverges(p: int) -> bool:
        alive = inside(p)
        while dead := {s for s in alive if not any(a == "t" and t in alive for a, t in moves[s])}:
            alive -= dead
        return p in alive

    def answers(p: int, q: int) -> bool:
        around = inside(q)
        for label, s in moves[p]:
            stays = label == "t" and classes[s] == classes[p]
            if not stays and not any(a == label and classes[t] == classes[s] for h in around for a, t in moves[h]):
                return False
        return ends[p] is None or any(ends[h] == ends[p] for h in around)

    return all(answers(p, q) and diverges(p) == diverges(q) for p in every for q in every if classes[p] == classes[q])


def pairs(classes: list[int]) -> Relation:
    every = range(len(classes))
    return {(p, q) for p in every for q in every if classes[p] == classes[q]}


@pytest.mark.parametrize("chunk", range(4))
def test_strong_classes_are_those_of_the_definition(chunk: int) -> None:
    for seed in range(chunk * 150, (chunk + 1) * 150):
        moves, ends = random_moves(seed)
        assert pairs(strong(moves, ends)) == strongly_alike(moves, ends), (seed, moves, ends)


@pytest.mark.parametrize("chunk", range(4))
def test_branching_classes_are_those_of_the_definition(chunk: int) -> None:
    for seed in range(chunk * 150, (chunk + 1) * 150):
        moves, ends = random_moves(seed)
        assert pairs(branching(moves, ends, lambda a: a == "t")) == branching_alike(moves, ends), (seed, moves, ends)


def test_a_reduced_system_is_as_small_as_it_can_be_and_as_good() -> None:
    for seed in range(200):
        moves, ends = random_moves(seed)
        for hidden in (None, lambda a: a == "t"):
            classes = strong(moves, ends) if hidden is None else branching(moves, ends, hidden)
            small = quotient(moves, classes, hidden)
            small_ends = [
                next((ends[i] for i, c in enumerate(classes) if c == n and ends[i] is not None), None)
                for n in range(len(small))
            ]
            both = [*moves, *([(a, s + len(moves)) for a, s in m] for m in small)]
            worth = [*ends, *small_ends]
            again = strong(both, worth) if hidden is None else branching(both, worth, hidden)
            assert again[: len(moves)] == [again[len(moves) + c] for c in classes], seed
            assert len(set(again[len(moves) :])) == len(small), seed
