"""No adaptation takes longer than its bound, and a worst case takes as long; `ADAPTATIONS` says how many are tried."""

from __future__ import annotations

import os

import pytest

from planner_reactor.link.messages import Adaptation, Change
from planner_reactor.rs.bounds import Bounds
from tests.reactor.bounded import Adapted, Observed, random_adaptations

ADAPTATIONS = int(os.environ.get("ADAPTATIONS", "1000"))
CHUNK, EACH = 100, 10


@pytest.mark.parametrize("chunk", range(max(1, ADAPTATIONS // CHUNK)))
def test_every_observed_latency_is_within_the_computed_bound(chunk: int) -> None:
    late, waited = [], 0
    for seed in range(chunk * CHUNK // EACH, (chunk + 1) * CHUNK // EACH):
        for number, seen in enumerate(random_adaptations(seed, EACH)):
            assert not seen.violations, seed
            if seen.took is None or seen.took > seen.bound + 1e-6:
                late.append((seed, number, seen))
            waited += bool(seen.took)
    assert not late
    assert waited > CHUNK / 4  # most of them find something in service


def test_a_constructed_worst_case_takes_as_long_as_its_bound() -> None:
    """A body that has just begun its slowest child, whose failure leads to the slowest rest, and then another root."""
    first = Adaptation(
        id=1,
        definitions="""
        P[0] = STOP :; ASSERT[top]
        P[1] = Delay[23.9] :; ASSERT[part]
        P[2] = SIT[top]<k> :; (~((~REASSERT[part] : Long) : SUCCEED[top, k]) : FAIL[top, k])
        P[3] = SIT[part]<k> :; (~((Long : Slow) : SUCCEED[part, k]) : FAIL[part, k])
        """,
        changes=(Change(situation="top", base=0, fresh=True), Change(situation="part", base=0, fresh=True)),
        adds=(3, 2, 1, 0),
    )
    second = Adaptation(
        id=2,
        definitions="""
        P[4] = SIT[top]<k> :; (~(REASSERT[part] : SUCCEED[top, k]) : FAIL[top, k])
        P[5] = SIT[part]<k> :; (~(Slow : SUCCEED[part, k]) : FAIL[part, k])
        """,
        changes=(Change(situation="top", base=1), Change(situation="part", base=1)),
        kills=(2, 3),
        adds=(5, 4),
    )
    adapted = Adapted(first, seed=1, share=1.0)
    adapted.run(0.0)
    adapted.run(0.001)
    seen = adapted.adapt(second)
    assert seen.bound == 38.0  # (10 + 4) + 10 for the top, then 10 + 4 for the part that the other root asked for
    assert seen.took is not None
    assert 0.95 * seen.bound <= seen.took <= seen.bound


def test_a_bound_that_forgets_what_is_left_behind_is_seen_to_be_too_small(monkeypatch: pytest.MonkeyPatch) -> None:
    """The `#` takes its ASSERT back after a second; the instance is served on, and its owner waits for it."""
    first = Adaptation(
        id=1,
        definitions="""
        P[0] = STOP :; ASSERT[top]
        P[1] = SIT[top]<k> :; ((REASSERT[part] # Delay[1]) ; SUCCEED[top, k])
        P[2] = SIT[part]<k> :; (Long ; SUCCEED[part, k])
        """,
        changes=(Change(situation="top", base=0, fresh=True), Change(situation="part", base=0, fresh=True)),
        adds=(2, 1, 0),
    )
    second = Adaptation(
        id=2,
        definitions="P[3] = SIT[top]<k> :; (Delay[1] ; SUCCEED[top, k])",
        changes=(Change(situation="top", base=1),),
        kills=(1,),
        adds=(3,),
    )

    def seen() -> Observed:
        adapted = Adapted(first, seed=1, share=1.0)
        adapted.run(0.0)
        adapted.run(0.001)
        return adapted.adapt(second)

    right = seen()
    assert right.took is not None
    assert 0.95 * right.bound <= right.took <= right.bound == 10.0
    monkeypatch.setattr(Bounds, "_asserts", lambda self, process: ())
    assert seen() == Observed(1.0, None, ())  # given up at its deadline
