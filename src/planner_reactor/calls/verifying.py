"""`verify`: is a process free of deadlocks, does time always get its turn, and has it these properties?

All is asked of every run that `rs.evolves` allows, and what is refuted comes with a shortest counterexample.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

from planner_reactor.analysis.labels import show_label
from planner_reactor.analysis.lassos import Lasso
from planner_reactor.analysis.notation import Names, names_of, read_property
from planner_reactor.analysis.observing import EVENTS, Atom
from planner_reactor.analysis.properties import Verdict, check, deadlock_free, zeno_free
from planner_reactor.analysis.refinement import ENDINGS, Refinement
from planner_reactor.analysis.refinement import refines as refined
from planner_reactor.analysis.systems import LIMIT, build
from planner_reactor.analysis.temporal import Here, atoms
from planner_reactor.calls.hosts import HostSource
from planner_reactor.calls.inputs import whole
from planner_reactor.calls.processes import Subject, subject
from planner_reactor.calls.replaying import replay
from planner_reactor.errors import InputError

REPLAYS = 300
"""Runs of the executer in search of one that goes along a counterexample."""


def verify(
    file: str | Path,
    process: str,
    *,
    properties: Iterable[str] = (),
    refines: str | None = None,
    seeing: Iterable[str] = (),
    host: HostSource | None = None,
    limit: int = LIMIT,
) -> dict[str, Any]:
    """Check `process`, a call such as `Main`, beside the definitions of a file `*.rsl`.

    `refines` names another process of the file: can `process` do at least what that one can, as far as the atoms in
    `seeing` (`sent kit`, `succeeded Kit`) tell?
    `properties` are in the notation of `analysis.notation`; at most `limit` states are looked at. Returns
    `deadlock_free`, `zeno_free` and `refines` (None: not asked, or not decided within the limit), `properties` (each
    with `property`, `holds`, `counterexample`, `cycle`, `then`), `refuted` (what was refuted first, or None), its
    `counterexample` (the steps), `cycle` (how many of them, at the end, go round for ever) and `then` (what follows
    them: "round", "nothing", or "anything", as all is decided), `replayed` (was it run in the executer, step by step?),
    `states` and `complete`. Raises SourceError for a wrong text or property, InputError for a wrong argument.
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
    old = subject(file, refines, host=host) if refines is not None else None
    compared = _compared(asked, old, tuple(seeing), names, limit)
    if compared is not None:
        found = Lasso(compared.run, (), decided=True) if compared.holds is False else None
        verdicts[f"refines {refines}"] = Verdict(compared.holds, found)
    ran = {f"refines {refines}": old}  # what the other can do and this cannot, the other does
    return {
        "deadlock_free": verdicts["deadlock_free"].holds,
        "zeno_free": verdicts["zeno_free"].holds,
        "refines": compared.holds if compared is not None else None,
        "properties": [{"property": text, "holds": v.holds, **_shown(v.counterexample)} for text, v in checked],
        **_first_refuted([(name, v, ran.get(name) or asked) for name, v in (*verdicts.items(), *checked)]),
        "states": len(system.states),
        "complete": system.complete,
    }


def _compared(
    asked: Subject, old: Subject | None, seeing: tuple[str, ...], names: Names, limit: int
) -> Refinement | None:
    if old is None:
        if seeing:
            raise InputError("seeing: what is to be seen is asked for with `refines` only")
        return None
    seen = tuple(_seen(text, names) for text in seeing)
    if not seen:
        raise InputError("refines: expected what is to be seen, such as `--seeing 'succeeded Kit'`")
    return refined(*(build(one.start, one.world, seen, limit=limit) for one in (asked, old)))


def _seen(text: str, names: Names) -> Atom:
    """An atom that tells of a step, alone."""
    formula = read_property(text, names).formula
    if not isinstance(formula, Here) or formula.atom.word not in (*EVENTS, *ENDINGS):
        raise InputError(f"seeing: {text} is not a step, expected one of: {', '.join(EVENTS)}")
    return formula.atom


def _first_refuted(verdicts: Iterable[tuple[str, Verdict, Subject]]) -> dict[str, Any]:
    """The first that was refuted, and whether the executer can be led along its counterexample, twice round."""
    for name, verdict, whose in verdicts:
        if (found := verdict.counterexample) is not None:
            run = replay([whose.call], whose.world, (*found.prefix, *found.cycle, *found.cycle), tries=REPLAYS)
            return {"refuted": name, **_shown(found), "replayed": run.done}
    return {"refuted": None, **_shown(None), "replayed": None}


def _shown(found: Lasso | None) -> dict[str, Any]:
    if found is None:
        return {"counterexample": [], "cycle": 0, "then": None}
    then = "round" if found.cycle else "anything" if found.decided else "nothing"
    return {"counterexample": list(_steps(found)), "cycle": len(found.cycle), "then": then}


def _steps(found: Lasso) -> Iterator[str]:
    yield from map(show_label, found.prefix)
    yield from map(show_label, found.cycle)
