"""The nine assumptions in any order: every pair, all 2⁹ sets, and a sample of the 9! (R §7.3, §7.5)."""

from __future__ import annotations

import itertools

import pytest

from planner_reactor.workcell.evidence import ASSUMPTIONS
from tests.schedules.ledger import Unsafe
from tests.schedules.life import ideal
from tests.schedules.orders import Order, drawn, relaxes, walks


@pytest.mark.parametrize("first", ASSUMPTIONS)
def test_every_pair_one_after_the_other_or_at_once(first: str) -> None:
    for second in ASSUMPTIONS:
        if second != first:
            assert relaxes(Order((first, second), at_once=1 + (second > first), between=5)) >= 1


@pytest.mark.parametrize("part", range(3))
def test_orders_at_random_forced_and_by_choice_mixed(part: int) -> None:
    orders = [drawn(seed) for seed in range(part, 24, 3)]
    compared = sum(relaxes(order) for order in orders)
    assert compared > 3 * len(orders)
    assert any(order.by_choice for order in orders)


@pytest.mark.parametrize("given_up", [("ACT", "AM", "AO"), ("AQ", "ADT")], ids="+".join)
def test_the_reactor_reached_is_the_one_planned_from_scratch(given_up: tuple[str, ...]) -> None:
    """Of all 2⁹ sets (`python -m tests.schedules --sets`) 64: one assumption fails or returns at a time."""
    assert walks(given_up, [name for name in ASSUMPTIONS if name not in given_up][:5]) == 32


def test_the_orders_drawn_are_all_kinds_of_orders() -> None:
    orders = [drawn(seed) for seed in range(200)]
    assert len({order.names for order in orders}) == 200
    assert {order.at_once for order in orders} == {1, 2, 3, 9}
    pairs = {(a, b) for order in orders for a, b in itertools.pairwise(order.names)}
    assert len(pairs) == 72


def test_another_reactor_than_that_from_scratch_would_be_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    def another(name: str, returning: bool, relaxed: frozenset[str]) -> object:
        return ideal(name, returning, relaxed - {"ADT"})

    monkeypatch.setattr("tests.schedules.orders.ideal", another)
    with pytest.raises(Unsafe, match="from scratch"):
        relaxes(Order(("ADT", "AQ")))
