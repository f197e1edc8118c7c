"""MIGRATE: what is held back takes other arguments, and stays if whoever asserted it is removed (docs/language.md)."""

from __future__ import annotations

import pytest

from planner_reactor.rs.expressions import EvaluationError
from planner_reactor.rs.migration import migrated
from planner_reactor.rs.store import Store
from tests.rs.driving import following
from tests.rs.test_evolves import STOPS, run

FUNCTIONS = {"sum": lambda x, y: x + y, "fails": lambda *_: 1 / 0}


@pytest.mark.parametrize(
    ("old", "how", "new"),
    [
        ((7, "red"), (2, 1), ("red", 7)),
        ((7, "red"), (), ()),
        ((1, 2), (1, "sum", 1), (1, 3, 1)),
        ((1, 2), (3,), None),
        ((1, 2), (0,), None),
        ((1, 2), ("fails",), None),
        ((1, 2), ("som",), None),
        ((1,), ("sum",), None),
        ((1,), (1.5,), None),
    ],
)
def test_an_argument_is_an_old_one_or_what_a_function_makes_of_all(
    old: tuple[object, ...], how: tuple[object, ...], new: tuple[object, ...] | None
) -> None:
    assert migrated(old, how, FUNCTIONS) == new


def test_an_error_is_no_other_error() -> None:
    assert issubclass(EvaluationError, ValueError)


def test_migrate_changes_what_is_held_back_of_its_situation_and_nothing_else() -> None:
    held = Store().queued("s", (1, 2), None)[0].queued("t", (1, 2), None)[0].queued("s", (3, 4), None)[0]
    after = held.migrated("s", lambda old: old[::-1])
    assert [q.arguments for q in after.queue] == [(2, 1), (1, 2), (4, 3)]
    assert [q.kept for q in after.queue] == [True, False, True]
    assert [q.ticket for q in after.queue] == [q.ticket for q in held.queue]


def test_migrate_without_arguments_to_go_by_fails_the_assert() -> None:
    held = Store().queued("s", (1,), None)[0]
    assert [q.fate for q in held.migrated("s", lambda old: None).queue] == ["error"]
    assert run("DISABLE[s, A] ; Delay[1] ; MIGRATE[s, 9]", "Delay[0.5] ; ~ASSERT[s, 1]") == STOPS


def test_migrate_gives_the_new_arguments_to_who_serves() -> None:
    reactor = "SIT[s]<k, a, b> :; (UPDATE[s, k, a, b] ; SUCCEED[s, k])"
    for how, values in (("2, 1", (5, 4)), ("1, 1", (4, 4))):
        script = f"DISABLE[s, A] ; Delay[1] ; MIGRATE[s, {how}] ; ENABLE[s, A]"
        config = following(reactor, script, "Delay[0.5] ; ASSERT[s, 4, 5]<x, y>", until=3)
        ended = config.root(3)
        assert dict(ended.bindings) == {"x": values[0], "y": values[1]}  # type: ignore[union-attr]


@pytest.mark.parametrize(("script", "served"), [("MIGRATE[s, 1] ; ", True), ("", False)])
def test_what_was_migrated_stays_when_its_process_goes(script: str, served: bool) -> None:
    config = following(
        "E[1] # (STOP :; ASSERT[s, 7])",
        f"DISABLE[s, A] ; Delay[1] ; {script}KILL[1] ; Delay[1] ; ENABLE[s, A]",
        "SIT[s]<k, x> :; (OUT[p, x] ; SUCCEED[s, k])",
        "IN[p]<x>",
        until=5,
    )
    assert (dict(getattr(config.root(4), "bindings", {})) == {"x": 7}) == served
    assert not config.store.queue
    assert not config.store.instances  # nobody awaits it: it leaves by itself


def test_what_was_not_migrated_leaves_with_its_process_and_what_was_leaves_with_its_owner() -> None:
    store, number = Store().asserted("p", (), None)
    store, ticket = store.queued("s", (1,), number)
    assert not store.abandoned_in_queue(ticket).queue
    kept = store.migrated("s", lambda old: old).abandoned_in_queue(ticket)
    assert [(q.kept, q.awaited) for q in kept.queue] == [(True, False)]
    assert not kept.ended(number, ok=False).settled().queue
