"""From an order of steps to a composition: series, parallel, maintained, choices, and what is neither."""

from __future__ import annotations

import random
from collections.abc import Mapping
from types import MappingProxyType

from planner_reactor.logic.domain import ActionSchema, Duration
from planner_reactor.planner.plan import BEFORE, CONTAINS, Plan
from planner_reactor.planner.structure import (
    NOTHING,
    Choice,
    During,
    InOrder,
    Run,
    Together,
    Tree,
    actions_of,
    arrange,
    first_action,
)


def plan_of(names: str, *orders: tuple[str, str, int], lasting: Mapping[str, float] = MappingProxyType({})) -> Plan:
    plan = Plan()
    for name in names:
        plan.add(ActionSchema(name, duration=Duration(lasting[name], lasting[name]) if name in lasting else None))
    for first, second, relation in orders:
        assert plan.order(names.index(first), names.index(second), relation)
    return plan


def before(*pairs: str) -> list[tuple[str, str, int]]:
    return [(pair[0], pair[1], BEFORE) for pair in pairs]


def shown(tree: Tree) -> str:
    match tree:
        case Run(action):
            return action.name
        case InOrder(parts):
            return "(" + ":".join(map(shown, parts)) + ")"
        case Together(parts):
            return "(" + "&".join(map(shown, parts)) + ")"
        case During(action, inner):
            return f"({action.name}#{shown(inner)})"
        case Choice(test, then, otherwise):
            return f"(if {test.name} {shown(then)} else {shown(otherwise)})"


def test_what_is_ordered_is_a_sequence_and_what_is_not_stands_side_by_side() -> None:
    assert shown(arrange(plan_of("abc", *before("ab", "bc")), {})) == "(a:b:c)"
    assert shown(arrange(plan_of("abc"), {})) == "(a&b&c)"
    assert shown(arrange(plan_of("abcd", *before("ac", "bc", "cd")), {})) == "((a&b):c:d)"
    assert shown(arrange(plan_of("abcd", *before("ab", "cd")), {})) == "((a:b)&(c:d))"


def test_no_steps_are_nothing_to_do() -> None:
    assert arrange(Plan(), {}) == NOTHING
    assert first_action(NOTHING) is None


def test_what_lasts_through_another_is_composed_with_it() -> None:
    plan = plan_of("lgtm", ("t", "g", CONTAINS), *before("lt", "lg", "gm"))
    assert shown(arrange(plan, {})) == "(l:(t#g):m)"


def test_several_steps_may_happen_while_one_lasts() -> None:
    plan = plan_of("tab", ("t", "a", CONTAINS), ("t", "b", CONTAINS), *before("ab"))
    assert shown(arrange(plan, {})) == "(t#(a:b))"


def test_an_order_that_is_not_series_parallel_is_made_stricter() -> None:
    """a<c, b<c, b<d: no nesting of `:` and `&` says just that."""
    plan = plan_of("abcd", *before("ac", "bc", "bd"))
    tree = arrange(plan, {})
    assert shown(tree) == "((a&b):(c&d))"
    assert {action.name for action in actions_of(tree)} == set("abcd")


def test_it_is_made_stricter_where_that_costs_least() -> None:
    """It takes 12 s. First what waits for nothing, then the rest, would take 20: `a` and `d` would take turns."""
    lasting = {"a": 10e3, "b": 1e3, "c": 1e3, "d": 10e3}
    plan = plan_of("abcd", *before("ac", "bc", "bd"), lasting=lasting)
    assert shown(arrange(plan, {})) == "((a&(b:d)):c)"


def test_what_one_alone_waits_for_does_not_hold_up_the_others() -> None:
    """Each of two things is fetched for itself, and put where both can only be put once a place is made."""
    lasting = {"f": 2e3, "g": 2e3, "m": 5e3, "p": 3e3, "q": 3e3}
    plan = plan_of("fgmpq", *before("fp", "gq", "mp", "mq"), lasting=lasting)
    assert shown(arrange(plan, {})) == "((f&g&m):(p&q))"


def test_orders_that_are_not_series_parallel_are_kept_whatever_they_are() -> None:
    rng = random.Random(5)
    for _ in range(300):
        names = "abcdef"[: rng.randrange(3, 7)]
        pairs = [x + y for n, x in enumerate(names) for y in names[n + 1 :] if rng.random() < 0.4]
        plan = plan_of(names, *before(*pairs), lasting={name: rng.randrange(1, 9) * 1e3 for name in names})
        tree = arrange(plan, {})
        ended = ends(tree, dict.fromkeys(names, 0.0), 0.0)
        assert sorted(action.name for action in actions_of(tree)) == sorted(names)
        assert all(ended[pair[0]] < ended[pair[1]] for pair in pairs)
        assert all(follows(tree, pair) for pair in pairs)


def ends(tree: Tree, found: dict[str, float], start: float) -> dict[str, float]:
    """When each action ends if each takes one second."""
    match tree:
        case Run(action):
            found[action.name] = start + 1
        case InOrder(parts):
            for part in parts:
                ends(part, found, start)
                start = max(found[action.name] for action in actions_of(part))
        case Together(parts):
            for part in parts:
                ends(part, found, start)
    return found


def follows(tree: Tree, pair: str) -> bool:
    """Does the second certainly begin after the first has ended?"""
    match tree:
        case InOrder(parts):
            places = {action.name: n for n, part in enumerate(parts) for action in actions_of(part)}
            first, second = places.get(pair[0]), places.get(pair[1])
            return first is not None and (first < second if first != second else follows(parts[first], pair))  # type: ignore[operator]
        case Together(parts):
            return any(follows(part, pair) for part in parts if set(pair) <= {a.name for a in actions_of(part)})
    return False


def test_a_test_that_is_planned_for_comes_as_early_as_it_can() -> None:
    plan = plan_of("pqt", *before("tq", "pq"))
    assert shown(arrange(plan, {2: NOTHING})) == "(if t (p:q) else ())"


def test_what_must_come_before_a_test_stands_before_it() -> None:
    plan = plan_of("pqtr", *before("pt", "tq", "qr"))
    assert shown(arrange(plan, {2: NOTHING})) == "(p:(if t (q:r) else ()))"


def test_tests_nest() -> None:
    plan = plan_of("stq", *before("sq", "tq"))
    assert shown(arrange(plan, {0: NOTHING, 1: NOTHING})) == "(if s (if t q else ()) else ())"
