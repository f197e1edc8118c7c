"""The automaton of a formula accepts exactly its runs."""

from __future__ import annotations

import random

from msgspec.structs import replace

from planner_reactor.analysis.lassos import accepted
from planner_reactor.analysis.products import Justice
from planner_reactor.analysis.tableau import Automaton, automaton
from planner_reactor.analysis.temporal import Formula, Until, always, eventually, holds
from tests.analysis.random_runs import ATOMS, formula, round_trip, run

NOTHING_ASKED = Justice(lambda label: -1)


def accepts(made: Automaton, moments: list[frozenset[object]], loop: int) -> bool:
    return accepted(round_trip(moments, loop), made, NOTHING_ASKED) is not None  # type: ignore[arg-type]


def test_an_automaton_accepts_a_run_exactly_if_its_formula_holds_of_it() -> None:
    dice = random.Random(7)
    verdicts = []
    for _ in range(500):
        made, (moments, loop) = formula(dice, 4), run(dice)
        verdicts.append(holds(made, moments, loop))
        assert accepts(automaton(made, ATOMS), moments, loop) == verdicts[-1], (made, moments, loop)
    assert 125 < sum(verdicts) < 375  # both verdicts are common


def test_an_until_that_is_put_off_for_ever_is_not_accepted() -> None:
    """Without acceptance bits `eventually` would hold of every run: the comparison above would fail."""
    sent = next(iter(formula_atoms()))
    without = replace(automaton(eventually(sent), ATOMS), all_kept=0)
    assert accepts(without, [frozenset()], 0)
    assert not accepts(automaton(eventually(sent), ATOMS), [frozenset()], 0)


def formula_atoms() -> list[Formula]:
    from planner_reactor.analysis.temporal import Here

    return [Here(atom) for atom in ATOMS]


def test_usual_formulas_have_small_automata() -> None:
    p, q, _ = formula_atoms()
    assert len(automaton(always(eventually(p)), ATOMS).edges) <= 2
    assert len(automaton(eventually(always(p)), ATOMS).edges) <= 3
    assert len(automaton(Until(p, q), ATOMS).edges) <= 2
