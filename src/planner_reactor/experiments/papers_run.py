"""The papers' run (R §9.2), replayed: on their clock, on ours, and what relaxing assumptions buys.

The same faults strike in all: AM at 152 s, ADD at 215 s, which holds again at 357 s; only AQ and AS are relaxed by
choice. Whatever belongs to the world comes from `workcell`.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import msgspec

from planner_reactor.experiments.comparison import Row, compare, products_row
from planner_reactor.experiments.loop import Loop
from planner_reactor.experiments.measures import Measures, measure
from planner_reactor.experiments.runs import Faults, Ran, Relax, Run, perform, the_domain
from planner_reactor.experiments.schedules import in_turn
from planner_reactor.workcell import telling
from planner_reactor.workcell.papers import PAPERS_RELAXED, papers_calibration, papers_faults, planner_durations

SEED = 1
PAYS_UNTIL = 1200.0
ALL_RELAXED_BY = 60.0
"""Seconds after which a run of ours has relaxed whatever there is."""


class Pays(msgspec.Struct, frozen=True):
    """One row of the table that shows what relaxing buys: the same faults, with and without."""

    faults: str
    relax: str
    completed: int
    rejected: int
    lost_to: tuple[str, ...]
    last_s: float | None  # when the last one was completed


class Replay(msgspec.Struct, frozen=True):
    """The runs and what was measured of them."""

    theirs: Ran
    ours: Ran
    relaxed: Ran
    on_their_clock: Measures
    on_ours: Measures

    @property
    def rows(self) -> list[Row]:
        """The table: the papers' figures beside ours."""
        made = products_row(telling.PRODUCTS, self.on_their_clock, self.on_ours)
        return [*compare(self.on_their_clock, self.on_ours), made]


def their_run() -> Run:
    """The run on the papers' clock."""
    until = planner_durations().until_s
    return Run(
        seed=SEED,
        relax=PAPERS_RELAXED,
        planner_time="papers",
        calibration=papers_calibration(),
        faults=papers_faults,
        until=until,
    )


def our_run() -> Run:
    """The same on our own clock."""
    return Run(seed=SEED, relax=PAPERS_RELAXED, faults=papers_faults, until=planner_durations().until_s)


def replay(watch: Callable[[Loop], object] = lambda loop: None) -> Replay:
    """Run all three; `watch` is given the loop on the papers' clock before it begins."""
    domain = the_domain()
    theirs = perform(their_run(), domain=domain, watch=watch)
    ours = perform(our_run(), domain=domain)
    relaxed = perform(Run(seed=SEED, until=ALL_RELAXED_BY), domain=domain)
    return Replay(theirs, ours, relaxed, measured(theirs), measured(ours))


def measured(ran: Ran) -> Measures:
    """The papers' quantities of a run in this package's world."""
    return measure(ran.loop.trace.events, verdict=telling.verdict)


def what_relaxing_buys(until: float = PAYS_UNTIL) -> list[Pays]:
    """The same faults with every assumption relaxed as need be, and with none."""
    each = partial(in_turn, kinds=telling.EACH, begin=100.0, apart=100.0, endless=telling.ENDLESS)
    schedules: list[tuple[str, Faults]] = [("the papers'", papers_faults), ("one for each assumption", each)]
    return [
        _pays(name, relax, perform(Run(seed=SEED, relax=relax, faults=faults, until=until)))
        for name, faults in schedules
        for relax in _BOTH
    ]


_BOTH: tuple[Relax, ...] = ("all", "none")


def _pays(faults: str, relax: Relax, ran: Ran) -> Pays:
    m = measured(ran)
    lost = (kind for rejection in telling.lost(ran.came_to) for kind in rejection.faults)
    completed, rejected = telling.counted(ran.came_to)
    last = m.completed.times[-1] if m.completed.times else None
    return Pays(faults, str(relax), completed, rejected, tuple(sorted(set(lost))), last)
