"""`lts`: the labelled transition system of a process, reduced or whole, written for other tools."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Any

from planner_reactor.analysis import verdicts
from planner_reactor.analysis.automata import Timed, compiled
from planner_reactor.analysis.cells import Entangled
from planner_reactor.analysis.equivalence import at_ports, reduced, seen
from planner_reactor.analysis.exports import Graph, aut, dot, graph, one_process
from planner_reactor.analysis.labels import show_label
from planner_reactor.analysis.lassos import Lasso
from planner_reactor.analysis.networks import networked, whole
from planner_reactor.analysis.promela import promela
from planner_reactor.analysis.stubborn import reduced as fewer_orders
from planner_reactor.analysis.transitions import LIMIT, Transitions, build
from planner_reactor.calls.hosts import HostSource
from planner_reactor.calls.inputs import names_in, one_of, writable_file
from planner_reactor.calls.inputs import whole as whole_number
from planner_reactor.calls.processes import Subject, subject
from planner_reactor.errors import InputError

REDUCTIONS = ("none", "strong", "branching", "orders")
FORMS = (".aut", ".dot", ".pml")


def lts(
    file: str | Path,
    process: str,
    *,
    out: str | Path | None = None,
    host: HostSource | None = None,
    reduce: str = "none",
    hide: str | Iterable[str] = (),
    limit: int = LIMIT,
) -> dict[str, Any]:
    """Build the transition system of `process`, a call such as `Main`, beside the definitions of a file `*.rsl`.

    `reduce`: "strong" or "branching" bisimilarity (rendezvous at the ports `hide` are then not seen), or "orders",
    which follows only as many orders of independent steps as deadlocks need (it is counted, not written). `out` ends
    in `.aut`, `.dot` or `.pml`. Returns `states`, `transitions`, `deadlocks`, `cells`, and shortest ways to what is
    wrong: `deadlock`, `zeno`, `livelock` (None, or `steps` and how many of them, at the end, go round for ever,
    `cycle`). Raises SourceError for a wrong text, InputError for a wrong argument, BudgetError above `limit` states.
    """
    one_of("reduce", reduce, REDUCTIONS)
    limit, target = whole_number("limit", limit, 1), None if out is None else _target(Path(out), reduce)
    hidden = names_in(hide)
    if hidden and reduce != "branching":
        raise InputError(f"hide: {', '.join(hidden)} can be hidden with reduce branching only, not with {reduce}")
    asked = subject(file, process, host=host)
    if reduce == "orders":
        return _fewer(asked, limit)
    found = build(asked.start, asked.world, limit=limit)
    small = graph(found)
    if reduce != "none":
        behaviour = seen(found, bindings=True)
        small = graph(reduced(behaviour, hidden=at_ports(*hidden) if reduce == "branching" else None))
    if target is not None:
        target.write_text(_text(target, small, found, process, reduce, limit), encoding="utf-8")
    return {
        "states": len(small.moves),
        "transitions": small.size,
        "deadlocks": len(small.deadlocks),
        "cells": len(found.network.cells),
        "deadlock": _shown(verdicts.deadlock(found)),
        "zeno": _shown(verdicts.zeno(found)),
        "livelock": _shown(verdicts.livelock(found)),
    }


def _target(out: Path, reduce: str) -> Path:
    if out.suffix not in FORMS:
        raise InputError(f"out {out}: expected a name that ends in {', '.join(FORMS)}")
    if reduce == "orders":
        raise InputError("reduce orders counts states, and keeps no system to be written")
    return writable_file(out, called="out")


def _fewer(asked: Subject, limit: int) -> dict[str, Any]:
    try:
        try:
            automata = compiled(networked(asked.start, asked.world, limit=limit))
        except Entangled:
            automata = compiled(whole(asked.start, asked.world, limit=limit))
    except Timed as problem:
        raise InputError(f"reduce orders: {problem}; orders can be left out only where no time passes") from problem
    found = fewer_orders(automata, limit=limit)
    return {
        "states": found.states,
        "transitions": found.transitions,
        "deadlocks": len(found.deadlocks),
        "cells": len(automata.cells),
    }


def _text(target: Path, small: Graph, found: Transitions, process: str, reduce: str, limit: int) -> str:
    match target.suffix:
        case ".aut":
            return aut(small)
        case ".dot":
            return dot(small, name=process)
        case _ if reduce == "none":
            try:
                return promela(compiled(found.network), title=process)
            except Timed:
                pass
    return one_process(small, title=process)


def _shown(found: Lasso | None) -> dict[str, Any] | None:
    if found is None:
        return None
    return {"steps": list(map(show_label, (*found.prefix, *found.cycle))), "cycle": len(found.cycle)}
