"""The papers' own run as data: what struck when, the 1994 planner's durations, and the pace of the arm
(`papers_1994.toml`; R §9.2).

The durations are those that the text and the figures give; where they contradict each other (`first ideal
reactor`: 40 s, 42 s or 46 s) the first is taken. Nothing here knows how a planner is charged for its time.
"""

from __future__ import annotations

from collections.abc import Mapping
from importlib.resources import files

import msgspec

from planner_reactor.workcell.calibration import PINNED, Calibration, slowed
from planner_reactor.workcell.faults import Fault, Strikable, faults_from
from planner_reactor.workcell.reading import parse_toml

FILE = "papers_1994.toml"

PAPERS_RELAXED = ("AQ", "AS")
"""The assumptions that the papers' planner relaxed by choice."""


class PlannerDurations(msgspec.Struct, frozen=True):
    """Seconds that the planner of 1994 took; `normal` by assumption, for all adaptations of its relaxation."""

    first_adaptation_s: float
    refinement_s: float
    forced_first_s: float
    forced_s: float
    other_s: float
    until_s: float
    normal: Mapping[str, float]


def planner_durations() -> PlannerDurations:
    """How long the papers' planner took for each kind of work."""
    table = dict(parse_toml(_text(), file=FILE).values["planner"])
    normal = {name: float(seconds) for name, seconds in table.pop("relaxation_s").items()}
    return PlannerDurations(**table, normal=normal)


def papers_faults(world: Strikable) -> tuple[Fault, ...]:
    """What struck in the papers' run."""
    return faults_from(_text(), world, file=FILE, beside=("planner", "cell"))


def papers_calibration() -> Calibration:
    """Our cell with an arm as slow as the papers' must have been."""
    return slowed(PINNED, float(parse_toml(_text(), file=FILE).values["cell"]["arm_slower"]))


def _text() -> str:
    return (files("planner_reactor.workcell") / FILE).read_text(encoding="utf-8")
