"""The domain of a derivation that was tried before yields what was tried: counts, sequence, every
assumption set.
"""

from __future__ import annotations

import random

import pytest

from planner_reactor.logic.domain import Domain
from planner_reactor.planner import Planner
from tests.planner.driving import (
    KITTING,
    PAPERS,
    TRIED,
    Book,
    first_adaptations,
    image,
    kitting,
    perception,
    planner_without,
    reinstatable,
    settle,
    texts,
)

ORDER = ("AQ", "AS", "AF", "ACT", "ACP", "ADT", "AM", "ADD", "AO")


@pytest.mark.parametrize("path", [TRIED, KITTING, PAPERS], ids=lambda p: p.stem)
def test_assumptions_in_use_rise_from_six_to_nine(path: object) -> None:
    planner = Planner(kitting(path))  # type: ignore[arg-type]
    counts = []
    for _ in range(5):
        first_adaptations(planner, 1)
        counts.append(len(planner.assumptions_in_use))
    assert counts == [6, 8, 8, 8, 9]


@pytest.mark.parametrize("path", [TRIED, KITTING], ids=lambda p: p.stem)
def test_assumptions_are_relaxed_from_the_least_likely_on(path: object) -> None:
    planner = Planner(kitting(path))  # type: ignore[arg-type]
    settle(planner)
    assert tuple(r.assumption for r in planner.relaxations) == ORDER
    assert all(r.done and r.cause == "normal" and r.adaptations for r in planner.relaxations)
    assert planner.ideal
    assert planner.assumptions_in_use == ()


def test_the_final_reactions_are_those_of_the_derivation() -> None:
    planner = Planner(kitting(TRIED))
    settle(planner)
    found = texts(planner)
    assert found["FindGoodPartMotor"] == (
        "SIT[FindGoodPartMotor]<k> :; (~((Choose[motor]<x1> & AwaitArrival[motor]) : Locate[x1]<x2> : "
        "(Track[x2] # Get[x2]) : Test[motor, x2] : (UPDATE[FindGoodPartMotor, k, x2] ; "
        "SUCCEED[FindGoodPartMotor, k])) : FAIL[FindGoodPartMotor, k])"
    )
    assert found["LacksCap"] == (
        "SIT[LacksCap]<k, x1> :; (~(REASSERT[FindGoodPartCap]<x2> : (if SlotVacant[x1, cap] then LocateTray[x1] : "
        "Insert[x2, x1] else PutBack[x2]) : SUCCEED[LacksCap, k]) : FAIL[LacksCap, k])"
    )
    assert found["FinishTray"] == (
        "SIT[FinishTray]<k, x1> :; (~(AwaitReady : REASSERT[FillTray, x1] : Deliver[x1] : SUCCEED[FinishTray, k]) : "
        "FAIL[FinishTray, k])"
    )


def test_a_slot_is_looked_at_before_the_part_is_fetched_unless_others_may_fill_it_meanwhile() -> None:
    domain = kitting(TRIED)
    early, late = planner_without(domain, ["AQ", "AF"]), planner_without(domain, ["AQ", "ACP"])
    settle(early), settle(late)
    assert "if SlotVacant[x1, motor] then REASSERT[FindGoodPartMotor]<x2>" in texts(early)["LacksMotor"]
    assert "REASSERT[FindGoodPartMotor]<x2> : (if SlotVacant[x1, motor] then" in texts(late)["LacksMotor"]


@pytest.mark.parametrize("path", [TRIED, KITTING, PAPERS], ids=lambda p: p.stem)
def test_every_set_of_assumptions_can_be_planned_for(path: object) -> None:
    """All 2⁹, in an order in which one assumption is relaxed or reinstated at a time."""
    domain = reinstatable(path)  # type: ignore[arg-type]
    planner, book = Planner(domain, relax=(), verify=path == KITTING), Book(domain, loads=False)
    settle(planner, book)
    reactors = {tuple(sorted(texts(planner).items()))}
    for n in range(1, 512):
        flipped = ORDER[(n & -n).bit_length() - 1]  # the Gray code
        kind = "assumption_holds" if flipped in planner.relaxed else "assumption_failure"
        planner.perceive(perception(kind, flipped))  # type: ignore[arg-type]
        settle(planner, book)
        assert planner.ideal, (planner.relaxed, planner.impossible)
        assert not set(planner.assumptions_in_use) & set(planner.relaxed)
        reactors.add(tuple(sorted(texts(planner).items())))
    assert len(reactors) == {TRIED: 320, KITTING: 320, PAPERS: 8}[path]  # type: ignore[index]


def fresh(domain: Domain, relaxed: frozenset[str]) -> object:
    planner = planner_without(domain, sorted(relaxed))
    settle(planner)
    return image(planner)


@pytest.mark.parametrize("path", [TRIED, KITTING, PAPERS], ids=lambda p: p.stem)
def test_planning_in_increments_and_anew_agree(path: object) -> None:
    """Random failures and reinstatements, adaptations applied late, refused, timed out, stubs and
    failures between.
    """
    domain = reinstatable(path)  # type: ignore[arg-type]
    known: dict[frozenset[str], object] = {}
    for seed in range(12):
        rng = random.Random(seed)
        planner, book = Planner(domain, relax=(), verify=path == KITTING), Book(domain)
        waiting: list[object] = []
        for _ in range(rng.randrange(3, 10)):
            disturb(planner, book, waiting, rng)
        settle_slowly(planner, book, waiting, rng)
        relaxed = frozenset(planner.relaxed)
        if relaxed not in known:
            known[relaxed] = fresh(domain, relaxed)
        assert image(planner) == known[relaxed], (seed, sorted(relaxed))
        flags = {a for a in planner.assumptions_in_use if domain.assumptions[a].monitor == "flag"}
        assert book.monitors("ASSUMONITOR") == flags
        assert book.monitors("HOLDMONITOR") == relaxed


def disturb(planner: Planner, book: Book, waiting: list[object], rng: random.Random) -> None:
    for _ in range(rng.randrange(6)):
        step = planner.step()
        waiting.extend(step.adaptations if step else ())
        if waiting and rng.random() < 0.5:
            answer(planner, book, waiting.pop(0), rng)
    kind = "assumption_failure" if rng.random() < 0.6 else "assumption_holds"
    planner.perceive(perception(kind, rng.choice(ORDER)))  # type: ignore[arg-type]
    names = [segment.name for segment in planner.model]
    if names:
        kind = rng.choice(["stub_trigger", "situation_failure"])
        planner.perceive(perception(kind, rng.choice(names)))  # type: ignore[arg-type]


def answer(planner: Planner, book: Book, adaptation: object, rng: random.Random) -> None:
    kind = "adaptation_applied" if rng.random() < 0.93 else rng.choice(["adaptation_refused", "adaptation_timed_out"])
    if kind == "adaptation_applied":
        book.apply(adaptation)  # type: ignore[arg-type]
    planner.perceive(perception(kind, str(adaptation.id), cause="x"))  # type: ignore[arg-type, attr-defined]


def settle_slowly(planner: Planner, book: Book, waiting: list[object], rng: random.Random) -> None:
    for _ in range(3000):
        step = planner.step()
        waiting.extend(step.adaptations if step else ())
        if waiting and (step is None or rng.random() < 0.4):
            answer(planner, book, waiting.pop(0), rng)
        elif step is None:
            return
    raise AssertionError("not settled")
