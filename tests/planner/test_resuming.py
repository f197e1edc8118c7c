"""A planner that begins anew on a reactor that stands takes over what is as it should be, and adapts the rest."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

import pytest

from planner_reactor.link.messages import Adaptation, Perception, Standing
from planner_reactor.planner import Planner
from tests.planner.driving import Book, kitting, perception

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

    def standing(self, enquirer: int) -> Standing:
        self.epoch += 1
        return Standing(
            enquirer=enquirer, epoch=self.epoch, versions=dict(self.book.versions), rests_on=dict(self.rests_on),
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
            planner.resume(reactor.standing(step.enquiry.enquirer))
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
    assert second.statistics()["taken_over"] == len(second.model.segments)
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


def test_an_assumption_that_failed_while_no_planner_was_there_is_given_up() -> None:
    reactor, _ = undisturbed(relax=())
    other = Reactor()
    by_itself = Planner(DOMAIN, verify=False, relax=())
    list(issued(by_itself, other))
    by_itself.perceive(perception("assumption_failure", "AQ"))
    expected = len(list(issued(by_itself, other)))
    reactor.failed = ("AQ",)
    second = successor(reactor, relax=())
    assert len(list(issued(second, reactor))) == expected == 4
    assert what_stands(reactor) == what_stands(other)
    assert second.relaxed == {"AQ": "forced"}


def test_what_failed_and_may_return_is_still_waited_for_and_comes_back() -> None:
    reactor = Reactor()
    first = Planner(DOMAIN, verify=False, relax=())
    list(issued(first, reactor))
    before = what_stands(reactor)
    first.perceive(perception("assumption_failure", "ADD"))
    list(issued(first, reactor))
    reactor.failed = ("ADD",)
    second = successor(reactor, relax=())
    assert list(issued(second, reactor)) == []
    assert second.relaxed == {"ADD": "forced"}
    reactor.failed = ()  # it returned while no planner was there
    third = successor(reactor, relax=())
    assert len(list(issued(third, reactor))) == 1
    assert what_stands(reactor) == before


def test_what_nobody_planned_goes_once_nothing_asserts_it() -> None:
    reactor, _ = undisturbed(relax=())
    whole = what_stands(reactor)
    label = reactor.book.highest + 1
    reactor.book.reactions |= {label: "STOP :; ASSERT[Odd]", label + 1: "SIT[Odd]<k> :; FAIL[Odd, k]"}
    reactor.book.highest, reactor.book.versions["Odd"] = label + 1, 1
    second = successor(reactor, relax=())
    (removal,) = issued(second, reactor)
    assert (removal.kills, removal.removed) == ((label, label + 1), ("Odd",))
    assert what_stands(reactor) == whole


def test_a_reaction_that_was_changed_by_hand_is_planned_again_and_nothing_else() -> None:
    reactor, _ = undisturbed(relax=())
    whole = what_stands(reactor)
    label = next(n for n, text in reactor.book.reactions.items() if text.startswith("SIT[FinishTray]"))
    reactor.book.reactions[label] = "SIT[FinishTray]<k> :; FAIL[FinishTray, k]"
    (repair,) = issued(successor(reactor, relax=()), reactor)
    assert [c.situation for c in repair.changes] == ["FinishTray"]
    assert what_stands(reactor) == whole


def test_a_planner_that_was_overtaken_does_nothing_any_more() -> None:
    reactor = Reactor()
    old = Planner(DOMAIN, verify=False)
    list(issued(old, reactor, 3))
    list(issued(successor(reactor), reactor))
    late = next(step.adaptations[0] for step in iter(old.step, None) if step.adaptations)
    old.perceive(perception("adaptation_refused", str(late.id), cause="epoch"))
    assert old.fenced
    assert old.step() is None


def test_answers_to_another_planner_are_nothing_to_this_one() -> None:
    reactor = Reactor()
    list(issued(Planner(DOMAIN, verify=False), reactor, 3))
    second = successor(reactor)
    list(issued(second, reactor, 20))
    pending = second.pending
    second.perceive(perception("adaptation_refused", "1", cause="epoch"))
    assert not second.fenced
    assert second.pending == pending


def test_who_asked_twice_plans_in_the_epoch_of_the_last_answer() -> None:
    reactor = Reactor()
    list(issued(Planner(DOMAIN, verify=False), reactor, 3))
    second = successor(reactor)
    first, last = reactor.standing(second_id := reactor.epoch + 1), reactor.standing(second_id)
    second.resume(first)
    second.step()  # it has begun with the first answer when the second comes
    second.resume(last)
    assert not second.fenced
    assert {a.epoch for a in issued(second, reactor)} == {last.epoch}
    second.resume(first)  # and an old answer changes nothing
    assert not second.waits


def test_a_reactor_that_begins_anew_as_it_was_is_told_again_what_was_not_answered() -> None:
    reactor = Reactor()
    planner = Planner(DOMAIN, verify=False)
    list(issued(planner, reactor, 3))
    open_ = next(step.adaptations[0] for step in iter(planner.step, None) if step.adaptations)
    planner.perceive(perception("restarted", "sound", *reactor.book.versions.items()))
    again = planner.step()
    assert again is not None
    assert (again.kind, again.adaptations) == ("repeat", (open_,))
    reactor.apply(open_)  # as if it had been applied before the crash
    planner.perceive(perception("restarted", "sound", *reactor.book.versions.items()))
    assert next(step.kind for step in iter(planner.step, None)) == "repeat"


@pytest.mark.parametrize("damaged", [True, False])
def test_a_reactor_that_has_lost_something_is_asked_how_it_stands(damaged: bool) -> None:
    reactor, earlier = Reactor(), Reactor()
    planner = Planner(DOMAIN, verify=False)
    for _ in range(4):
        for adaptation in issued(planner, reactor, 2):
            if not earlier.book.reactions:
                earlier.apply(adaptation)
    subject = "damaged" if damaged else "sound"
    planner.perceive(perception("restarted", subject, *earlier.book.versions.items()))
    list(issued(planner, earlier))
    whole, _ = undisturbed()
    assert planner.ideal
    assert what_stands(earlier) == what_stands(whole)
