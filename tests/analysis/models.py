"""The environment models of the second paper, ready for analysis, and variants of them made by changing the text."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

from planner_reactor.analysis.conditions import text
from planner_reactor.analysis.limits import LimitSet, limit_set
from planner_reactor.rs.configurations import World
from planner_reactor.rs.given import process_with_values, with_values
from planner_reactor.rs.parser import parse_process, parse_program
from planner_reactor.rs.printer import show
from planner_reactor.rs.terms import Process
from planner_reactor.rs.unknowns import Unknown
from planner_reactor.rs.vocabulary import BUILT_IN
from planner_reactor.workcell.environments.dynamics import host, model

OWN = ("p", "a", "b", "pr")
DURATIONS = ["t0", "ts0", "ts1", "tt0", "tt1", "tm0", "gl", "tl", "gm", "tm", "gto", "tto", "gmv", "tmv"]
CONSTANTS = [*DURATIONS, "eps", "mu", "nu"]
SENSORS = ("ReportPos", "ReportTact")
CALLS = {"tracking": "TEM[p, a]", "guarded_move": "GEM[p, a, pr]", "belt": "BEM[p, a, pr]"}


class Model(NamedTuple):
    process: Process
    world: World


def read(source: str, process: str, given: Mapping[str, object] | None = None) -> Model:
    values = {n: Unknown(n, -1) for n in OWN} | {n: Unknown(n) for n in CONSTANTS} | dict(given or {})
    program = with_values(parse_program(source), values)
    world = World(program, {**BUILT_IN, **host.signatures}, host.functions)
    return Model(process_with_values(parse_process(process), values), world)


def shipped(name: str, given: Mapping[str, object] | None = None) -> Model:
    return read(model(name), CALLS[name], given)


def limits(found: Model, sensors: tuple[str, ...] = SENSORS, limit: int = 20_000) -> LimitSet:
    return limit_set(found.process, found.world, sensors=sensors, limit=limit)


def pairs(found: LimitSet) -> set[tuple[str, str]]:
    assert found.complete
    return {(text(entry.condition), show(entry.term)) for entry in found.limits}
