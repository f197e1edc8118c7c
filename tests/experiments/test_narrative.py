"""What a newcomer is told of a run."""

from __future__ import annotations

from planner_reactor.experiments.narrative import Narrator
from planner_reactor.experiments.papers_run import Replay
from planner_reactor.trace import Event
from planner_reactor.workcell import telling


def told(events: list[Event]) -> list[tuple[float, str, str]]:
    lines: list[tuple[float, str, str]] = []
    narrator = Narrator(lambda time, who, what: lines.append((time, who, what)), telling.MEANING, telling.told)
    narrator.begin()
    for event in events:
        narrator(event)
    return lines


def test_it_is_short_in_order_and_says_who(replayed: Replay) -> None:
    lines = told(replayed.theirs.loop.trace.events)
    assert 20 <= len(lines) <= 50
    assert {who for _, who, _ in lines} == {"planner", "reactor", "world"}
    assert [time for time, _, _ in lines] == sorted(time for time, _, _ in lines)
    assert all(len(what) < 110 for _, _, what in lines)


def test_the_story_has_its_beginning_its_turns_and_its_products(replayed: Replay) -> None:
    text = "\n".join(what for _, _, what in told(replayed.theirs.loop.trace.events))
    turns = (
        "empty: the robot does nothing yet", "first adaptation", "begins to act",
        "do without AQ (“all parts are good”)", "first ideal reactor", "a kit is completed", "slides away",
        "AM (“parts do not move”) does not hold", "must do without AM", "downstream takes no trays", "takes ADD",
    )  # fmt: skip
    places = [text.index(turn) for turn in turns]
    assert places == sorted(places)


def test_a_situation_that_had_to_end_first_is_told_with_its_wait(replayed: Replay) -> None:
    waits = [what for _, _, what in told(replayed.theirs.loop.trace.events) if "after it was issued" in what]
    assert waits
    assert all("nothing is interrupted" in what for what in waits)
