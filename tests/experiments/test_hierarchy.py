"""Situations broken down as in R Figs 8 to 10, for any domain."""

from __future__ import annotations

import pytest

from planner_reactor.experiments.hierarchy import Act, AtOnce, InOrder, Node, Part, folded, hierarchy
from planner_reactor.experiments.papers_run import Replay
from planner_reactor.experiments.snapshots import Snapshot, reactor_at
from planner_reactor.rs.parser import parse_program
from planner_reactor.rs.reactions import reaction_of

TEXT = """
P[0] = STOP :; ASSERT[day]
P[1] = SIT[day]<k> :; (~(REASSERT[wash]<x> : (REASSERT[dry, x] & Sing) : SUCCEED[day, k]) : FAIL[day, k])
P[2] = SIT[wash]<k> :; (~((Watch # Rub[soap]<x>) : (UPDATE[wash, k, x] ; SUCCEED[wash, k])) : FAIL[wash, k])
P[3] = SIT[dry]<k, x> :; ((STUB[dry] : SUSPEND[2000]) ; FAIL[dry, k])
P[4] = ASSUMONITOR[A, 1000]
"""


def snapshot(text: str, **rests_on: tuple[str, ...]) -> Snapshot:
    found = [r for s in parse_program(text, file="<test>").schemas if (r := reaction_of(s)) is not None]
    return Snapshot({r.label: r for r in found}, rests_on)


def outline(node: Node) -> object:
    match node:
        case Act(label):
            return label
        case Part(label, inside):
            return {label: None if inside is None else outline(inside)}
        case InOrder(parts):
            return [outline(part) for part in parts]
        case AtOnce(sign, lanes):
            return (sign, *map(outline, lanes))


def test_order_concurrency_and_stubs_are_kept_and_book_keeping_is_left_out() -> None:
    (root,) = hierarchy(snapshot(TEXT))
    assert outline(root) == {"day": [{"wash": ("#", "Watch", "Rub soap")}, ("&", {"dry": "STUB"}, "Sing")]}


def test_situations_are_tagged_with_what_they_rest_on() -> None:
    (root,) = hierarchy(snapshot(TEXT, day=("A", "B")))
    assert isinstance(root, Part)
    assert root.tags == ("A", "B")


def test_branches_of_a_choice_stand_behind_its_test() -> None:
    text = "P[0] = SIT[s]<k> :; (~(if Look then Take else (Call ; Wait) : SUCCEED[s, k]) : FAIL[s, k])"
    (root,) = hierarchy(snapshot(text))
    assert outline(root) == {"s": ["Look", ("if", "Take", ["Call", "Wait"])]}


def test_a_situation_that_is_asserted_twice_stands_in_full_once() -> None:
    text = """
    P[0] = STOP :; (ASSERT[a] : ASSERT[a])
    P[1] = SIT[a]<k> :; (Do ; SUCCEED[a, k])
    """
    (root,) = hierarchy(snapshot(text))
    assert outline(root) == [{"a": "Do"}, {"a": None}]


def test_several_reactions_of_a_situation_are_side_by_side() -> None:
    text = """
    P[0] = STOP :; ASSERT[a]
    P[1] = SIT[a]<k> :; (Do ; SUCCEED[a, k])
    P[2] = SIT[a]<k> :; Look
    """
    (root,) = hierarchy(snapshot(text))
    assert outline(root) == {"a": ("|", "Do", "Look")}


def test_too_wide_an_order_is_broken_into_lines_and_of_many_lanes_some_are_shown() -> None:
    def width(node: Node) -> float:
        return sum(map(width, node.parts)) if isinstance(node, InOrder) else 10.0

    row = InOrder(tuple(Act(name) for name in "abcde"))
    assert outline(folded(row, width, 25.0)) == ("then", ["a", "b"], ["c", "d"], "e")
    assert folded(row, width, 50.0) == row
    many = AtOnce("&", tuple(Act(str(n)) for n in range(25)))
    assert outline(folded(many, width, 25.0)) == ("&", "0", "1", "2", "3", {"… and 21 more of these": None})


@pytest.mark.parametrize("time", [26.01, 41.0, 115.0, 399.0])
def test_the_papers_three_situations_are_always_there(replayed: Replay, time: float) -> None:
    """R Figs 8 and 9: Kitting is first AcquireTray, then FillTray, then FinishTray."""
    (root,) = hierarchy(reactor_at(replayed.theirs.loop.trace.events, time))
    assert isinstance(root, Part)
    assert root.label == "Kitting"
    assert isinstance(root.inside, InOrder)
    assert [part.label for part in root.inside.parts if isinstance(part, Part)] == [
        "AcquireTray", "FillTray", "FinishTray",
    ]  # fmt: skip
