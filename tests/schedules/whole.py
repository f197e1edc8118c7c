"""The same schedules with nothing left out: the real reactor under the real planner, all laws asked after every event.

The host is made from the domain: every basic process takes a while and now and then aborts, every assumption is a flag
that a schedule turns. Slower by a hundred times than `life`, which leaves the bodies of reactions out.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Iterator
from functools import partial
from typing import Any

from planner_reactor.experiments.loop import Loop
from planner_reactor.logic.domain import Domain
from planner_reactor.planner import Planner
from planner_reactor.runtime import Aborted, Host, Scheduler
from planner_reactor.trace import Trace
from tests.planner.driving import image
from tests.schedules.ledger import Unsafe, read
from tests.schedules.life import domain, ideal

LONGEST, FAILS = 6.0, 0.05
"""Seconds that a basic process takes at most, and how often it aborts."""

MOST_WAIT = 4000.0
"""Seconds in which all that has returned is read, whatever its monitor waits: 64 of the café's minutes, and some."""


class WholeLife:
    """A run that goes on from schedule to schedule."""

    def __init__(self, name: str, returning: bool, seed: int, *, period_ms: int | None = None) -> None:
        self.name, self.returning = name, returning
        self.domain = domain(name, returning)
        self.truth = dict.fromkeys(self.domain.assumptions, True)
        planner = Planner(self.domain, relax=(), period_ms=period_ms)
        self.loop = Loop(planner, lambda s, t: _host(self.domain, self.truth, s, t), seed=seed, keep_trace=False)
        self.loop.reactor.start()
        self.loop.scheduler.soon(self.loop._turn)
        self._until(60.0)

    def run(self, seed: object) -> None:
        """One schedule: flags are turned at random instants, then they stay; raises Unsafe."""
        draw = random.Random(f"whole {seed}")
        at = self.loop.scheduler.now
        for _ in range(draw.randrange(1, 5)):
            at += draw.expovariate(1 / 8)
            name, holds = draw.choice(list(self.truth)), draw.random() < 0.5
            self.loop.scheduler.call_at(at, lambda name=name, holds=holds: self._turned(name, holds))
        self._until(at)
        self._until(at + MOST_WAIT, _settled(self))
        self._ended_right()

    def _turned(self, name: str, holds: bool) -> None:
        self.truth[name] = holds

    def _until(self, at: float, done: Callable[[], bool] = lambda: False) -> None:
        while self.loop.scheduler.now < at and not done():
            self.loop.reactor.executer.run(until=min(at, self.loop.scheduler.now + 4.0))

    def _ended_right(self) -> None:
        planner, reactor = self.loop.planner, self.loop.reactor
        if reactor.laws.violations or reactor.laws.interruptions or planner.breaches:
            raise Unsafe(f"{reactor.laws.violations[:3]} {planner.breaches}")
        relaxed = frozenset(planner.relaxed)
        right = ideal(self.name, self.returning, relaxed, planner._assuming.beliefs.told)
        if not planner.ideal or planner.pending or image(planner) != right:
            raise Unsafe(f"not the ideal reactor without {sorted(relaxed)}: {planner.expectation} {planner.impossible}")
        false = {name for name, holds in self.truth.items() if not holds}
        returned = {n for n in relaxed - false if self.domain.assumptions[n].reinstatable}
        if set(reactor.assumptions_in_use) & false or returned:
            raise Unsafe(f"it rests on {reactor.assumptions_in_use}; false: {sorted(false)}, back: {sorted(returned)}")
        standing = {text.partition(" = ")[2] for text in reactor.journal.state.committed.clauses.values()}
        if {text for text in standing if read(text).serves} != {segment.text for segment in planner.model}:
            raise Unsafe("what stands is not what the planner knows")


def _settled(life: WholeLife) -> Callable[[], bool]:
    """Is nothing to be expected any more?"""

    def done() -> bool:
        planner, reactor = life.loop.planner, life.loop.reactor
        false = {name for name, holds in life.truth.items() if not holds}
        waiting = any(life.domain.assumptions[n].reinstatable for n in set(planner.relaxed) - false)
        quiet = planner.ideal and not planner.pending and not len(life.loop.adaptations)
        return quiet and not waiting and not set(reactor.assumptions_in_use) & false

    return done


def _host(domain: Domain, truth: dict[str, bool], scheduler: Scheduler, trace: Trace) -> Host:
    host, draw = Host("schedules"), scheduler.random("host")
    noticed = [a.name for a in domain.assumptions.values() if a.monitor != "flag"]

    def deed(results: int) -> Iterator[Any]:
        """Takes a while, sees what no monitor asks for, now and then aborts."""
        yield draw.uniform(0.5, LONGEST)
        for name in noticed:
            if not truth[name]:
                host.report(name, False, "noticed")
        if draw.random() < FAILS:
            raise Aborted("it happens")
        return "thing" if results == 1 else ("thing",) * results if results else None

    for schema in domain.schemas.values():
        if not schema.abstract:
            results = tuple(schema.variables[v] for v in schema.outputs)
            process = _taking(len(schema.inputs), partial(deed, len(results)))
            host.process(results=results, window=(0.0, LONGEST), name=schema.name)(process)
    for name in truth:
        host.assumption(name)(partial(truth.__getitem__, name))
    return host


def _taking(inputs: int, deed: Callable[[], Iterator[Any]]) -> Callable[..., Iterator[Any]]:
    """The deed as a process of so many inputs."""
    return (lambda: deed(), lambda a: deed(), lambda a, b: deed())[inputs]
