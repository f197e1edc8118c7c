"""GTPyhop: a hierarchical task planner in Python, total order, no time. Plans the whole kit, then nothing runs."""

from __future__ import annotations

import contextlib
import io
import sys
import time
from importlib.metadata import version
from typing import Any

with contextlib.redirect_stdout(io.StringIO()):  # it greets
    import gtpyhop

VERSION = version("gtpyhop")


def plan_ms(kinds: int, *, relaxed: bool = False) -> float:
    """Milliseconds of CPU for a plan of the kit task; `relaxed`: parts are tested, the first of odd kinds is bad."""
    from bench_planner import median_ms

    return median_ms(lambda: _problem(kinds, relaxed=relaxed), lambda problem: _solve(*problem))


def from_process_start(kinds: int) -> float:
    """Milliseconds of CPU of a process that begins with nothing until it has planned the kit."""
    from bench_planner import process_ms

    return process_ms(__file__, str(kinds))


def _solve(state: Any, todo: list[tuple[str, ...]]) -> Any:
    plan = gtpyhop.find_plan(state, todo)
    if not plan:
        raise RuntimeError("no plan")
    return plan


def _problem(kinds: int, *, relaxed: bool) -> tuple[Any, list[tuple[str, ...]]]:
    sys.setrecursionlimit(100_000)
    with contextlib.redirect_stdout(io.StringIO()):
        domain = gtpyhop.Domain(f"kit{kinds}{relaxed}")
        gtpyhop.current_domain = domain
        gtpyhop.set_verbose_level(0)
        state = gtpyhop.State("start")
        state.kit = [f"k{n}" for n in range(kinds)]
        state.belt = {kind: ["bad", "good"] if relaxed and n % 2 else ["good"] for n, kind in enumerate(state.kit)}
        state.seen, state.held, state.tray, state.filled = None, None, "away", []
        gtpyhop.declare_actions(find_tray, place_tray, find, test, drop, pick, insert, finish)
        gtpyhop.declare_task_methods("make_kit", _make_kit)
        gtpyhop.declare_task_methods("fill", _tested if relaxed else _trusted)
    return state, [("make_kit",)]


def find_tray(state: Any) -> Any:
    state.tray = "found"
    return state


def place_tray(state: Any) -> Any:
    if state.tray == "found":
        state.tray = "placed"
        return state
    return None


def find(state: Any, kind: str) -> Any:
    if state.belt[kind]:
        state.seen = kind
        return state
    return None


def test(state: Any, kind: str) -> Any:
    return state if state.seen == kind else None


def drop(state: Any, kind: str) -> Any:
    state.belt[kind] = state.belt[kind][1:]
    return state


def pick(state: Any, kind: str) -> Any:
    if state.held is None and state.seen == kind:
        state.held = kind
        return state
    return None


def insert(state: Any, kind: str) -> Any:
    if state.held == kind and state.tray == "placed":
        state.held = None
        state.filled.append(kind)
        return state
    return None


def finish(state: Any) -> Any:
    return state if len(state.filled) == len(state.kit) else None


def _make_kit(state: Any) -> list[tuple[str, ...]]:
    return [("find_tray",), ("place_tray",), *(("fill", kind) for kind in state.kit), ("finish",)]


def _trusted(state: Any, kind: str) -> list[tuple[str, ...]]:
    return [("find", kind), ("pick", kind), ("insert", kind)]


def _tested(state: Any, kind: str) -> list[tuple[str, ...]]:
    looked = [("find", kind), ("test", kind)]
    if state.belt[kind][0] == "bad":
        return [*looked, ("drop", kind), ("fill", kind)]
    return [*looked, ("pick", kind), ("insert", kind)]


if __name__ == "__main__":
    _solve(*_problem(int(sys.argv[1]), relaxed=False))
    print(time.process_time())
