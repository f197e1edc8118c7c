"""Each law is seen to be broken when a defect is seeded, and by that law (docs/reactor.md, Laws)."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import msgspec
import pytest

from planner_reactor.link.channels import PerceptionChannel
from planner_reactor.reactor import adaptation, admission
from planner_reactor.reactor.guards import Guards
from planner_reactor.reactor.laws import CHECKED
from planner_reactor.reactor.reactor import Reactor
from planner_reactor.reactor.situations import Situations
from planner_reactor.rs.parser import parse_process
from planner_reactor.rs.terms import Call
from planner_reactor.runtime import Budgets
from tests.reactor.driving import FIRST, SECOND, Bench, change

replace = msgspec.structs.replace
Patch = pytest.MonkeyPatch


def scripted(patch: Patch, text: str) -> None:
    """Apply the second adaptation by another script."""
    usual = adaptation.script
    patch.setattr(adaptation, "script", lambda a, killed: parse_process(text) if a.id == 2 else usual(a, killed))


def half_applied(patch: Patch) -> None:
    scripted(patch, "DRAIN[part] : COMMIT[2] : KILL[2] : Delay[1] : KILL[3] : POST[4] : UNINHIBIT[part]")


def forgetful(patch: Patch) -> None:
    scripted(patch, "DRAIN[part] : COMMIT[2] : KILL[2] : KILL[3] : UNINHIBIT[part]")


def mingling(patch: Patch) -> None:
    scripted(patch, "DRAIN[part] : COMMIT[2] : POST[4] : KILL[2] : KILL[3] : UNINHIBIT[part]")


def cutting(patch: Patch) -> None:
    scripted(patch, "COMMIT[2] : KILL[2] : KILL[3] : POST[4]")
    patch.setattr(Guards, "at_rest", lambda self, label: True)


def mixing(patch: Patch) -> None:
    scripted(patch, "COMMIT[2] : POST[4] : KILL[3]")  # beside the old reaction, while an instance is served


def endless(patch: Patch) -> None:
    patch.setattr(adaptation.Transactions, "_expire", lambda self, transaction: None)


def letting_in(patch: Patch) -> None:
    usual = Situations._queue

    def queue(self: Situations, situation: Any, arguments: Any, owner: Any, strand: Any, again: bool) -> None:
        begins = self._begin if situation.drains else partial(usual, self)
        begins(situation, arguments, owner, strand, again)

    patch.setattr(Situations, "_queue", queue)


def orphaning(patch: Patch) -> None:
    scripted(patch, "DRAIN[part] : COMMIT[2] : KILL[2] : KILL[3] : POST[4]")
    patch.setattr(Situations, "root_ended", lambda self, owner: None)


def holding_on(patch: Patch) -> None:
    usual = Situations.uninhibit

    def uninhibit(self: Situations, name: str, owner: Any) -> bool:
        before = self.named(name).held_back
        found = usual(self, name, owner)
        self.named(name).held_back = before
        return found

    patch.setattr(Situations, "uninhibit", uninhibit)


def twice(patch: Patch) -> None:
    usual = Reactor._finished

    def finished(self: Reactor, transaction: Any) -> None:
        usual(self, transaction)
        usual(self, transaction)

    patch.setattr(Reactor, "_finished", finished)


def versionless(patch: Patch) -> None:
    patch.setattr(admission, "_versions", lambda adaptation, standing: None)


def epochless(patch: Patch) -> None:
    patch.setattr(admission, "_identity", lambda adaptation, standing: None)


def undurable(patch: Patch) -> None:
    scripted(patch, "DRAIN[part] : KILL[2] : KILL[3] : POST[4] : UNINHIBIT[part]")


def acting(patch: Patch) -> None:
    usual = Reactor.receive

    def receive(self: Reactor, adaptation: Any) -> None:
        usual(self, adaptation)
        if adaptation.id == 2:
            self.halt()
            self.executer.start_process(Call("Long"), name="stray")
            self.scheduler.call_after(1.0, self.settle_laws)

    patch.setattr(Reactor, "receive", receive)


def dropping(patch: Patch) -> None:
    usual = PerceptionChannel.report

    def report(self: PerceptionChannel, kind: Any, subject: str, **fields: Any) -> Any:
        told = usual(self, kind, subject, **fields)
        if kind == "guard_kill":
            self._waiting.popitem()
        return told

    patch.setattr(PerceptionChannel, "report", report)


def losing(patch: Patch) -> None:
    usual = Situations._begin

    def begin(self: Situations, situation: Any, *rest: Any) -> None:
        usual(self, situation, *rest)
        if situation.name == "part":
            self.instances.popitem()

    patch.setattr(Situations, "_begin", begin)


def forgetting(patch: Patch) -> None:
    usual = Reactor.receive

    def receive(self: Reactor, adaptation: Any) -> None:
        self.counts["received"] += 1
        usual(self, adaptation)

    patch.setattr(Reactor, "receive", receive)


def boundless(patch: Patch) -> None:
    patch.setattr(Reactor, "over_budget", lambda self: Reactor_over_budget(self))


def Reactor_over_budget(reactor: Reactor) -> str | None:
    reactor.budgets = Budgets(processes=3)
    return USUAL_OVER_BUDGET(reactor)


USUAL_OVER_BUDGET = Reactor.over_budget


def trusting(patch: Patch) -> None:
    patch.setattr(Situations, "disable", lambda self, name, assumption: None)


DEFECTS: dict[str, tuple[int, Callable[[Patch], None]]] = {
    "applied half, then the rest": (1, half_applied),
    "removed and not replaced": (1, forgetful),
    "added beside what it replaces": (1, mingling),
    "a body cut off": (2, cutting),
    "an instance served by old and new reactions": (3, mixing),
    "a deadline that is not kept": (4, endless),
    "asserted while it is drained": (4, letting_in),
    "an inhibition left behind": (5, orphaning),
    "held back by nobody": (5, holding_on),
    "an adaptation applied twice": (6, twice),
    "planned against another version": (7, versionless),
    "applied and not in the journal": (8, undurable),
    "a process that acts after halt": (15, acting),
    "an older epoch": (7, epochless),
    "a perception dropped": (10, dropping),
    "an instance lost": (11, losing),
    "an adaptation forgotten": (11, forgetting),
    "more processes than budgeted": (13, boundless),
    "a failed assumption that is still trusted": (14, trusting),
}


@pytest.mark.parametrize(("law", "seed"), DEFECTS.values(), ids=list(DEFECTS))
def test_a_seeded_defect_is_seen_by_its_law(law: int, seed: Callable[[Patch], None], monkeypatch: Patch) -> None:
    seed(monkeypatch)
    bench = Bench()
    first, second = FIRST, SECOND
    if seed is endless:
        first = replace(first, definitions=first.definitions.replace("Do[old, 2]", "Long"))
        second = replace(second, deadline=5.0)
    if seed is letting_in:
        both = "P[0] = (STOP :; ASSERT[work]) | (Delay[0.4] :; ASSERT[part])"
        first = replace(first, definitions=first.definitions.replace("P[0] = STOP :; ASSERT[work]", both))
    if seed is versionless:
        second = replace(second, changes=(change("part", 7),))
    if seed is epochless:
        first = replace(first, epoch=5)
    bench.at(0.0, first)
    bench.at(3.0, second)
    if seed is trusting:
        bench.scheduler.call_at(1.0, lambda: bench.flags.update(A=False))
    bench.run(500.0 if seed is endless else 20.0)
    assert law in {violation.law for violation in bench.reactor.laws.violations}


def test_every_law_that_is_checked_has_a_seeded_defect() -> None:
    assert {law for law, _ in DEFECTS.values()} == set(CHECKED)


def test_without_a_defect_no_law_is_broken() -> None:
    bench = Bench()
    bench.at(0.0, FIRST)
    bench.at(3.0, SECOND)
    bench.scheduler.call_at(9.0, lambda: bench.flags.update(A=False))
    bench.run(60.0)
    assert not bench.reactor.laws.violations
