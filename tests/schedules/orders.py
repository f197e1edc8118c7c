"""Nine assumptions given up in any order: by force, by choice, several at once; always the reactor for what is left.

By choice the planner takes the least likely first, so an order of its choice is an order of likelihoods. Those that
fail come in their own order, in bursts, between any two of its steps. Whenever it has nothing left to issue, its
reactor must be the one planned from scratch.
"""

from __future__ import annotations

import random
import re
from collections.abc import Sequence

import msgspec

from planner_reactor.link.messages import PerceptionKind
from planner_reactor.logic.domain import Domain
from planner_reactor.logic.reader import read_domain
from planner_reactor.planner import Planner
from planner_reactor.workcell.evidence import ASSUMPTIONS
from tests.planner.driving import KITTING, Book, applied, image, kitting, perception, reinstatable, settle
from tests.schedules.ledger import Ledger, Unsafe
from tests.schedules.life import ideal


class Order(msgspec.Struct, frozen=True):
    """An order of the nine; which of them are given up by choice; how many fail at once; steps between bursts."""

    names: tuple[str, ...]
    by_choice: frozenset[str] = frozenset()
    at_once: int = 1
    between: int = 1000  # steps; many: until there is nothing to do


def drawn(seed: int) -> Order:
    """The order of a seed."""
    draw = random.Random(f"order {seed}")
    names = tuple(draw.sample(ASSUMPTIONS, len(ASSUMPTIONS)))
    by_choice = frozenset(name for name in names if draw.random() < draw.choice((0.0, 0.4)))
    return Order(names, by_choice, draw.choice((1, 1, 2, 3, 9)), draw.choice((0, 3, 12, 1000)))


def likely(names: Sequence[str]) -> Domain:
    """The shipped domain, with the first of these the least likely to hold."""

    def place(found: re.Match[str]) -> str:
        return f"{found[1]}likelihood {(names.index(found[2]) + 1) / 10}"

    return read_domain(re.sub(r"(atp_assumption (\w+)\(\)\s+)likelihood [\d.]+", place, KITTING.read_text()))


def relaxes(order: Order) -> int:
    """Give them up in this order; how many times the reactor was compared with one planned from scratch."""
    domain = likely(order.names) if len(order.names) == len(ASSUMPTIONS) else kitting()
    planner = Planner(domain, relax=tuple(sorted(order.by_choice)), verify=False)
    ledger, compared = Ledger(), 0
    forced = [name for name in order.names if name not in order.by_choice]
    compared += _steps(planner, ledger, order.between)
    while forced:
        for name in forced[: order.at_once]:
            planner.perceive(perception("assumption_failure", name))
        del forced[: order.at_once]
        compared += _steps(planner, ledger, order.between)
    compared += _steps(planner, ledger, 100_000)
    if set(planner.relaxed) != set(order.names) or planner.breaches:
        raise Unsafe(f"{order}: relaxed {planner.relaxed}, {planner.breaches}")
    return compared


def walks(given_up: Sequence[str], flipped: Sequence[str]) -> int:
    """Without `given_up`, all sets of `flipped`: one fails or returns at a time, by the Gray code; how many sets."""
    domain = reinstatable(KITTING)
    planner, book = Planner(domain, relax=(), verify=False), Book(domain, loads=False)
    for name in given_up:
        planner.perceive(perception("assumption_failure", name))
    settle(planner, book)
    compared = _compare(planner)
    for n in range(1, 2 ** len(flipped)):
        name = flipped[(n & -n).bit_length() - 1]
        kind: PerceptionKind = "assumption_holds" if name in planner.relaxed else "assumption_failure"
        planner.perceive(perception(kind, name))
        settle(planner, book)
        compared += _compare(planner)
    return compared


def _steps(planner: Planner, ledger: Ledger, most: int) -> int:
    """So many steps, each adaptation applied; compares whenever the reactor is ideal."""
    compared = 0
    for _ in range(most):
        step = planner.step()
        if step is None:
            break
        for adaptation in step.adaptations:
            ledger.apply(adaptation)
            planner.perceive(applied(adaptation))
        if planner.ideal:
            compared += _compare(planner)
    return compared


def _compare(planner: Planner) -> int:
    relaxed = frozenset(planner.relaxed)
    if image(planner) != ideal("kitting", False, relaxed):
        raise Unsafe(f"not what planning from scratch gives without {sorted(relaxed)}")
    return 1
