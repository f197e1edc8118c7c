"""`verify`: is a process free of deadlocks, does time always get its turn, and has it these properties?

All is asked of every run that `rs.evolves` allows, and what is refuted comes with a shortest counterexample.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

from planner_reactor.analysis.labels import show_label
from planner_reactor.analysis.lassos import Lasso
from planner_reactor.analysis.notation import names_of, read_property
from planner_reactor.analysis.properties import Verdict, check, deadlock_free, zeno_free
from planner_reactor.analysis.systems import LIMIT, build
from planner_reactor.analysis.temporal import atoms
from planner_reactor.calls.hosts import HostSource
from planner_reactor.calls.inputs import whole
from planner_reactor.calls.processes import subject


def verify(
    file: str | Path,
    process: str,
    *,
    properties: Iterable[str] = (),
    host: HostSource | None = None,
    limit: int = LIMIT,
) -> dict[str, Any]:
    """Check `process`, a call such as `Main`, beside the definitions of a file `*.rsl`.

    `properties` are in the notation of `analysis.notation`; at most `limit` states are looked at. Returns
    `deadlock_free` and `zeno_free` (None: not decided within the limit), `properties` (each with `property`, `holds`,
    `counterexample`, `cycle`), `refuted` (what was refuted first, or None), its `counterexample` (the steps) and
    `cycle` (how many of them, at the end, go round for ever), `then` (what follows them: "round", "nothing", or
    "anything", as all is decided), `states` and `complete`. Raises SourceError for a wrong text or property, InputError
    for a wrong argument.
    """
    limit = whole("limit", limit, 1)
    asked = subject(file, process, host=host)
    names = names_of(asked.program, asked.call)
    read = [read_property(text, names) for text in properties]
    system = build(
        asked.start, asked.world, tuple(dict.fromkeys(a for p in read for a in atoms(p.formula))), limit=limit
    )
    verdicts = {"deadlock_free": deadlock_free(system), "zeno_free": zeno_free(system)}
    checked = [(str(p), check(system, p)) for p in read]
    return {
        **{name: verdict.holds for name, verdict in verdicts.items()},
        "properties": [{"property": text, "holds": v.holds, **_shown(v.counterexample)} for text, v in checked],
        **_first_refuted([*verdicts.items(), *checked]),
        "states": len(system.states),
        "complete": system.complete,
    }


def _first_refuted(verdicts: Iterable[tuple[str, Verdict]]) -> dict[str, Any]:
    for name, verdict in verdicts:
        if verdict.counterexample is not None:
            return {"refuted": name, **_shown(verdict.counterexample)}
    return {"refuted": None, **_shown(None)}


def _shown(found: Lasso | None) -> dict[str, Any]:
    if found is None:
        return {"counterexample": [], "cycle": 0, "then": None}
    then = "round" if found.cycle else "anything" if found.decided else "nothing"
    return {"counterexample": list(_steps(found)), "cycle": len(found.cycle), "then": then}


def _steps(found: Lasso) -> Iterator[str]:
    yield from map(show_label, found.prefix)
    yield from map(show_label, found.cycle)
