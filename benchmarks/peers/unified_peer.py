"""unified-planning: the kit task as a problem for the engines that are installed with it.

`fast-downward` plans without time, `kairos` with durations. Each plan is of the whole kit; nothing runs it.
"""

from __future__ import annotations

import statistics
import time
from importlib.metadata import PackageNotFoundError, version
from typing import Any

from unified_planning.shortcuts import (
    BoolType,
    ClosedTimeInterval,
    DurativeAction,
    EndTiming,
    Fluent,
    InstantaneousAction,
    Object,
    OneshotPlanner,
    Problem,
    StartTiming,
    UserType,
    get_environment,
)

ENGINES = {"fast-downward": "up-fast-downward", "kairos": "up-kairos"}
_Atoms = list[tuple[Any, bool]]


def engines() -> dict[str, str]:
    """Those that are installed, with their versions."""
    found = {}
    for name, package in ENGINES.items():
        try:
            found[name] = version(package)
        except PackageNotFoundError:
            continue
    return found


def plan_ms(engine: str, kinds: int, *, rounds: int = 3) -> tuple[float, float | None]:
    """Milliseconds (wall clock: most engines are processes of their own) and the plan's makespan in seconds."""
    environment = get_environment()
    environment.credits_stream = None
    timed = engine == "kairos"
    if timed:
        environment.factory.add_engine("kairos", "up_kairos.engine", "KairosEngine")
    problem, taken, makespan = _problem(kinds, timed=timed), [], None
    for _ in range(rounds):
        began = time.perf_counter()
        with OneshotPlanner(name=engine) as planner:
            plan = planner.solve(problem).plan
        taken.append(time.perf_counter() - began)
        if plan is None:
            raise RuntimeError(f"{engine} finds no plan")
        if timed:
            makespan = max(float(start) + float(lasts or 0) for start, _, lasts in plan.timed_actions)
    return statistics.median(taken) * 1e3, makespan


def _problem(kinds: int, *, timed: bool) -> Problem:
    part = UserType("Part")
    problem = Problem(f"kit{kinds}")
    flags = {
        name: problem.add_fluent(Fluent(name, BoolType()), default_initial_value=name in ("arm_free", "camera_free"))
        or problem.fluent(name)
        for name in ("tray_found", "tray_placed", "arm_free", "camera_free", "finished")
    }
    for name in ("found", "held", "filled"):
        flags[name] = problem.add_fluent(Fluent(name, BoolType(), p=part), default_initial_value=False)
        flags[name] = problem.fluent(name)
    parts = [Object(f"p{n}", part) for n in range(kinds)]
    problem.add_objects(parts)
    _add_actions(problem, flags, parts, part, timed)
    problem.add_goal(flags["finished"])
    return problem


def _add_actions(problem: Problem, f: dict[str, Any], parts: list[Any], part: Any, timed: bool) -> None:
    def action(name: str, seconds: int, needs: Any, gives: Any, camera: bool = False, throughout: Any = None) -> None:
        typed = {"p": part} if name in ("find", "pick", "insert") else {}
        made: Any = DurativeAction(name, **typed) if timed else InstantaneousAction(name, **typed)
        arguments = [made.parameter("p")] if typed else []
        conditions, effects = needs(*arguments), gives(*arguments)
        if not timed:
            for condition in conditions:
                made.add_precondition(condition)
            for what, holds in effects:
                made.add_effect(what, holds)
        else:
            made.set_fixed_duration(seconds)
            for condition in conditions:
                made.add_condition(StartTiming(), condition)
            if throughout is not None:
                made.add_condition(ClosedTimeInterval(StartTiming(), EndTiming()), throughout)
            for what, holds in effects:
                made.add_effect(EndTiming() if holds else StartTiming(), what, holds)
            if camera:
                made.add_condition(StartTiming(), f["camera_free"])
                made.add_effect(StartTiming(), f["camera_free"], False)
                made.add_effect(EndTiming(), f["camera_free"], True)
        problem.add_action(made)

    arm = f["arm_free"]
    action("find_tray", 2, list, lambda: [(f["tray_found"], True)], camera=True)
    action("find", 2, lambda p: [], lambda p: [(f["found"](p), True)], camera=True)
    placing: _Atoms = [(f["tray_placed"], True), *([(arm, False), (arm, True)] if timed else [])]
    action("place_tray", 3, lambda: [f["tray_found"], arm], lambda: placing)
    action("pick", 1, lambda p: [f["found"](p), arm], lambda p: [(f["held"](p), True), (arm, False)])
    action(
        "insert", 2, lambda p: [f["held"](p), f["tray_placed"]],
        lambda p: [(f["held"](p), False), (f["filled"](p), True), (arm, True)], throughout=f["tray_placed"],
    )  # fmt: skip
    action("finish", 2, lambda: [f["filled"](p) for p in parts], lambda: [(f["finished"], True)])
