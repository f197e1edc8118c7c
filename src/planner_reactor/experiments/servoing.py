"""Runs of a planner and a reactor in worlds of RS processes: track, reach, await, and change between them (X §5).

Nothing is written by hand: `domain_for` derives the actions from the models of the environment, the planner finds the
reactions, and they come into the running reactor by ordinary adaptations.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import lru_cache

import msgspec

from planner_reactor.experiments.loop import Loop
from planner_reactor.link.messages import Perception
from planner_reactor.logic.domain import Domain
from planner_reactor.planner.planner import Planner
from planner_reactor.planner.servos import Model, exploiting
from planner_reactor.workcell.environments.agent import Place, agent
from planner_reactor.workcell.environments.dynamics import host, model
from planner_reactor.workcell.environments.exploits import ACQUIRE, ASSUMING, JOINT, WATCHING, wanted
from planner_reactor.workcell.environments.worlds import MEASURES, TIMING, Surroundings


class Scene(msgspec.Struct, frozen=True, kw_only=True):
    """One run: the world (`tracking`, `reaching`, `line`), how it begins, and what is different in it.

    `strikes`: (seconds, whether the belt runs from then on). `target`: objects to take; `until`: seconds at most;
    `without`: assumptions that the planner does not begin with.
    """

    kind: str
    starts: Mapping[str, float]
    constants: Mapping[str, float] = {}
    seed: int = 1
    strikes: Sequence[tuple[float, bool]] = ()
    target: int = 0
    until: float = 60.0
    without: tuple[str, ...] = ()


class Played(msgspec.Struct, frozen=True):
    """A run that is over, and its world."""

    scene: Scene
    loop: Loop
    world: Surroundings


def play(scene: Scene, *, watch: Callable[[Loop], object] = lambda loop: None) -> Played:
    """Do it: a null reactor, a planner, and the world."""
    planner = Planner(domain_for(scene.kind, tuple(sorted(scene.constants.items()))), relax=())
    for number, name in enumerate(scene.without, 1):
        planner.perceive(Perception(number=number, time=0.0, kind="assumption_failure", subject=name))
    make = agent(scene.kind, scene.starts, scene.constants, target=scene.target)
    loop = Loop(planner, make, seed=scene.seed)
    place = loop.host.world
    assert isinstance(place, Place)
    for when, runs in scene.strikes:
        loop.scheduler.call_at(when, lambda runs=runs: place.strike("belt", runs=float(runs)))  # type: ignore[misc]
    watch(loop)
    loop.run(until=scene.until)
    return Played(scene, loop, place.surroundings)


@lru_cache(256)
def domain_for(kind: str, constants: tuple[tuple[str, float], ...] = ()) -> Domain:
    """What a planner is given in a world of this kind: a goal, and what follows from the models."""
    given = {**TIMING, **MEASURES, **dict(constants)}
    if kind == "tracking":
        return exploiting(wanted("tracking"), [_model("tracking", "TEM", given)], file="tracking.itl")
    reach = _model("guarded_move", "GEM", given)
    models = [_model("belt", "BEM", given), reach] if kind == "line" else [reach]
    return exploiting(wanted("acquiring"), models, definitions=ACQUIRE, file="acquiring.itl")


def _model(name: str, environment: str, given: Mapping[str, float]) -> Model:
    belt = name == "belt"
    return Model(
        text=model(name) if name == "tracking" else f"{model(name)}\n{JOINT}",
        environment=environment,
        signatures=host.signatures,
        given=given,
        assuming=ASSUMING if belt else {},
        watching=WATCHING if belt else {},
        patience_ms=30_000,
    )
