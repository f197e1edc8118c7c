"""Adaptations that are under way at the same time fit together, or the later is refused (laws 1, 7)."""

from __future__ import annotations

import re
from collections.abc import Callable

import pytest
from msgspec.structs import replace

from planner_reactor.link.messages import Adaptation
from planner_reactor.reactor import adaptation as adaptations
from planner_reactor.reactor import admission
from planner_reactor.reactor.admission import Standing
from planner_reactor.reactor.journal import Journal
from tests.reactor.disks import TornDisk
from tests.reactor.driving import FIRST, SECOND, Bench, change

REMOVE = Adaptation(id=2, removed=("work", "part"), kills=(0, 1, 2, 3))

BASE = replace(
    FIRST,
    definitions=FIRST.definitions
    + """
    P[10] = Delay[1] :; ASSERT[over]
    P[11] = SIT[over]<k> :; (Do[over, 2] : SUCCEED[over, k])
    P[12] = Delay[1] :; ASSERT[under]
    P[13] = SIT[under]<k> :; (Do[under, 2] : SUCCEED[under, k])
    """,
    changes=(*FIRST.changes, change("over"), change("under")),
    adds=(*FIRST.adds, 13, 11, 12, 10),
)

OVER = Adaptation(
    id=2,
    definitions="P[20] = SIT[over]<k> :; (REASSERT[under] : SUCCEED[over, k])",
    changes=(change("over", 1),),
    kills=(11,),
    adds=(20,),
)
"""From now on `over` needs `under`."""

UNDER = Adaptation(
    id=3,
    definitions="P[21] = SIT[under]<k> :; (REASSERT[over] : SUCCEED[under, k])",
    changes=(change("under", 1),),
    kills=(13,),
    adds=(21,),
)

PART = replace(SECOND, definitions=SECOND.definitions.replace("P[4]", "P[40]"), adds=(40,))

OTHER = Adaptation(
    id=3,
    definitions="P[30] = SIT[other]<k> :; (REASSERT[part] : SUCCEED[other, k])",
    changes=(change("other"),),
    adds=(30,),
)

CONTENDING: dict[str, tuple[Adaptation, Adaptation, str]] = {
    "removed twice": (REMOVE, replace(REMOVE, id=3), "work is being changed"),
    "changed, then removed": (PART, replace(REMOVE, id=3), "part is being changed"),
    "killed twice": (PART, Adaptation(id=3, kills=(3,)), r"P\[3\] is being killed"),
    "asserted as it is removed": (REMOVE, OTHER, r"P\[30\] asserts part, which an earlier adaptation removes"),
    "removed as it is asserted": (OVER, Adaptation(id=3, removed=("under",), kills=(12, 13)), r"P\[20\] asserts under"),
    "each below the other": (OVER, UNDER, "over → under → over|under → over → under"),
}


def both(first: Adaptation, second: Adaptation) -> Bench:
    bench = Bench(journal=Journal(TornDisk()))
    bench.at(0.0, BASE)
    bench.at(1.4, first)
    bench.at(1.5, second)
    bench.run(1.6)
    assert bench.reactor.transactions.under_way[0].adaptation.id == 2
    return bench


@pytest.mark.parametrize(("first", "second", "why"), CONTENDING.values(), ids=list(CONTENDING))
def test_what_does_not_fit_what_is_under_way_is_refused(first: Adaptation, second: Adaptation, why: str) -> None:
    bench = both(first, second)
    told = [p for p in bench.perceptions() if p.kind == "adaptation_refused"]
    assert [(p.subject, p.cause) for p in told] == [("3", "pending")]
    assert re.search(why, str(told[0].values[0]))
    bench.run(20.0)
    assert [p.subject for p in bench.perceptions() if p.kind == "adaptation_applied"] == ["2"]
    assert bench.reactor.laws.violations == []


def test_what_fits_is_applied_while_the_other_is_under_way() -> None:
    bench = both(OVER, replace(PART, id=3))
    bench.run(20.0)
    assert {p.subject for p in bench.perceptions() if p.kind == "adaptation_applied"} == {"1", "2", "3"}
    assert bench.reactor.laws.violations == []


def test_an_adaptation_that_has_nothing_left_to_kill_after_its_commit_breaks_law_1(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """As it was: what an adaptation removes was not asked for among what is under way."""
    usual: Callable[[Adaptation, Standing], None] = admission._versions
    monkeypatch.setattr(admission, "_versions", lambda a, standing: usual(a, replace(standing, pending=())))
    monkeypatch.setattr(adaptations, "refuse_contention", lambda *_: None)
    bench = both(REMOVE, replace(REMOVE, id=3))
    bench.run(20.0)
    assert 1 in {violation.law for violation in bench.reactor.laws.violations}
    assert not [p for p in bench.perceptions() if p.kind == "adaptation_timed_out"]  # the journal says: applied


def test_a_reaction_that_ends_before_it_is_killed_takes_the_adaptation_back() -> None:
    bench = Bench(journal=Journal(TornDisk()))
    ending = FIRST.definitions.replace("Do[old, 2]", "Do[old, 4]") + "P[10] = Delay[1] # ASSUMONITOR[B, 1000]\n"
    bench.at(0.0, replace(FIRST, definitions=ending, adds=(*FIRST.adds, 10)))
    bench.at(0.2, replace(PART, kills=(2, 3, 10)))
    bench.run(20.0)
    told = [p for p in bench.perceptions() if p.kind == "adaptation_refused"]
    assert [(p.cause, p.values) for p in told] == [
        ("labels", ("P[10], which it kills, has ended by itself meanwhile",))
    ]
    assert sorted(bench.reactor.reactions) == sorted(bench.reactor.journal.state.committed.clauses) == [0, 1, 2, 3]
    assert not list(bench.reactor.situations.held)
    assert bench.reactor.laws.violations == []


def test_the_first_of_a_later_epoch_may_have_an_id_of_the_earlier() -> None:
    bench = Bench()
    bench.at(0.0, FIRST)
    bench.at(3.0, replace(SECOND, id=1, epoch=1))
    bench.run(10.0)
    assert [(p.subject, p.epoch) for p in bench.perceptions() if p.kind == "adaptation_applied"] == [("1", 0), ("1", 1)]
    assert bench.reactor.laws.violations == []


@pytest.mark.parametrize("epoch", [0, 1])
@pytest.mark.parametrize("hasty", [False, True])
def test_what_was_told_to_be_refused_is_spent_also_when_the_power_goes(
    hasty: bool, epoch: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    disk = TornDisk()
    bench = Bench(journal=Journal(disk))
    bench.at(0.0, FIRST)
    bench.run(3.0)
    early = replace(SECOND, epoch=epoch, changes=(change("part", 2),))  # it would do, were `part` at version 2
    if hasty:  # the defect that this is there for
        monkeypatch.setattr(disk, "sync", lambda: None)
    bench.reactor.receive(early)
    assert [p.cause for p in bench.perceptions() if p.kind == "adaptation_refused"] == ["stale"]
    again = Bench(journal=Journal(TornDisk(disk.durable)))
    again.run(1.0)
    again.reactor.receive(early)
    assert [p.cause for p in again.perceptions() if p.subject == "2"] == ["stale" if hasty else "repeated"]


def test_nothing_is_told_of_what_came_to_nothing_while_the_disk_takes_nothing() -> None:
    disk = TornDisk()
    bench = Bench(journal=Journal(disk))
    bench.at(0.0, FIRST)
    bench.run(3.0)
    disk.sync_fails = True
    bench.reactor.receive(replace(SECOND, changes=(change("part", 7),)))
    bench.run(4.0)
    assert [p.kind for p in bench.perceptions()] == ["adaptation_applied", "error"]
    disk.sync_fails = False
    bench.run(6.0)
    assert [(p.kind, p.cause) for p in bench.perceptions()] == [("adaptation_refused", "stale")]
