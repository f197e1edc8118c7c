"""At whatever step a reactor is lost or cut off, what comes back has the old structure or the new one (rows 2, 3, 4).

A part of the matrix; the whole is `make crashes`.
"""

from __future__ import annotations

from itertools import islice
from typing import Any

import pytest

from planner_reactor.link.session import Session
from planner_reactor.reactor import adaptation, recovery
from planner_reactor.reactor.journal import Begun, Decided, Journal
from planner_reactor.simulation.disks import SimulatedDisk
from tests.crashes.matrix import Finding, looked_at
from tests.crashes.shapes import Case, cases, forests, said

SMALL = list(cases(2, kept=2))
LARGE = list(islice(cases(6, kept=3), len(SMALL), None, 389))
R, D = ("r", ()), ("d", ())


def test_shapes_are_told_apart_by_what_becomes_of_situations_and_how_they_nest() -> None:
    assert [said(forest) for forest in forests(2, kept=False)] == [
        "r(r)", "r(d)", "r(a)", "d(d)", "a(a)", "r r", "d r", "d d", "a r", "a d", "a a",
    ]  # fmt: skip
    assert [len(forests(size, kept=False)) for size in range(1, 7)] == [3, 11, 40, 153, 596, 2400]
    assert len({said(forest) for forest in forests(5, kept=True)}) == len(forests(5, kept=True)) == 2105


@pytest.mark.parametrize("sample", [SMALL[0::2], SMALL[1::2], LARGE])
def test_a_crash_or_a_power_loss_at_any_step_leaves_the_old_structure_or_the_new(sample: list[Case]) -> None:
    found = [looked_at(case, cuts=False) for case in sample]
    assert [wrong for finding in found for wrong in finding.wrong] == []
    assert min(finding.crashes for finding in found) > 40
    assert min(finding.recovered for finding in found) >= 2


def test_a_link_that_is_cut_at_any_frame_costs_nothing_but_time() -> None:
    found = [looked_at(case, cuts=True) for case in SMALL[1::9]]
    assert [wrong for finding in found for wrong in finding.wrong] == []
    assert min(finding.cuts for finding in found) >= 3


# --------------------------------------------------------------------------------------- each defect is seen


def seen(way: str = "drain", *, cuts: bool = False) -> Finding:
    return looked_at(Case((R, D), way), cuts=cuts)  # type: ignore[arg-type]  # one of the ways


def test_a_commit_that_is_not_synced_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(SimulatedDisk, "sync", lambda self: None)
    assert any("power at" in wrong and "told new" in wrong for wrong in seen().wrong)


def test_an_adaptation_that_counts_from_its_beginning_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    write = Journal.write

    def hasty(self: Journal, *records: Any, sync: bool = True) -> None:
        write(self, *records, sync=sync)
        for record in records:
            if isinstance(record, Begun) and record.adaptation.id == 2:
                write(self, Decided(2, "applied", record.time))

    monkeypatch.setattr(Journal, "write", hasty)
    assert any("told old: new" in wrong for wrong in seen("late").wrong)


def test_a_reaction_that_does_not_come_back_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    reactions = recovery._reactions
    monkeypatch.setattr(recovery, "_reactions", lambda reactor, equation: reactions(reactor, equation)[1:])
    assert any("runs" in wrong for wrong in seen().wrong)


def test_a_message_that_is_never_sent_again_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    due = Session.due

    def once(self: Session, now: float) -> list[bytes]:
        self._sent_at = dict.fromkeys(self._sent_at, now)
        return due(self, now)

    monkeypatch.setattr(Session, "due", once)
    assert any("the planner hears []" in wrong for wrong in seen(cuts=True).wrong)


@pytest.mark.parametrize("way", ["wait", "versions"])
def test_what_a_root_asserts_goes_by_a_drain_alone(way: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """In mode wait the root asserted again before it was killed: the adaptation stood half-way for ever."""
    assert seen(way).wrong == []
    monkeypatch.setattr(adaptation, "refuse_unsafe_kills", lambda adaptation, killed: None)
    assert way == "versions" or any("law 1" in wrong for wrong in seen(way).wrong)
