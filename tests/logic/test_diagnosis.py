"""Minimal hitting sets and their weights, held against enumeration; how often they are right in random worlds."""

from __future__ import annotations

import random
from itertools import combinations
from math import isclose, prod

import pytest

from planner_reactor.logic import diagnosis
from planner_reactor.logic.diagnosis import Chances, Diagnosis, Record, diagnose, hitting_sets

NAMES = [f"A{n}" for n in range(7)]


def enumerated(conflicts: list[frozenset[str]], most: int) -> set[frozenset[str]]:
    """The minimal hitting sets by their definition."""
    sets = [frozenset(c) for size in range(most + 1) for c in combinations(NAMES, size)]
    hitting = [s for s in sets if all(s & c for c in conflicts)]
    return {s for s in hitting if not any(other < s for other in hitting)}


@pytest.mark.parametrize("seed", range(60))
def test_hitting_sets_are_those_of_the_definition(seed: int) -> None:
    draw = random.Random(seed)
    conflicts = [frozenset(draw.sample(NAMES, draw.randint(1, 4))) for _ in range(draw.randint(0, 5))]
    found = hitting_sets(conflicts)
    assert set(found) == enumerated(conflicts, diagnosis.MOST_AT_ONCE)
    assert list(found) == sorted(found, key=lambda s: (len(s), sorted(s)))


def test_without_a_conflict_nothing_has_to_be_hit_and_nothing_hits_an_empty_one() -> None:
    assert hitting_sets([]) == (frozenset(),)
    assert hitting_sets([frozenset()]) == ()


def weight(false: frozenset[str], records: list[Record], doubts: dict[str, float], chances: Chances) -> float:
    """The probability that just these are false, times that of the records, by its definition."""
    prior = prod(d if a in false else 1 - d for a, d in doubts.items())
    fails = [chances.false if r.rests_on & false else chances.otherwise for r in records]
    return prior * prod(q**r.failures * (1 - q) ** (r.trials - r.failures) for q, r in zip(fails, records, strict=True))


@pytest.mark.parametrize("seed", range(30))
def test_confidences_are_bayes_rule_among_the_candidates(seed: int) -> None:
    draw = random.Random(seed)
    records = [
        Record(frozenset(draw.sample(NAMES, draw.randint(1, 3))), draw.choice([0, 0, 1, 3, 5]), 5) for _ in range(5)
    ]
    doubts = {name: draw.uniform(0.01, 0.5) for name in NAMES}
    found = diagnose(records, doubts)
    weights = {d.assumptions: weight(frozenset(d.assumptions), records, doubts, Chances()) for d in found}
    for d in found:
        assert isclose(d.confidence, weights[d.assumptions] / sum(weights.values()), rel_tol=1e-9)
    assert found == tuple(sorted(found, key=lambda d: (-d.confidence, d.assumptions)))


def test_one_that_all_failures_share_is_found() -> None:
    records = [Record(frozenset("ab"), 4, 5), Record(frozenset("ac"), 3, 5), Record(frozenset("bc"), 0, 5)]
    best, *others = diagnose(records, dict.fromkeys("abc", 0.2))
    assert best.assumptions == ("a",)
    assert best.confidence > 0.9
    assert sum(d.confidence for d in (best, *others)) == pytest.approx(1.0)


def test_two_failures_that_nothing_shares_take_two() -> None:
    records = [Record(frozenset("ab"), 4, 5), Record(frozenset("cd"), 4, 5), Record(frozenset("bd"), 0, 5)]
    assert diagnose(records, dict.fromkeys("abcd", 0.2))[0].assumptions == ("a", "c")


def test_what_is_certain_is_never_blamed_and_a_single_failure_is_chance() -> None:
    records = [Record(frozenset("ab"), 4, 5)]
    assert all("a" not in d.assumptions for d in diagnose(records, {"b": 0.2}))
    assert diagnose([Record(frozenset("ab"), 1, 50)], dict.fromkeys("ab", 0.2)) == (Diagnosis((), 1.0),)
    assert diagnose([Record(frozenset("ab"), 0, 50)], dict.fromkeys("ab", 0.2)) == ()


# ------------------------------------------------------------------------------------------------ how often it is right


def toy(seed: int) -> tuple[list[Record], str | None, dict[str, float]]:
    """Ten things that rest on some of eight assumptions, ten trials of each; in four worlds of five one is false."""
    draw = random.Random(seed)
    names = [f"A{n}" for n in range(8)]
    things = [frozenset(draw.sample(names, draw.randint(1, 4))) for _ in range(10)]
    false = draw.choice(sorted({a for t in things for a in t})) if draw.random() < 0.8 else None
    chances = [0.6 if false in t else 0.03 for t in things]
    failures = [sum(draw.random() < chance for _ in range(10)) for chance in chances]
    return [Record(t, f, 10) for t, f in zip(things, failures, strict=True)], false, dict.fromkeys(names, 0.1)


def right() -> tuple[float, float]:
    """(precision, recall) of what is at least as likely as not, over 300 toy worlds."""
    named = found = wanted = 0
    for seed in range(300):
        records, false, doubts = toy(seed)
        best = next((d.assumptions for d in diagnose(records, doubts) if d.confidence >= 0.5), ())
        named += bool(best)
        wanted += false is not None
        found += best == (false,)
    return found / named, found / wanted


def test_in_most_random_worlds_it_names_the_false_one() -> None:
    precision, recall = right()
    assert precision > 0.8
    assert recall > 0.75


def test_the_figures_can_be_missed(monkeypatch: pytest.MonkeyPatch) -> None:
    """Without what did *not* fail, many worlds cannot be told apart."""
    usual = diagnosis._weight
    monkeypatch.setattr(
        diagnosis, "_weight", lambda c, records, *rest: usual(c, [r for r in records if r.failures], *rest)
    )
    assert right()[1] < 0.75
