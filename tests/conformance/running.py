"""Run a program in the executer, follow it through `rs.evolves`, and compare."""

from __future__ import annotations

import random
from collections.abc import Iterator
from typing import NamedTuple

from planner_reactor.analysis.conformance import Follower
from planner_reactor.errors import BudgetError
from planner_reactor.reactor.built_ins import BuiltIns
from planner_reactor.rs.configurations import Label, World, spawned_situations
from planner_reactor.rs.vocabulary import BUILT_IN
from planner_reactor.runtime import Aborted, Budgets, Executer, Host, Root, Scheduler, VirtualClock
from tests.conformance.texts import Example

LONGEST = 10.0
"""Seconds of the virtual clock."""

MOST_STEPS = 40
MOST_CONFIGURATIONS = 16


class Enough(Exception):
    """The program has been followed far enough (it may never end)."""


class Chance:
    """Where the basic processes of `HOST` take their chances: renewed for each run."""

    draw = random.Random(0)


def _chance() -> Host:
    """Basic processes that take random times and end either way, and functions, of which one fails."""
    host = Host("chance")

    def fate(risk: float) -> None:
        if Chance.draw.random() < risk:
            raise Aborted("as it happens")

    @host.process(window=(0.0, 0.0))
    def Quick() -> None:
        fate(0.3)

    @host.process(window=(0.5, 3.0))
    def Slow() -> Iterator[float]:
        yield Chance.draw.choice([0.5, 1.0, 2.0, 2.5])
        fate(0.3)

    @host.process(window=(0.0, 2.0), results=("x",))
    def Give() -> Iterator[float]:
        yield Chance.draw.choice([0.0, 1.0])
        fate(0.2)
        return Chance.draw.choice([0, 1, 2])

    @host.process(window=(1.0, 1.0))
    def Fixed() -> Iterator[float]:
        yield 1.0

    @host.process(window=(0.0, float("inf")), limit=1000.0)
    def Never() -> Iterator[float]:
        yield 500.0

    @host.process(window=(0.25, 1.0))
    def Takes(x: float) -> Iterator[float]:
        yield Chance.draw.choice([0.25, 0.5, 1.0])

    @host.function
    def twice(x: float) -> float:
        return 2 * x

    @host.function
    def broken(x: object) -> object:
        raise ValueError("as announced")

    return host


HOST = _chance()
SIGNATURES = {**BUILT_IN, **HOST.signatures}


class Conformed(NamedTuple):
    """A run that the semantics allows: how many steps were followed; `lost` if it could not be followed further."""

    steps: int
    lost: bool = False


def conforms(example: Example, seed: int, *, most: int = MOST_STEPS) -> Conformed:
    """Run, follow and compare, for at most `most` steps. Raises `Disagreement`."""
    Chance.draw = random.Random(seed)
    scheduler = Scheduler(VirtualClock(), seed=seed)
    built_in = BuiltIns(scheduler, {"A": lambda: Chance.draw.choice([True, False, None])})
    spawned = spawned_situations(example.program, *example.processes)
    built_in.situations.spawned = set(spawned)
    world = World(program=example.program, signatures=SIGNATURES, functions=HOST.functions, spawned=spawned)
    follower = Follower(example.processes, world, most=MOST_CONFIGURATIONS)
    seen = 0.0

    def passed() -> None:
        nonlocal seen
        follower.passed(round(scheduler.now - seen, 9))
        seen = scheduler.now

    def observe(label: Label) -> None:
        passed()
        follower.saw(label, executer.sites)
        if follower.steps >= most:
            raise Enough

    def over(root: Root) -> None:
        built_in.situations.root_ended(root)
        if root in killed:
            passed()
            follower.kills(root.number)

    def kill() -> None:
        if roots[-1].outcome is None:
            killed.add(roots[-1])
            executer.kill(roots[-1])

    killed: set[Root] = set()
    executer = Executer(
        example.program,
        scheduler=scheduler,
        host=HOST,
        controls=built_in.controls,
        observer=observe,
        budgets=Budgets(slice=seed % 3 * 31 + 1),
        on_end=over,
    )
    built_in.attach(executer)
    roots = [executer.start_process(process) for process in example.processes]
    if seed % 5 == 0:
        scheduler.call_at(Chance.draw.choice([0.0, 0.5, 1.0, 2.0]), kill)
    try:
        executer.run(until=LONGEST)
    except Enough:
        return Conformed(follower.steps)
    except BudgetError:
        return Conformed(follower.steps, lost=True)
    _same_ends(roots, follower)
    return Conformed(follower.steps)


def _same_ends(roots: list[Root], follower: Follower) -> None:
    for number, root in enumerate(roots, 1):
        if root.outcome is None:
            follower.runs(number)
        else:
            follower.ended(number, ok=root.outcome == "stop", results=tuple(sorted(root.results.items())))
