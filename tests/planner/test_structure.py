"""From an order of steps to a composition: series, parallel, maintained, choices, and what is neither."""

from __future__ import annotations

from planner_reactor.logic.domain import ActionSchema
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


def plan_of(names: str, *orders: tuple[str, str, int]) -> Plan:
    plan = Plan()
    for name in names:
        plan.add(ActionSchema(name))
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


def test_a_test_that_is_planned_for_comes_as_early_as_it_can() -> None:
    plan = plan_of("pqt", *before("tq", "pq"))
    assert shown(arrange(plan, {2: NOTHING})) == "(if t (p:q) else ())"


def test_what_must_come_before_a_test_stands_before_it() -> None:
    plan = plan_of("pqtr", *before("pt", "tq", "qr"))
    assert shown(arrange(plan, {2: NOTHING})) == "(p:(if t (q:r) else ()))"


def test_tests_nest() -> None:
    plan = plan_of("stq", *before("sq", "tq"))
    assert shown(arrange(plan, {0: NOTHING, 1: NOTHING})) == "(if s (if t q else ()) else ())"
