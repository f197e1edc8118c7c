"""How the tests of the executer drive it: a text, the virtual clock, and everything that was seen."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from planner_reactor.rs.parser import parse_process, parse_program
from planner_reactor.runtime import Budgets, Control, Executer, Host, Label, Root, Scheduler, VirtualClock
from planner_reactor.trace import Trace


@dataclass
class Run:
    """What happened: `seen` are the labels of the steps, `at` the instants at which they were taken."""

    root: Root
    executer: Executer
    seen: list[Label]
    at: list[float]
    trace: Trace

    @property
    def outcome(self) -> str | None:
        return self.root.outcome

    @property
    def results(self) -> dict[str, object]:
        return self.root.results

    @property
    def now(self) -> float:
        return self.executer.scheduler.now

    @property
    def names(self) -> list[str]:
        """The names of the processes that took a step, in order."""
        return [label[0] for label in self.seen]


def begin(
    process: str,
    program: str = "",
    *,
    host: Host | None = None,
    controls: Iterable[Control] = (),
    budgets: Budgets | None = None,
    seed: int = 0,
) -> Run:
    """Start the process; nothing has run yet."""
    scheduler = Scheduler(VirtualClock(), seed=seed)
    seen: list[Label] = []
    at: list[float] = []

    def observer(label: Label) -> None:
        seen.append(label)
        at.append(scheduler.now)

    trace = Trace(lambda: scheduler.now)
    executer = Executer(
        parse_program(program), scheduler=scheduler, host=host, controls=controls, observer=observer, trace=trace,
        budgets=budgets,
    )  # fmt: skip
    return Run(executer.start_process(parse_process(process)), executer, seen, at, trace)


def run(
    process: str,
    program: str = "",
    *,
    until: float = 100.0,
    host: Host | None = None,
    controls: Iterable[Control] = (),
    budgets: Budgets | None = None,
    seed: int = 0,
) -> Run:
    """Start the process and run until it ends, nothing is left to do, or `until`."""
    begun = begin(process, program, host=host, controls=controls, budgets=budgets, seed=seed)
    begun.executer.run(until)
    return begun
