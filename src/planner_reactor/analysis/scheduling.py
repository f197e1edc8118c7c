"""Can one executer carry these reactions in time? (X §7: the timing of reactions, "important in real-time scheduling")

The executer takes one step at a time, in the order in which steps become ready, and nothing preempts it. A step costs
what was measured (`calls.costing`). Of each reaction is asked how many steps a round takes, and how often its
environment lets it go round: then

    load      Σ steps · cost / period < 1: on average it has the time
    response  steps that are ready at one instant come after each other: the longest any reaction waits is the cost of
              one round of all of them, which must fit into what its timing leaves free, its slack

Both are sufficient: where they hold, no reaction is late by more than its slack. Steps of the interface are not
counted: it stands for hardware.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import inf

import msgspec

from planner_reactor.analysis.rounds import Irreducible, Path, rounds_of
from planner_reactor.rs.configurations import World
from planner_reactor.rs.terms import Process

TURNS = 1
"""Steps that going round costs beside what a round does."""


class Demand(msgspec.Struct, frozen=True):
    """A reaction: steps of one round, least seconds between two rounds, and how late a round may be."""

    name: str
    steps: int
    period: float
    slack: float


class Schedule(msgspec.Struct, frozen=True):
    """`load` is the share of the executer's time, `response` the longest wait in seconds, `offender` who asks too much.

    `margin` says by what factor a step may become dearer.
    """

    fits: bool
    load: float
    response: float
    margin: float
    offender: str = ""

    def __str__(self) -> str:
        verdict = "fits" if self.fits else f"does not fit: {self.offender}"
        return f"load {self.load:.2%}, response {self.response * 1000:.3g} ms: {verdict}, margin {self.margin:.3g}"


def schedule(demands: Sequence[Demand], cost: float) -> Schedule:
    """Do these reactions fit, if a step costs so many seconds?"""
    load = sum(d.steps * cost / d.period for d in demands)
    response = sum(d.steps for d in demands) * cost
    tightest = min(demands, key=lambda d: d.slack, default=None)
    room = tightest.slack / response if tightest is not None and response > 0 else inf
    margin = min(1 / load if load > 0 else inf, room)
    dearest = max(demands, key=lambda d: d.steps / d.period, default=None)
    blame = "" if margin > 1 or tightest is None or dearest is None else (
        f"{dearest.name} takes {dearest.steps * cost / dearest.period:.2%} of the time" if load >= 1
        else f"{tightest.name} may be late by {tightest.slack:.3g} s"
    )  # fmt: skip
    return Schedule(margin > 1, load, response, margin, blame)


def steps_of(reaction: Process, world: World) -> int:
    """The most steps of one round of a reaction: rendezvous, delays, tests, and going round. Irreducible if open."""
    found = [r for rounds in rounds_of(reaction, world) for r in rounds.all()]
    ways = [way for rounds in found for way in (*rounds.ways, *rounds.ends)]
    if not ways:
        raise Irreducible(reaction, "it does nothing at any port")
    return sum(max((_steps(way) for way in (*r.ways, *r.ends)), default=0) for r in found)


def _steps(way: Path) -> int:
    own = sum(len(p.takes) + len(p.gives) + len(p.offers) + (not (p.takes or p.gives)) for p in way.phases)
    return own + len(way.given) + TURNS + sum(_steps(body) for body in way.spawned)
