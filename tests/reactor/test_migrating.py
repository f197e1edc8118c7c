"""A situation whose new reactions take other parameters: what waits for it is carried over, or it is refused."""

from __future__ import annotations

from collections.abc import Generator, Iterator

import pytest
from msgspec.structs import replace

from planner_reactor.link.messages import Adaptation, Change
from planner_reactor.reactor.adaptation import script
from planner_reactor.rs.printer import show
from planner_reactor.runtime import Host
from tests.reactor.driving import Bench, change

FIRST = Adaptation(
    id=1,
    definitions="""
    P[0] = Order<n> :: ASSERT[kit, n]
    P[1] = SIT[kit]<k, n> :; (~(Do[n, 3] : SUCCEED[kit, k]) : FAIL[kit, k])
    """,
    changes=(change("kit"),),
    adds=(1, 0),
)
"""Orders come one a second, and take three seconds each."""

SECOND = Adaptation(
    id=2,
    definitions="""
    P[2] = Order<n> :: ASSERT[kit, n, 1]
    P[3] = SIT[kit]<k, n, size> :: (~(Do[n, size] : SUCCEED[kit, k]) : FAIL[kit, k])
    """,
    changes=(Change(situation="kit", base=1, migrate=(1, "usual")),),
    kills=(0, 1),
    adds=(3, 2),
)


def bench() -> Bench:
    host, numbers = Host("orders"), iter(range(1, 7))

    @host.process(window=(0.0, 5.0))
    def Do(what: float, seconds: float) -> Iterator[float]:
        yield seconds

    @host.process(window=(0.0, 2000.0), results=("n",))
    def Order() -> Generator[float, None, float]:
        yield 1.0
        if (number := next(numbers, None)) is None:
            yield 1500.0
        return number or 0

    @host.function
    def usual(n: float) -> float:
        return 2

    @host.function
    def both(n: float, m: float) -> float:
        return n

    @host.function
    def fails(n: float) -> float:
        raise ValueError("as announced")

    return Bench(host=host)


def after(adaptation: Adaptation, until: float = 40.0) -> Bench:
    made = bench()
    made.at(0.0, FIRST)
    made.at(1.5, adaptation)
    made.run(until)
    return made


def test_the_script_migrates_before_anything_is_removed() -> None:
    assert show(script(SECOND, ())) == (
        "DRAIN[kit] : COMMIT[2] : MIGRATE[kit, 1, usual] : KILL[0] : KILL[1] : POST[3] : POST[2] : UNINHIBIT[kit]"
    )


def test_orders_that_wait_are_served_by_the_new_reaction_though_who_took_them_is_gone() -> None:
    made = after(SECOND)
    assert made.reactor.laws.violations == []
    applied = made.times("adaptation_applied", id=2)[0]
    queued = [e for e in made.trace.of("queued") if e.time < applied]
    assert len(queued) >= 2
    assert [e.data["arguments"] for e in made.trace.of("migrated")] == [(n, 2) for n in range(2, 2 + len(queued))]
    given = [e.data["arguments"] for e in made.trace.of("asserted")]
    assert {arguments[0] for arguments in given} == set(range(1, 7))  # no order is lost
    assert made.reactor.situations.instances == {}  # and each was served to its end


def test_without_a_migration_they_would_go_with_their_root() -> None:
    made = after(replace(SECOND, changes=(Change(situation="kit", base=1),)))
    assert made.reactor.laws.violations == []
    given = {e.data["arguments"][0] for e in made.trace.of("asserted")}
    assert given != set(range(1, 7))


def test_what_cannot_be_migrated_fails_and_nothing_else() -> None:
    made = after(replace(SECOND, changes=(Change(situation="kit", base=1, migrate=(1, "fails")),)))
    assert made.times("adaptation_applied", id=2)
    assert {e.data["cause"] for e in made.trace.of("unqueued")} == {"error"}
    assert made.reactor.laws.violations == []


@pytest.mark.parametrize(
    ("changes", "why"),
    [
        ({"migrate": (1, "usal")}, "no function usal is registered, did you mean usual?"),
        ({"migrate": (1, "both")}, "both does not take the 1 arguments that kit had"),
        ({"migrate": (1, 2)}, "kit had 1 arguments: there is no argument 2"),
        ({"migrate": (1,)}, "kit takes 2 arguments, and 1 are made for it"),
        ({"mode": "versions"}, "nothing of kit is held back in mode versions: expected mode drain"),
        ({"mode": "versions", "migrate": None}, "kit took 1 arguments, it takes 2: expected mode drain, or"),
        ({"mode": "wait"}, "nothing of kit is held back in mode wait: expected mode drain"),
        ({"kills": (1,), "adds": (3,)}, "P[0] asserts kit with 1 arguments, it takes 2"),
    ],
)
def test_what_cannot_be_is_refused(changes: dict[str, object], why: str) -> None:
    how = {name: value for name, value in changes.items() if name == "migrate"}
    rest = {name: value for name, value in changes.items() if name != "migrate"}
    wrong = replace(SECOND, changes=(replace(SECOND.changes[0], **how),), **rest)
    if rest.get("mode") == "versions":  # a root has no versions
        wrong = replace(wrong, kills=(1,), adds=(3,))
    if "adds" in rest or wrong.adds == (3,):
        wrong = replace(wrong, definitions=SECOND.definitions.strip().splitlines()[1])
    made = after(wrong, until=2.0)
    (refused,) = [p for p in made.perceptions() if p.kind == "adaptation_refused"]
    assert refused.cause == "migrate"
    assert str(refused.values[0]).startswith(why)
