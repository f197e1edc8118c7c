"""A planner that begins anew on a reactor that stands takes over what is as it should be, and adapts the rest."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

import pytest

from planner_reactor.link.messages import Adaptation, Perception, Standing
from planner_reactor.planner import Planner
from tests.planner.driving import Book, kitting

DOMAIN = kitting()


@dataclass
class Reactor:
    """A `Book` that also keeps what a standing tells."""

    book: Book = field(default_factory=lambda: Book(DOMAIN, loads=False))
    rests_on: dict[str, tuple[str, ...]] = field(default_factory=dict)
    adopted: set[str] = field(default_factory=set)
    given_up: tuple[str, ...] = ()
    failed: tuple[str, ...] = ()
    epoch: int = 0

    def apply(self, adaptation: Adaptation) -> Perception:
        assert adaptation.epoch == self.epoch
        self.book.apply(adaptation)
        self.rests_on |= {c.situation: c.assumptions for c in adaptation.changes}
        for name in adaptation.removed:
            self.rests_on.pop(name, None)
        self.adopted = self.adopted | {*adaptation.adopts} - {*adaptation.drops}
        self.given_up = adaptation.given_up or ()
        return Perception(
            number=1, time=0.0, kind="adaptation_applied", subject=str(adaptation.id), epoch=adaptation.epoch
        )

    def standing(self) -> Standing:
        self.epoch += 1
        return Standing(
            enquirer=self.epoch, epoch=self.epoch, versions=dict(self.book.versions), rests_on=dict(self.rests_on),
            clauses={n: f"P[{n}] = {text}" for n, text in self.book.reactions.items()},
            adopted=tuple(sorted(self.adopted)), failed=self.failed, given_up=self.given_up,
            highest_label=self.book.highest,
        )  # fmt: skip


def issued(planner: Planner, reactor: Reactor, most: int = 10_000) -> Iterator[Adaptation]:
    """Step by step; every adaptation is applied at once, `most` steps at most."""
    for _ in range(most):
        step = planner.step()
        if step is None:
            return
        if step.enquiry is not None:
            standing = reactor.standing()
            planner.resume(standing)
        for adaptation in step.adaptations:
            planner.perceive(reactor.apply(adaptation))
            yield adaptation


def successor(reactor: Reactor, **options: Any) -> Planner:
    planner = Planner(DOMAIN, verify=False, **options)
    planner.enquire(reactor.epoch + 1)
    return planner


def what_stands(reactor: Reactor) -> tuple[set[str], dict[str, tuple[str, ...]], set[str]]:
    return set(reactor.book.reactions.values()), reactor.rests_on, reactor.adopted


def undisturbed(**options: Any) -> tuple[Reactor, int]:
    reactor = Reactor()
    return reactor, len(list(issued(Planner(DOMAIN, verify=False, **options), reactor)))


def test_nothing_is_adapted_where_nothing_differs() -> None:
    reactor, _ = undisturbed()
    before = what_stands(reactor)
    second = successor(reactor)
    assert list(issued(second, reactor)) == []
    assert second.ideal
    assert second.taken_over == len(second.model.segments)
    assert second.relaxed.keys() == set(DOMAIN.assumptions)
    assert what_stands(reactor) == before


@pytest.mark.parametrize("relax", ["all", ()], ids=["all", "none by choice"])
def test_after_a_crash_at_every_step_the_same_reactor_comes_out_of_as_many_adaptations(relax: Any) -> None:
    whole, count = undisturbed(relax=relax)
    steps, crashes = 0, 0
    while True:
        reactor = Reactor()
        first = Planner(DOMAIN, verify=False, relax=relax)
        begun = len(list(issued(first, reactor, steps)))
        second = successor(reactor, relax=relax)
        rest = len(list(issued(second, reactor)))
        assert what_stands(reactor) == what_stands(whole), steps
        assert begun + rest == count, steps
        assert not second.breaches
        crashes += 1
        if begun == count:
            break
        steps += 1 if steps < 12 else 7
    assert crashes > 6
