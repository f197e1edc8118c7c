"""`network`: can intervals lie like this, what follows from it, how would such a world look, and if not, why not?"""

from __future__ import annotations

from itertools import combinations
from pathlib import Path
from typing import Any

from planner_reactor.calls.inputs import read_text
from planner_reactor.logic.allen import base_relation, names
from planner_reactor.logic.explaining import minimal
from planner_reactor.logic.network_text import read_statements
from planner_reactor.logic.problems import Statement, intervals_of
from planner_reactor.logic.solving import closure, solve


def network(file: str | Path) -> dict[str, Any]:
    """Judge what a file says of intervals, in lines such as `i1 (b m o) i2`, `i1 lasts 3000 .. 5000`, `i1 uses arm`.

    Returns `consistent` (by complete search), `intervals`, `closure` (of every pair about which something is known:
    `first`, `relations`, `second`, by propagation), `scenario` (one relation for each pair, holding together),
    `timeline` (start and end of each interval in it; milliseconds if the file says anything of durations, which is
    `metric`) and `explanation` (statements that contradict each other and of which none could be spared: `line`,
    `text`). Of an inconsistent network `closure`, `scenario` and `timeline` are None, of a consistent one
    `explanation`. Raises DomainError for a wrong text, BudgetError if the search gives up.
    """
    statements = read_statements(read_text(file), file=str(file))
    answer = solve(statements)
    found: dict[str, Any] = {
        "consistent": answer.times is not None,
        "intervals": list(map(str, intervals_of(statements))),
        "metric": answer.metric,
        "closure": None, "scenario": None, "timeline": None, "explanation": None,
    }  # fmt: skip
    if answer.times is None:
        found["explanation"] = [_said(statement) for statement in minimal([statements[n] for n in answer.core])]
        return found
    found["closure"] = [
        {"first": str(first), "relations": list(names(known)), "second": str(second)}
        for first, known, second in closure(statements) or ()
    ]
    found["scenario"] = [
        {"first": str(a), "relation": names(base_relation(answer.times[a], answer.times[b]))[0], "second": str(b)}
        for a, b in combinations(answer.times, 2)
    ]
    found["timeline"] = {str(i): [round(end, 3) for end in ends] for i, ends in answer.times.items()}
    return found


def _said(statement: Statement) -> dict[str, Any]:
    return {"line": statement.place.line if statement.place else None, "text": str(statement)}
