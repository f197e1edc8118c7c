"""Why no world holds it all: a least set of statements that contradict each other, in their own words.

The search names statements that suffice (`Answer.core`); what can be left out of them is found by leaving out one after
the other (deletion filter, Chinneck and Dravnieks 1991). Every remaining one is needed: without it the others hold in
some world.
"""

from __future__ import annotations

from collections.abc import Sequence

from planner_reactor.logic.problems import Statement
from planner_reactor.logic.solving import GUESSES, solve


def explanation(statements: Sequence[Statement], *, limit: int = GUESSES) -> tuple[Statement, ...] | None:
    """Statements that contradict each other, and of which none could be spared, in their order; None if some world
    holds them all. BudgetError as in `solve`.
    """
    answer = solve(statements, limit=limit)
    if answer.times is not None:
        return None
    return minimal([statements[n] for n in answer.core], limit=limit)


def minimal(contradicting: Sequence[Statement], *, limit: int = GUESSES) -> tuple[Statement, ...]:
    """The same of statements that are known to contradict each other."""
    left, tried = list(contradicting), 0
    while tried < len(left):
        without = left[:tried] + left[tried + 1 :]
        answer = solve(without, limit=limit)
        if answer.times is None:
            left = [without[n] for n in answer.core]
            tried = sum(1 for n in answer.core if n < tried)
        else:
            tried += 1
    return tuple(left)
