"""Undoing an adaptation, and applying several all or none."""

from __future__ import annotations

import msgspec
import pytest

from planner_reactor.errors import InputError
from planner_reactor.link.messages import Adaptation
from planner_reactor.reactor.composition import together, undone
from tests.reactor.driving import FIRST, SECOND, Bench, change

replace = msgspec.structs.replace
OTHER = Adaptation(
    id=3,
    definitions="P[5] = SIT[work]<k> :; (~(REASSERT[part] : REASSERT[part] : SUCCEED[work, k]) : FAIL[work, k])",
    changes=(change("work", 1, "B"),),
    kills=(1,),
    adds=(5,),
)
REMOVAL = Adaptation(
    id=2,
    definitions="P[4] = SIT[work]<k> :; (~(Do[whole, 1] : SUCCEED[work, k]) : FAIL[work, k])",
    changes=(change("work", 1),),
    removed=("part",),
    kills=(1, 2),
    adds=(4,),
)


def bodies(bench: Bench) -> list[str]:
    """What the reactions say, without their labels."""
    return sorted(text.split("=", 1)[1] for text in bench.reactor.journal.state.committed.clauses.values())


@pytest.mark.parametrize("adaptation", [SECOND, REMOVAL], ids=["a change", "a removal"])
@pytest.mark.parametrize("mode", ["drain", "versions"])
def test_an_undone_adaptation_leaves_the_reactions_that_were(adaptation: Adaptation, mode: str) -> None:
    bench = Bench()
    bench.at(0.0, FIRST)
    bench.run(2.5)
    before, rests_on = bodies(bench), bench.reactor.journal.state.committed.rests_on
    bench.at(3.0, replace(adaptation, mode=mode))
    bench.run(10.0)
    assert bodies(bench) != before
    bench.reactor.undo(number=9)
    bench.run(20.0)
    assert bodies(bench) == before
    assert bench.reactor.journal.state.committed.rests_on == rests_on
    assert bench.times("entered", situation="part")[-1] > 15.0
    assert bench.reactor.laws.violations == []


def test_what_was_changed_again_is_not_undone() -> None:
    bench = Bench()
    bench.at(0.0, FIRST)
    bench.at(3.0, SECOND)
    third = replace(SECOND, id=3, definitions=SECOND.definitions.replace("P[4]", "P[6]"), kills=(4,), adds=(6,),
                    changes=(change("part", 2),))  # fmt: skip
    bench.run(5.0)
    second = bench.reactor.last_applied
    assert second is not None
    bench.at(6.0, third)
    bench.run(10.0)
    bench.reactor.receive(undone(SECOND, second.before, number=9, epoch=0, first_label=7))
    assert [p.cause for p in bench.perceptions() if p.kind == "adaptation_refused"] == ["stale"]


def test_where_nothing_was_applied_there_is_nothing_to_undo() -> None:
    with pytest.raises(InputError, match="nothing to undo"):
        Bench().reactor.undo(number=1)


def test_a_group_is_applied_as_one() -> None:
    bench = Bench()
    bench.at(0.0, FIRST)
    bench.at(3.0, together([OTHER, SECOND], number=7))
    bench.run(20.0)
    assert sorted(bench.reactor.reactions) == [0, 4, 5]
    changes = {e.time for kind in ("added", "removed") for e in bench.trace.of(kind) if e.time > 1.0}
    assert len(changes) == 1
    assert bench.reactor.laws.violations == []


def test_a_group_of_which_one_cannot_be_added_leaves_everything_as_it_was() -> None:
    bench = Bench()
    bench.at(0.0, FIRST)
    bench.run(2.5)
    before = bench.reactor.text()
    wrong = replace(SECOND, definitions=SECOND.definitions.replace("Do[new, 1]", "Doo[new, 1]"))
    bench.reactor.receive(together([OTHER, wrong], number=7))
    assert [p.cause for p in bench.perceptions() if p.kind == "adaptation_refused"] == ["text"]
    bench.run(20.0)
    assert bench.reactor.text() == before


def test_a_group_changes_a_situation_once_and_in_one_mode() -> None:
    with pytest.raises(InputError, match="part is changed by two"):
        together([SECOND, replace(SECOND, id=3)], number=7)
    with pytest.raises(InputError, match="one mode"):
        together([SECOND, replace(OTHER, mode="wait")], number=7)


def test_one_that_exceeds_its_bound_leaves_the_old_structure_to_the_letter() -> None:
    bench = Bench()
    slow = replace(FIRST, definitions=FIRST.definitions.replace("Do[old, 2]", "Long"))
    bench.at(0.0, slow)
    bench.run(2.5)
    before = bench.reactor.text(), bench.reactor.versions, bench.reactor.journal.state.committed.clauses
    bench.at(3.0, replace(SECOND, deadline=5.0))
    bench.run(30.0)
    after = bench.reactor.text(), bench.reactor.versions, bench.reactor.journal.state.committed.clauses
    assert after == before
    assert [p.kind for p in bench.perceptions() if p.subject == "2"] == ["adaptation_timed_out"]
    assert not bench.reactor.situations.held
    assert bench.reactor.laws.violations == []
