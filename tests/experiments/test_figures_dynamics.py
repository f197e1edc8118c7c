"""The second paper's figures come from the texts of its models, and from runs of them."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path

import pytest

from planner_reactor.experiments.figures_networks import PICTURES, boxes, draw_networks
from planner_reactor.experiments.figures_signals import GAMMA, TAU, draw_signals, looks, offers


def arrows(name: str) -> set[tuple[str, str, str]]:
    found = boxes(PICTURES[name])
    return {(w.text, port, r.text) for w in found for port in w.writes for r in found if port in r.reads and r is not w}


def test_figure_3_is_what_the_text_says() -> None:
    assert arrows("x-fig3") == {
        ("Object[p]", "op", "Camera[a]"), ("Camera[a]", "pos", "sense1"), ("motor1", "angle", "Camera[a]"),
    }  # fmt: skip


def test_figure_5_is_figure_3_with_the_reaction() -> None:
    assert arrows("x-fig5") - arrows("x-fig3") == {
        ("sense1", "s1", "LOOK"), ("LOOK", "p", "MOVECAMERA"), ("MOVECAMERA", "m1", "motor1"),
    }  # fmt: skip


def test_figures_6_to_8_have_the_robot_the_distance_and_the_touch() -> None:
    for name, thing in (("x-fig6", "Object[p]"), ("x-fig7", "Object[p]"), ("x-fig8", "BeltObject[p]")):
        assert {
            (thing, "op", "Dist"), ("Robot[pr]", "rp", "Dist"), ("Dist", "d", "Tactile"), ("Tactile", "tact", "touch"),
            ("move", "rc", "Robot[pr]"),
        } <= arrows(name)  # fmt: skip
    assert {("LOOK", "p", "MOVETOWARDS"), ("MOVETOWARDS", "r", "move"), ("touch", "t", "CONTACT")} <= arrows("x-fig7")
    assert not any("WAITFOROBJECT" in arrow for arrow in arrows("x-fig8"))


def test_no_two_boxes_stand_on_each_other() -> None:
    for name in PICTURES:
        places = [b.at for b in boxes(PICTURES[name])]
        assert all(abs(a[0] - b[0]) > 1.1 or abs(a[1] - b[1]) > 0.6 for a in places for b in places if a is not b)


def test_figure_2_shows_an_object_that_is_never_lost() -> None:
    found = looks(20.0)
    assert len(found) > 50
    assert all(look.seen for look in found)
    assert max(look.place for look in found) - min(look.place for look in found) > 2  # though it goes far


def test_figure_4_keeps_to_its_bound() -> None:
    found = offers(60.0)
    assert max(ended - begun for begun, ended in found) == pytest.approx(TAU, abs=0.05)
    silences = [later - ended for (_, ended), (later, _) in pairwise(found)]
    assert max(silences) == pytest.approx(GAMMA, abs=0.05)
    assert max(silences) <= GAMMA


def test_all_figures_are_written(tmp_path: Path) -> None:
    written = [*draw_signals(tmp_path), *draw_networks(tmp_path)]
    assert sorted({path.stem for path in written}) == [f"x-fig{n}" for n in range(2, 9)]
    assert all(path.stat().st_size > 3_000 for path in written)
