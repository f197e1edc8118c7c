"""Ways to run small texts by the rules: every end, the causes, one run up to an instant."""

from __future__ import annotations

from planner_reactor.analysis.explore import Exploration, explore
from planner_reactor.rs.configurations import Config, World
from planner_reactor.rs.evolves import started
from planner_reactor.rs.leaves import elapsed, slack, steps
from planner_reactor.rs.parser import parse_process
from planner_reactor.rs.states import (
    Ended,
    Run,
    parts_of,
)
from tests.rs.test_evolves import world

SERVED = "SIT[s]<k> :; (Delay[5] ; SUCCEED[s, k])"


def explored(*texts: str, program: str = "") -> Exploration:
    w = world(program, *texts)
    found = explore(begun(*texts, w=w), w)
    assert found.complete
    return found


def begun(*texts: str, w: World) -> Config:
    config = Config()
    for n, text in enumerate(texts):
        config = started(parse_process(text, file=f"root{n}"), w, config=config)
    return config


def finals(*texts: str, program: str = "") -> list[Config]:
    """The configurations in which nothing can happen any more."""
    found = explored(*texts, program=program)
    return [found.states[n] for n in found.ends]


def causes(*texts: str, program: str = "") -> set[str]:
    """Why the last root aborts, in every way that it may end."""
    ends = [config.roots[-1][1] for config in finals(*texts, program=program)]
    return {e.cause if isinstance(e, Ended) else "runs" for e in ends}


def following(*texts: str, until: float, program: str = "") -> Config:
    """The configuration after so many seconds, if at each moment the first step that is offered is taken."""
    w = world(program, *texts)
    config, now = begun(*texts, w=w), 0.0
    while True:
        if (step := next(steps(config, w), None)) is not None:
            config = step.after
            continue
        pause = min(slack(config, w), until - now)
        if pause <= 0:
            return config
        config, now = elapsed(config, pause, w), now + pause


def inside(term: Run) -> list[Run]:
    """A term and all its parts."""
    return [term, *(t for part in parts_of(term) for t in inside(part))]
