"""Journals to test with: what a reactor writes when it is adapted many times."""

from __future__ import annotations

from collections.abc import Iterable
from functools import reduce

from planner_reactor.link.messages import Adaptation, Change
from planner_reactor.reactor.journal import HEADER, Assumed, Begun, Decided, Record, State, after, framed


def adaptation(number: int, *, epoch: int = 0) -> Adaptation:
    situation = f"S{number % 5}"
    return Adaptation(
        id=number,
        epoch=epoch,
        definitions=f"P[{number}] = SIT[{situation}]<k> :; SUCCEED[{situation}, k]",
        changes=(Change(situation=situation, base=(number - 1) // 5, assumptions=(f"A{number % 3}",)),),
        kills=(number - 5,) if number > 5 else (),
        adds=(number,),
    )


def history(many: int) -> list[Record]:
    """Adaptations that are applied, but every seventh, and an assumption that fails now and then."""
    records: list[Record] = []
    for number in range(1, many + 1):
        records.append(Begun(adaptation(number), float(number)))
        if number % 4 == 0:
            records.append(Assumed(f"A{number % 3}", number % 8 == 0, float(number)))
        records.append(Decided(number, "timed_out" if number % 7 == 0 else "applied", number + 0.5))
    return records


def written(records: Iterable[Record]) -> bytes:
    """One file with these records."""
    return HEADER + b"".join(framed(r, n) for n, r in enumerate(records, 1))


def fold(records: Iterable[Record]) -> State:
    """What these records come to."""
    return reduce(after, records, State())
