"""The planner measured: first adaptation, first ideal reactor, relaxations, steps, growth, executed makespan.

The domain is that of the workcell with as many kinds of parts as asked for; times are CPU seconds of this process.
Nothing is verified before it is issued (`verify=True`: everything is), and nothing foreseen, unless said. The garbage
collector is as in runs on the wall clock, which leave alone what was loaded before (`planner_reactor.runtime.garbage`).
"""

from __future__ import annotations

import gc
import math
import os
import statistics
import subprocess
import sys
import time
from collections.abc import Callable
from contextlib import ExitStack
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from planner_reactor.link.messages import Perception, PerceptionKind
from planner_reactor.logic.domain import Domain
from planner_reactor.logic.reader import read_domain
from planner_reactor.planner import Planner, Step
from planner_reactor.runtime.garbage import seldom_collected
from planner_reactor.workcell.domains import shipped_domain, with_kit
from planner_reactor.workcell.kit import kit_from

NINE = ("AQ", "AS", "AF", "ACT", "ACP", "ADT", "AM", "ADD", "AO")
ROUNDS = 5
COLLECTOR = ExitStack()
COLD = Path(__file__).with_name("bench_first.py")


@cache
def text(kinds: int) -> str:
    """The workcell's domain for a kit of so many kinds."""
    parts = "".join(f'[[part]]\nkind = "p{n}"\n' for n in range(kinds))
    return with_kit(shipped_domain(), kit_from(parts))


@cache
def domain(kinds: int) -> Domain:
    return read_domain(text(kinds))


def planner(kinds: int, **options: Any) -> Planner:
    return Planner(domain(kinds), **{"relax": (), **UNVERIFIED, **options})


UNVERIFIED: dict[str, Any] = {"verify": False} if "verify" in (Planner.__init__.__kwdefaults__ or {}) else {}


def tell(subject: Planner, kind: PerceptionKind, about: str) -> None:
    subject.perceive(Perception(number=1, time=0.0, kind=kind, subject=about))


def settle(subject: Planner, steps: list[float] | None = None) -> int:
    """Step until there is nothing to do, every adaptation applied at once; how many there were."""
    issued = 0
    while True:
        began = time.process_time()
        step = subject.step()
        if steps is not None:
            steps.append(time.process_time() - began)
        if step is None:
            return issued
        issued += len(step.adaptations)
        answer(subject, step)


def answer(subject: Planner, step: Step) -> None:
    for adaptation in step.adaptations:
        tell(subject, "adaptation_applied", str(adaptation.id))


def until_issued(subject: Planner) -> Step:
    while (step := subject.step()) is not None:
        if step.adaptations:
            return step
    raise RuntimeError("nothing is issued")


def median_ms(prepare: Callable[[], Any], work: Callable[[Any], object], rounds: int = ROUNDS) -> float:
    """Milliseconds of CPU that the work takes; what is prepared for each round does not count."""
    taken = []
    for _ in range(rounds):
        subject = prepare()
        gc.collect()
        began = time.process_time()
        work(subject)
        taken.append(time.process_time() - began)
    return statistics.median(taken) * 1e3


def first_adaptation(kinds: int, **options: Any) -> float:
    return median_ms(lambda: domain(kinds), lambda _: until_issued(planner(kinds, **options)))


def first_ideal(kinds: int, **options: Any) -> float:
    return median_ms(lambda: domain(kinds), lambda _: settle(planner(kinds, **options)))


def planned(kinds: int, **options: Any) -> Planner:
    made = planner(kinds, **options)
    settle(made)
    return made


def relaxing(kinds: int, name: str, **options: Any) -> float:
    """From the failure of an assumption, signalled to a planner at rest, until everything is issued for it."""

    def fail(subject: Planner) -> None:
        tell(subject, "assumption_failure", name)
        settle_real(subject)

    return median_ms(lambda: planned(kinds, **options), fail)


def settle_real(subject: Planner) -> None:
    """Until there is nothing to do but to think ahead."""
    while (step := subject.step()) is not None and step.kind != "foresee":
        answer(subject, step)


def anew(kinds: int, name: str, *, reading: bool, **options: Any) -> float:
    """Planning from nothing without an assumption; with `reading` the domain is read first."""

    def build(_: object) -> None:
        whole = read_domain(text(kinds)) if reading else domain(kinds)
        made = Planner(whole, **{"relax": (), **UNVERIFIED, **options})
        tell(made, "assumption_failure", name)
        settle(made)

    return median_ms(lambda: domain(kinds), build)


def all_nine(kinds: int, **options: Any) -> float:
    """Everything: the first ideal reactor and all relaxations."""
    return median_ms(lambda: domain(kinds), lambda _: settle(planner(kinds, relax="all", **options)))


def exponent(few: float, many: float, ratio: float = 4.0) -> float:
    return math.log(many / few) / math.log(ratio)


def reactions_to_failures(kinds: int, rounds: int = 3, **options: Any) -> list[float]:
    """Milliseconds from a failure signalled to the first adaptation issued, the planner being at work on another."""
    found = []
    leave_alone()
    for _ in range(rounds):
        for busy in NINE:
            for name in NINE:
                if busy != name:
                    subject = planned(kinds, **options) if kinds <= 25 else planner(kinds, **options)
                    if kinds > 25:
                        answer(subject, until_issued(subject))
                    tell(subject, "assumption_failure", busy)
                    if (step := subject.step()) is not None:
                        answer(subject, step)
                    began = time.process_time()
                    tell(subject, "assumption_failure", name)
                    while (step := subject.step()) is not None and not step.adaptations:
                        pass
                    found.append((time.process_time() - began) * 1e3)
    return sorted(found)


def leave_alone() -> None:
    """The collector as in runs on the wall clock (`planner_reactor.runtime.garbage`), from now on."""
    domain(100)
    COLLECTOR.enter_context(seldom_collected())


def steps_ms(kinds: int, rounds: int = 3, **options: Any) -> list[float]:
    """Milliseconds of every step on the way to the last relaxation, in order of length."""
    found: list[float] = []
    leave_alone()
    for _ in range(rounds):
        gc.collect()
        settle(planner(kinds, relax="all", **options), found)
    return sorted(seconds * 1e3 for seconds in found)


def from_process_start(kinds: int) -> float:
    """CPU milliseconds from the start of a Python process until it has read a domain and planned an adaptation."""
    with TemporaryDirectory() as folder:
        file = Path(folder) / "kit.itl"
        file.write_text(text(kinds), encoding="utf-8")
        return process_ms(str(COLD), str(file))


def process_ms(*command: str) -> float:
    """CPU milliseconds of a Python process until it says how many seconds it has taken, its byte code being there as
    after any first use: the first of several runs compiles, and does not count.
    """
    taken = []
    with TemporaryDirectory() as folder:
        environment = {k: v for k, v in os.environ.items() if k != "PYTHONDONTWRITEBYTECODE"}
        environment["PYTHONPYCACHEPREFIX"] = folder
        for _ in range(ROUNDS + 1):
            done = subprocess.run([sys.executable, *command], check=True, env=environment, stdout=subprocess.PIPE)
            taken.append(float(done.stdout.split()[-1]))
    return statistics.median(taken[1:]) * 1e3
