"""The drawings of small transition systems."""

from __future__ import annotations

from pathlib import Path

from planner_reactor.analysis.exports import graph
from planner_reactor.experiments.figures_systems import draw_systems, laid_out, tools


def test_every_state_has_a_place_of_its_own_at_its_distance(tmp_path: Path) -> None:
    found = graph(tools("Careless"))
    places = laid_out(found)
    assert len(set(places.values())) == len(places) == len(found.moves)
    assert all(places[after][0] <= places[here][0] + 1 for here, moves in enumerate(found.moves) for _, after in moves)


def test_the_careless_robots_may_be_stuck_and_the_careful_ones_are_not() -> None:
    assert len(tools("Careless").deadlocks) == 1
    assert not tools("Careful").deadlocks


def test_the_picture_of_the_page_is_drawn(tmp_path: Path) -> None:
    assert [path.name for path in draw_systems(tmp_path)] == ["transition-systems.png", "transition-systems.svg"]
