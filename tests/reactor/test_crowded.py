"""At the limit of its processes a reactor is changed no more: what an adaptation adds must have room (laws 1, 13)."""

from __future__ import annotations

import pytest
from msgspec.structs import replace

from planner_reactor.link.messages import Adaptation
from planner_reactor.reactor import reactor as module
from planner_reactor.runtime import Budgets
from tests.reactor.driving import FIRST, SECOND, Bench

CROWD = Adaptation(id=3, definitions="P[9] = Delay[0.01] :: Long", adds=(9,))
LAST = replace(SECOND, definitions=SECOND.definitions.replace("P[4]", "P[10]"), adds=(10,))
MOST = 400


@pytest.fixture
def bench(monkeypatch: pytest.MonkeyPatch) -> Bench:
    monkeypatch.setattr(module, "Budgets", lambda: Budgets(processes=MOST))
    return Bench()


def test_an_adaptation_without_room_is_refused_whole_and_says_why(bench: Bench) -> None:
    bench.at(0.0, FIRST)
    bench.at(0.5, CROWD)
    bench.at(20.0, LAST)
    bench.run(60.0)
    answers = {p.subject: p.cause for p in bench.perceptions() if p.kind.startswith("adaptation")}
    assert answers[str(LAST.id)] == "budget"
    assert len(bench.times("crowded")) > 0
    assert bench.reactor.laws.violations == []


def test_where_there_is_room_it_is_applied(bench: Bench) -> None:
    bench.at(0.0, FIRST)
    bench.at(20.0, LAST)
    bench.run(60.0)
    assert {p.subject: p.cause for p in bench.perceptions()}[str(LAST.id)] == ""
