"""The executer takes only steps that `evolves` allows, and reaches the same outcomes: random programs.

All operators, ports, delays, tests, basic processes with age windows, and situations with drains, inhibitions and
disabling, on the virtual clock. `CONFORMANCE_PROGRAMS` sets how many programs a run of the tests tries.
"""

from __future__ import annotations

import contextlib
import os
import random
from collections.abc import Iterator

import pytest

from planner_reactor.analysis.conformance import Follower
from planner_reactor.errors import BudgetError
from planner_reactor.reactor.built_ins import BuiltIns
from planner_reactor.rs.configurations import World, spawned_situations
from planner_reactor.rs.parser import parse_process
from planner_reactor.rs.terms import Process, Program
from planner_reactor.rs.vocabulary import BUILT_IN
from planner_reactor.runtime import Aborted, Budgets, Executer, Host, Scheduler, VirtualClock

PROGRAMS = int(os.environ.get("CONFORMANCE_PROGRAMS", "1500"))
CHUNK = 50
MOST_STEPS = 60


class Enough(Exception):
    """The program has been followed far enough (it may never end)."""


class Texts:
    """Random program texts. Names of results are never used twice, so no two siblings clash."""

    def __init__(self, seed: int) -> None:
        self.draw = random.Random(seed)
        self.names = 0

    def fresh(self) -> str:
        self.names += 1
        return f"x{self.names}"

    def roots(self) -> list[str]:
        if self.draw.random() < 0.4:
            return [self.process(3, [])]
        served = [self.reaction(s) for s in ("s", "t") for _ in range(self.draw.choice([1, 1, 2]))]
        guarded = [f"(E[{n}] # {text})" if self.draw.random() < 0.5 else text for n, text in enumerate(served, 1)]
        drivers = [f"({self.process(2, [], situations=True)})" for _ in range(self.draw.choice([1, 2]))]
        reactor = " | ".join([*guarded, *drivers])
        scripts = [self.script() for _ in range(self.draw.choice([0, 1, 1, 2]))]
        return [reactor, *scripts]

    def reaction(self, situation: str) -> str:
        loop = self.draw.choice([":;", ":;", "::"])
        k, x = self.fresh(), self.fresh()
        body = self.process(2, [x], situations=situation == "s", key=(situation, k))
        end = self.draw.choice([f"SUCCEED[{situation}, {k}]", f"FAIL[{situation}, {k}]"])
        update = f"UPDATE[{situation}, {k}, {x}, 7] ; " if self.draw.random() < 0.4 else ""
        return f"(SIT[{situation}]<{k}, {x}> {loop} (({body}) ; ({update}{end})))"

    def script(self) -> str:
        kinds = ["DRAIN[s]", "DRAIN[t]", "WAIT[s]", "WAITINHIBIT[t]", "INHIBIT[s]", "UNINHIBIT[s]", "UNINHIBIT[t]",
                 "KILL[1]", "KILL[2]", "KILL[9]", "DISABLE[s, A]", "ENABLE[s, A]", "DISABLE[t, A]", "ENABLE[t, A]",
                 "Delay[1]", "POST[7]", "ADD<m>", "DRAIN[s] # Delay[2]", "WAIT[t] # Delay[1]",
                 "RENEW[s]", "RENEW[t]", "RETIRE[1]", "RETIRE[2]", "WAITOLD[s]", "WAITOLD[t]", "POST[1]"]  # fmt: skip
        parts = [self.draw.choice(kinds) for _ in range(self.draw.randint(1, 5))]
        parts = [p.replace("<m>", f"<{self.fresh()}>") for p in parts]
        return self.draw.choice([" ; ", " : "]).join(f"({p})" for p in parts)

    def process(
        self, depth: int, bound: list[str], situations: bool = False, key: tuple[str, str] | None = None
    ) -> str:
        if depth == 0 or self.draw.random() < 0.25:
            return self.leaf(bound, situations, key)
        inner = depth - 1
        kind = self.draw.choice([";", ":", ";", ":", "|", "&", "#", "#", "~", "if", ":;", "::"])

        def part(names: list[str]) -> str:
            return f"({self.process(inner, names, situations, key)})"

        if kind == "~":
            return f"~{part(bound)}"
        if kind == "if":
            return f"(if {part(bound)} then {part(bound)} else {part(bound)})"
        if kind in (":;", "::"):
            x, most = self.fresh(), self.draw.choice([1, 2])
            port = self.draw.choice("pq")
            return f"(((IN[{port}]<{x}> # Delay[{most}]) : GTR[{x}, 0]) {kind} {part([*bound, x])})"
        if kind in (";", ":"):
            x = self.fresh()
            first = self.draw.choice([f"Give<{x}>", f"IN[p]<{x}>", f"Ran[0, 2]<{x}>", f"(Give<{x}> # Delay[1])"])
            if self.draw.random() < 0.5:
                return f"({first} {kind} {part([*bound, x])})"
        return kind.join(part(bound) for _ in range(self.draw.choice([2, 2, 3])))

    def leaf(self, bound: list[str], situations: bool, key: tuple[str, str] | None) -> str:
        x = self.draw.choice([*bound, "1", "2"])
        plain = ["STOP", "ABORT", "NIL", "Quick", "Slow", "Slow", f"Delay[{self.draw.choice([0, 1, 2])}]", "Term[2]",
                 f"OUT[p, {x}]", f"OUT[q, {x}]", f"OUT[p, {x}]", f"GTR[{x}, 1]", f"LST[{x}, 2]", f"Equal[{x}, 1]",
                 f"Delay[{x}]", "SUSPEND[500]"]  # fmt: skip
        if situations and self.draw.random() < 0.5:
            kind = self.draw.choice(["ASSERT", "REASSERT", "ASSERT"])
            s = self.draw.choice(["t"] if key else ["s", "t"])
            return f"{kind}[{s}, {x}]" + (f"<{self.fresh()}>" if self.draw.random() < 0.5 else "")
        if key and self.draw.random() < 0.15:
            return self.draw.choice([f"SUCCEED[{key[0]}, {key[1]}]", f"FAIL[{key[0]}, {key[1]}]", f"STUB[{key[0]}]"])
        return self.draw.choice(plain)


def chance(scheduler: Scheduler) -> Host:
    """Basic processes that take random times and end either way."""
    host = Host("chance")
    draw = scheduler.random("host")

    @host.process(window=(0.0, 0.0))
    def Quick() -> None:
        if draw.random() < 0.3:
            raise Aborted("as it happens")

    @host.process(window=(0.5, 3.0))
    def Slow() -> Iterator[float]:
        yield draw.choice([0.5, 1.0, 2.0, 2.5])
        if draw.random() < 0.3:
            raise Aborted("as it happens")

    @host.process(window=(0.0, 2.0), results=("x",))
    def Give() -> Iterator[float]:
        yield draw.choice([0.0, 1.0])
        if draw.random() < 0.2:
            raise Aborted("as it happens")
        return draw.choice([0, 1, 2])

    return host


def conforms(processes: list[Process], seed: int) -> int:
    """Run, follow, compare; the number of steps."""
    scheduler = Scheduler(VirtualClock(), seed=seed)
    host = chance(scheduler)
    built_in = BuiltIns(scheduler)
    built_in.situations.spawned = set(spawned_situations(Program(), *processes))
    world = World(
        signatures={**BUILT_IN, **host.signatures}, spawned=spawned_situations(Program(), *processes)
    )
    follower = Follower(processes, world)
    seen = [0.0]

    def observe(label: tuple[str, tuple[object, ...], str, tuple[object, ...]]) -> None:
        follower.passed(round(scheduler.now - seen[0], 9))
        seen[0] = scheduler.now
        follower.saw(label, executer.sites)
        if follower.steps >= MOST_STEPS:
            raise Enough

    executer = Executer(
        Program(),
        scheduler=scheduler,
        host=host,
        controls=built_in.controls,
        observer=observe,
        budgets=Budgets(slice=seed % 3 * 31 + 1),
        on_end=lambda root: built_in.situations.root_ended(root),
    )
    built_in.attach(executer)
    roots = [executer.start_process(process) for process in processes]
    with contextlib.suppress(Enough, BudgetError):
        executer.run(until=12.0)
        for number, root in enumerate(roots, 1):
            if root.outcome is None:
                follower.runs(number)
            else:
                results = tuple(sorted((k, v) for k, v in root.results.items()))
                follower.ended(number, ok=root.outcome == "stop", results=results)
    return follower.steps


@pytest.mark.parametrize("chunk", range(PROGRAMS // CHUNK))
def test_random_programs_conform(chunk: int) -> None:
    steps = 0
    for seed in range(chunk * CHUNK, (chunk + 1) * CHUNK):
        texts = Texts(seed).roots()
        try:
            steps += conforms([parse_process(text, file=f"root{n}") for n, text in enumerate(texts)], seed)
        except Exception as problem:
            raise AssertionError(f"program {seed}: {texts}") from problem
    assert steps > 3 * CHUNK
