"""Ten thousand random schedules: always the ω-ideal reactor of the assumptions that survive, never an unsafe state."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from msgspec.structs import replace

from planner_reactor.link.messages import Adaptation, Change
from planner_reactor.planner.relaxing import Assuming
from tests.schedules.__main__ import live
from tests.schedules.ledger import Ledger, Unsafe
from tests.schedules.life import Life, Tally
from tests.schedules.whole import WholeLife

PLAN = {"cafe": range(186), "greenhouse": range(95 * 20, 95 * 20 + 12), "kitting": range(99 * 20, 99 * 20 + 2)}
"""Lives of 50 schedules each: 10,000 schedules."""


@pytest.mark.parametrize("part", range(5))
def test_every_schedule_ends_in_the_ideal_reactor_of_the_assumptions_that_survive(part: int) -> None:
    numbers = [number for lives in PLAN.values() for number in lives][part::5]
    total = Tally()
    for number in numbers:
        tally, wrong = live(number)
        assert not wrong
        total.add(tally)
    assert total.schedules == 50 * len(numbers) == 2000
    assert total.issued > 1000
    assert total.unapplied > 50
    assert len(total.reached) > 8


@pytest.mark.parametrize("number", [14708])
def test_a_life_that_went_wrong_once_goes_right(number: int) -> None:
    """14708: a HOLDMONITOR that an adaptation takes away comes again with the next; the first is refused."""
    assert not live(number)[1]


@pytest.mark.parametrize(("name", "seed"), [("cafe", 1), ("cafe", 2), ("greenhouse", 3)])
def test_so_it_does_with_the_real_reactor_under_it(name: str, seed: int) -> None:
    life = WholeLife(name, True, seed)
    for n in range(10):
        life.run(f"{seed}.{n}")
    assert life.loop.issued > 5


def test_what_flaps_faster_than_its_monitor_reads_costs_no_more_than_the_bound() -> None:
    """Guests are looked for every 2 s, and come or go every 0.7 s."""
    life, lasts = WholeLife("cafe", True, 1, period_ms=2000), 1000.0

    def turn() -> None:
        life.truth["Guests"] = not life.truth["Guests"]
        life.loop.scheduler.call_after(0.7, turn)

    life.loop.scheduler.soon(turn)
    life.loop.reactor.executer.run(until=life.loop.scheduler.now + lasts)
    causes = [r.cause for r in life.loop.planner.relaxations if r.assumption == "Guests"]
    assert 4 < causes.count("reinstated") <= 7 + lasts / (64 * 2.0)
    assert life.loop.issued < 5 * len(causes) + 10
    assert life.loop.reactor.laws.violations == []


# ------------------------------------------------------------------------------------- what is asked can be refused

REACTION = "SIT[s]<k> :; (~(Work : SUCCEED[s, k]) : FAIL[s, k])"
STANDS = Adaptation(
    id=1, definitions=f"P[0] = STOP :; ASSERT[s]\nP[1] = {REACTION}\n", adds=(1, 0),
    changes=(Change(situation="s", base=0, fresh=True, assumptions=("A",)),),
)  # fmt: skip
AGAIN = Adaptation(
    id=2, definitions=f"P[2] = {REACTION}\n", adds=(2,), kills=(1,), changes=(Change(situation="s", base=1),)
)


@pytest.mark.parametrize(("wrong", "because"), [
    (replace(AGAIN, changes=(Change(situation="s", base=0),)), "planned against another s"),
    (replace(AGAIN, kills=()), "served by 1 and by 2"),
    (replace(AGAIN, kills=(1, 7)), "does not stand"),
    (replace(AGAIN, definitions="", adds=()), "asserted"),
    (replace(AGAIN, definitions=AGAIN.definitions.replace("P[2]", "P[1]")), "used before"),
    (replace(AGAIN, definitions=AGAIN.definitions.replace("Work", "ASSERT[other]")), "asserted"),
])  # fmt: skip
def test_an_unsafe_adaptation_is_seen(wrong: Adaptation, because: str) -> None:
    ledger = Ledger()
    ledger.apply(STANDS)
    with pytest.raises(Unsafe, match=because):
        ledger.apply(wrong)


def test_a_planner_that_forgets_a_failure_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    fails = Assuming.fails
    monkeypatch.setattr(Assuming, "fails", lambda self, name: name != "Guests" and fails(self, name))
    assert any(live(number)[1] for number in range(5))


def test_a_planner_that_takes_back_what_did_not_return_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    def eager(self: Assuming, name: str) -> bool:
        self._returning[name] = None
        return name not in self.beliefs.relaxed

    monkeypatch.setattr(Assuming, "fails", eager)
    assert any(live(number)[1] for number in range(5))


def test_returns_without_hysteresis_are_found(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("planner_reactor.planner.relaxing.MOST_DOUBLINGS", 0)
    life = Life("cafe", True)
    assert any("came back" in problem for problem in _problems(life, 400))


def _problems(life: Life, schedules: int) -> Iterator[str]:
    for n in range(schedules):
        try:
            life.run(f"flapping {n}")
        except Unsafe as problem:
            yield str(problem)
