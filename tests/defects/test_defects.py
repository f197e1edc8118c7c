"""The simulation catches: a few defects here, all of them in `python -m tests.defects` (docs/defects.md)."""

from __future__ import annotations

import pytest

from planner_reactor.simulation.counters import ROWS
from tests.defects.defects import Defect, by_hand, by_tool, harmless
from tests.defects.hunting import hunt
from tests.defects.telling import shipped
from tests.mutants.running import Code

QUICK = {
    "KILL does not wait until its reaction is at rest": "law",
    "the journal forgets which reactions were killed": "law",
    "a refusal has no reason": "law 10",
}
LAWS = {f"law {n}" for n in range(1, 18)}
NOT_HERE = {19, 22, 28, 33}
"""Rows of the fault table without a defect of their own: 19 and 22 are 13 and 7 here, 28 needs a dashboard."""


@pytest.fixture(scope="module")
def code() -> Code:
    made = Code()
    made.warm(("planner_reactor.simulation.running",))
    return made


def test_each_defect_fits_the_sources_and_can_be_loaded() -> None:
    for defect in by_hand():
        for module, text in defect.sources.items():
            compile(text, module, "exec")
    names = [defect.name for defect in (*by_hand(), *by_tool())]
    assert len(set(names)) == len(names)


@pytest.mark.parametrize("name", QUICK)
def test_a_defect_is_caught(code: Code, name: str) -> None:
    (defect,) = (d for d in by_hand() if d.name == name)
    caught = hunt(code, defect, seeds=5)
    assert caught.by.startswith(QUICK[name])


@pytest.mark.parametrize("cases", ["workshop", "cell", "storm"])
def test_without_a_defect_nothing_is_caught(code: Code, cases: str) -> None:
    assert hunt(code, Defect("nothing", "", {}, cases), seeds=2).by == ""


def test_each_law_and_each_row_has_a_defect() -> None:
    about = {defect.about for defect in by_hand()}
    assert about >= LAWS
    assert about >= {f"row {n}" for n in range(1, 33) if n not in NOT_HERE}


def test_at_least_sixty_were_caught_each_within_a_hundred_seeds_and_none_escaped() -> None:
    rows = shipped()
    assert len(rows) >= 60
    assert all(row["by"] and row["seeds"] <= 100 for row in rows)
    assert {law for row in rows for law in (row["by"], *row["also"])} >= LAWS


def test_what_is_called_harmless_is_a_change_of_the_tool() -> None:
    assert harmless().keys() <= {defect.name for defect in by_tool()}
    assert all(counter in ROWS for defect in by_hand() if (counter := defect.counter))
