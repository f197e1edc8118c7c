"""A counterexample, found by analysis, run in the executer: step by step the same.

The executer is guided (`runtime.guiding`), basic processes end as the counterexample says, and what is not said (who
comes first to a port, which of several equal leaves acts) is tried, the likeliest first. Every try is a run from the
start, so that nothing has to be taken back.
"""

from __future__ import annotations

from collections.abc import Generator, Iterator, Sequence
from math import inf
from typing import Any

import msgspec

from planner_reactor.reactor.built_ins import BuiltIns
from planner_reactor.rs.configurations import Label, World
from planner_reactor.rs.states import InstanceNumber
from planner_reactor.rs.terms import Process, Value
from planner_reactor.rs.vocabulary import BUILT_IN, Signature
from planner_reactor.runtime import Aborted, Budgets, Executer, Host
from planner_reactor.runtime.guiding import GuidedScheduler, guide
from planner_reactor.runtime.host import BasicProcess

TRIES = 3_000
"""Runs of the executer before a replay is given up."""

CLOSE = 1e-6
"""Seconds within which two instants are one."""


class Moment(msgspec.Struct, frozen=True):
    """A step of the counterexample and the instant at which it is taken."""

    label: Label
    at: float


class _Over(Exception):
    """This run has come to the end of the counterexample, or has left it."""


class Replay(msgspec.Struct, frozen=True):
    """Was the whole of it run? If not, how many steps the best run took, and after how many runs it was given up."""

    done: bool
    steps: int
    tries: int


def replay(processes: Sequence[Process], world: World, labels: Sequence[Label], *, tries: int = TRIES) -> Replay:
    """Run these steps of `processes`, started together, in the executer. `labels` as in a `Lasso`, TIME included."""
    moments = tuple(_moments(labels))
    script: list[int] = []
    best = 0
    for number in range(1, tries + 1):
        attempt = _Attempt(processes, world, moments, script)
        best = max(best, attempt.matched)
        if attempt.matched == len(moments):
            return Replay(True, best, number)
        made = attempt.made
        while made and made[-1][0] + 1 >= made[-1][1]:
            made.pop()
        if not made:
            return Replay(False, best, number)
        script = [choice for choice, _ in made[:-1]] + [made[-1][0] + 1]
    return Replay(False, best, tries)


def _moments(labels: Sequence[Label]) -> Iterator[Moment]:
    now = 0.0
    for label in labels:
        if label[0] == "TIME":
            now += float(label[1][0])  # type: ignore[arg-type]
        else:
            yield Moment(label, now)


class _Attempt:
    """One run: `made` are its choices with how many there were each time; the first follow the script."""

    def __init__(
        self, processes: Sequence[Process], world: World, moments: Sequence[Moment], script: Sequence[int]
    ) -> None:
        self.made: list[tuple[int, int]] = []
        self.matched = 0
        self._moments = moments
        self._script = script
        self._promised: set[int] = set()  # steps that a basic process is to take later
        self._scheduler = GuidedScheduler(self._next, self._number)
        try:
            self._run(processes, world)
        except _Over:
            """As far as it goes."""

    def _run(self, processes: Sequence[Process], world: World) -> None:
        scheduler = self._scheduler
        built_in = BuiltIns(scheduler, {})
        built_in.situations.spawned = set(world.spawned)
        executer = Executer(
            world.program, scheduler=scheduler, host=self._host(world), controls=built_in.controls,
            observer=self._saw, budgets=Budgets(slice=1), on_end=built_in.situations.root_ended,
        )  # fmt: skip
        built_in.attach(executer)
        guide(executer, scheduler)
        for process in processes:
            executer.start_process(process)
        executer.run(until=self._moments[-1].at + 1.0 if self._moments else 0.0)

    def _saw(self, label: Label) -> None:
        if self.matched < len(self._moments):
            wanted = self._moments[self.matched]
            if _same(wanted.label, label) and abs(wanted.at - self._scheduler.now) < CLOSE:
                self.matched += 1
                if self.matched < len(self._moments):
                    return
        raise _Over

    # -- choices

    def _choose(self, count: int) -> int:
        at = len(self.made)
        choice = self._script[at] if at < len(self._script) else 0
        self.made.append((choice, count))
        return choice

    def _next(self, names: Sequence[str]) -> int:
        """Who acts next: those of the name that is wanted come first, then who only has to come to a port."""
        label = self._moments[self.matched].label if self.matched < len(self._moments) else ("", (), "", ())
        port, value = label[1] if label[0] == "COM" else (None, None)

        def rank(name: str) -> int:
            if name.startswith("!"):
                return int(name != f"!{value}")
            kind, _, at = name.partition(" ")
            if kind in ("IN", "OUT"):
                return 0 if at == str(port) else 1
            return 0 if name == label[0] else 2

        order = sorted(range(len(names)), key=lambda n: (rank(names[n]), n))
        return order[self._choose(len(order))]

    def _number(self, stream: str, low: float, high: float) -> float:
        """How long a Term lasts, or what Ran draws: as in some step that is still to come, or to the end."""
        ahead = self._moments[self.matched :]
        if stream == "Ran":
            found: list[float] = [float(v) for m in ahead if m.label[0] == "Ran" for v in m.label[3]]  # type: ignore[arg-type]
        else:
            found = [m.at - self._scheduler.now for m in ahead if m.label[0] == stream]
        options = list(dict.fromkeys([*(n for n in found if low - CLOSE <= n <= high + CLOSE), high]))
        return min(max(options[self._choose(len(options)) if len(options) > 1 else 0], low), high)

    # -- basic processes

    def _host(self, world: World) -> Host:
        host = Host("as told")
        for name, signature in world.signatures.items():
            if name not in BUILT_IN:
                limit = signature.window[1] if signature.window is not None else inf
                host.processes[name] = BasicProcess(signature, self._routine(signature), None, limit, 0)
        host.functions.update(world.functions)
        return host

    def _routine(self, signature: Signature) -> Any:
        def begun(*arguments: Value) -> Generator[float, None, tuple[Value, ...]]:
            """Ends as one of the steps to come that are its own; if none is left, it does not end."""
            ends = [
                n for n in range(self.matched, len(self._moments))
                if n not in self._promised and self._moments[n].label[0] == signature.name
                and _alike(self._moments[n].label[1], arguments)
            ]  # fmt: skip
            options = [*ends, None] if ends else [None]
            chosen = options[self._choose(len(options)) if len(options) > 1 else 0]
            if chosen is None:
                yield max(self._moments[-1].at - self._scheduler.now, 0.0) + 2.0
                raise Aborted("after all that was told")
            self._promised.add(chosen)
            moment = self._moments[chosen]
            yield max(moment.at - self._scheduler.now, 0.0)
            if moment.label[2] == "ab":
                raise Aborted("as told")
            return moment.label[3]

        return begun


def _same(wanted: Label, got: Label) -> bool:
    """The same step, whatever the numbers of instances?"""
    return (
        wanted[0] == got[0] and wanted[2] == got[2] and _alike(wanted[1], got[1]) and _alike(wanted[3], got[3])
    )


def _alike(wanted: tuple[Value, ...], got: tuple[Value, ...]) -> bool:
    return len(wanted) == len(got) and all(
        isinstance(w, InstanceNumber) or w == g for w, g in zip(wanted, got, strict=True)
    )



