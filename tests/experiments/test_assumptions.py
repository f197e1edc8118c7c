"""The nine assumptions are real, each for itself: the table of the experiment `assumptions`, in small (R (8), (12))."""

from __future__ import annotations

from pathlib import Path

import pytest

from planner_reactor.experiments.assumptions import NINE, Trial, all_trials, one, share_interval, table, verdicts, works
from planner_reactor.experiments.figures_assumptions import draw

SEED = 5
SHORT = 450.0


def ran(built: str, given_up: tuple[str, ...], false: tuple[str, ...]) -> dict[str, object]:
    return one(Trial(built, given_up, false, SEED, lasts=SHORT))


@pytest.mark.parametrize("name", NINE)
def test_built_on_it_a_reactor_fails_where_it_is_false_and_without_it_works_in_both_worlds(name: str) -> None:
    careful = {world: ran("careful", NINE, world) for world in ((), (name,))}
    found = {
        (given_up, world): works(ran("built", given_up, world), careful[world])
        for given_up in ((), (name,))
        for world in ((), (name,))
    }
    assert found == {((), ()): True, ((), (name,)): False, ((name,), ()): True, ((name,), (name,)): True}


@pytest.mark.parametrize("name", NINE)
def test_the_reactor_that_observes_gives_up_what_is_false(name: str) -> None:
    row = ran("observant", (), (name,))
    given_up = set(NINE) - set(row["rests_on"])  # type: ignore[call-overload]
    assert name in given_up or name == "ADD"  # ADD comes and goes: it may just be back
    assert given_up <= {name, "AO"}  # where a variant is scarce, a kind keeps others waiting
    assert row["violations"] == row["interruptions"] == 0
    assert row["completed"] > 5 * row["lost"]  # type: ignore[operator]


def test_a_reactor_that_is_not_relaxed_in_this_respect_does_not_pass() -> None:
    """The check can fail: giving up another assumption does not help."""
    careful = ran("careful", NINE, ("ADT",))
    assert not works(ran("built", ("ADD",), ("ADT",)), careful)


def test_the_table_has_every_reactor_in_every_world_and_the_figure_shows_it(tmp_path: Path) -> None:
    rows = [
        {"built": t.built, "given_up": list(t.given_up), "false": list(t.false), "seed": t.seed, "violations": 0,
         "completed": 0 if t.built == "trusting" and t.false else 20, "lost": 0, "spoiled": 0}
        for t in all_trials([1, 2, 3])
    ]  # fmt: skip
    lines = table(rows)
    assert len(lines) == 9 * 7
    assert all(line["runs"] == 3 for line in lines)
    assert all(verdict["real"] for verdict in verdicts(rows))
    assert all(file.stat().st_size > 10_000 for file in draw(lines, tmp_path))
    for row in rows:
        row["completed"] = 20  # whoever trusts gets away with it
    assert not any(verdict["real"] for verdict in verdicts(rows))


def test_a_share_of_all_is_not_certain() -> None:
    assert share_interval(30, 30) == (0.886, 1.0)
    assert share_interval(0, 30) == (0.0, 0.114)
    assert share_interval(0, 0) == (0.0, 1.0)
