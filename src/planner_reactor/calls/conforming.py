"""An online monitor: a live run is held against the semantics, step by step (`--conform`).

A `Monitor` attends an executer from before its first root begins, and follows each of its steps through `rs.evolves`.
The first thing that the semantics does not allow is reported, with the labels that led to it; then it follows no
further. It changes nothing: a run with it has the same trace as without. It costs about a millisecond a step, more in
large reactors; `budget` bounds the steps. What it cannot judge it says: `blind` is why it stopped following.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable, Mapping
from typing import Any

from planner_reactor.analysis.conformance import Disagreement, Follower
from planner_reactor.errors import BudgetError
from planner_reactor.reactor.reactor import EQUATION_3, Reactor
from planner_reactor.rs.configurations import Label, World, spawned_situations
from planner_reactor.rs.terms import Process, Program, Schema, Value
from planner_reactor.rs.vocabulary import BUILT_IN
from planner_reactor.runtime import Executer, Host, Root
from planner_reactor.trace import Event, Trace

BUDGETS = ("zeno", "crowded")
"""What the trace records when a budget of the executer acts: the semantics knows no budgets."""


LATENESS = 0.25
"""Seconds by which a step may be late on the wall clock: the semantics knows no time that computing takes."""


class Monitor:
    """Follows one run; `disagreement` is None as long as it does what the semantics allows.

    `lateness` is by how many seconds a step may come after its time: 0 on the virtual clock, `LATENESS` on the wall's.
    """

    def __init__(
        self,
        executer: Executer,
        program: Program,
        host: Host,
        trace: Trace,
        *,
        lateness: float = 0.0,
        budget: int | None = None,
    ) -> None:
        signatures = {**BUILT_IN, **host.signatures}
        world = World(program, signatures, host.functions, spawned=spawned_situations(program))
        self._follower = Follower((), world)
        self._scheduler = executer.scheduler
        self._budget = budget
        self._lateness = lateness
        self._behind = 0.0  # seconds by which the run is late
        self._seen = self._scheduler.now
        self.roots = 0
        self.disagreement: str | None = None
        self.blind: str | None = None
        executer.attend(self)
        trace.sinks.append(self._recorded)

    @property
    def steps(self) -> int:
        """How many steps it has followed."""
        return self._follower.steps

    def report(self) -> dict[str, Any]:
        """What came of it, for people and programs."""
        return {
            "steps": self.steps,
            "roots": self.roots,
            "until_s": self._seen,
            "disagreement": self.disagreement,
            "blind": self.blind,
            "last": [written(label) for label in self._follower.last] if self.disagreement else [],
        }

    # -- what it is told

    def loaded(self, schemas: Iterable[Schema]) -> None:
        self._follow(lambda follower: follower.learns(schemas))

    def unloaded(self, schemas: Iterable[Schema]) -> None:
        self._follow(lambda follower: follower.learns((), without=schemas))

    def began(self, root: Root, process: Process, bound: Mapping[str, Value]) -> None:
        self.roots += 1
        scope = tuple(sorted(bound.items()))
        self._follow(lambda follower: follower.begins(root.number, process, scope))

    def took(self, label: Label, sites: tuple[Hashable, ...]) -> None:
        self._follow(lambda follower: follower.saw(label, sites))
        if self._budget is not None and self.steps >= self._budget:
            self.blind = self.blind or f"its budget of {self._budget} steps is used up"

    def ended(self, root: Root, *, killed: bool) -> None:
        def over(follower: Follower) -> None:
            if killed:
                follower.kills(root.number)
            else:
                results = tuple(sorted(root.results.items()))
                follower.ended(root.number, ok=root.outcome == "stop", results=results)
            follower.forgets(root.number)

        self._follow(over)

    def _recorded(self, event: Event) -> None:
        """What happens to the situations, or to the run, that is no step of the program."""
        match event.kind, event.data:
            case kind, _ if kind in BUDGETS:
                self.blind = self.blind or f"a budget of the executer acted ({kind})"
            case "inhibited", {"situation": situation, "owner": owner, "because": "assumption"}:
                self._follow(lambda follower: follower.disables(situation, owner))
            case "uninhibited", {"situation": situation, "owner": owner}:
                self._follow(lambda follower: follower.enables(situation, owner))

    def _follow(self, told: Callable[[Follower], object]) -> None:
        if self.disagreement is not None or self.blind is not None:
            return
        now = self._scheduler.now
        try:
            self._pass(round(now - self._seen, 9))
            self._seen = now
            told(self._follower)
        except Disagreement as problem:
            self.disagreement = f"at {now:.3f} s: {problem}"
        except BudgetError as problem:
            self.blind = str(problem)


    def _pass(self, seconds: float) -> None:
        """As much of the time as may pass, passes; a run on the wall clock may be late with the rest."""
        due = seconds + self._behind
        if self._lateness and due > 0:
            self._behind = max(0.0, due - self._follower.room())
            due -= self._behind
            if self._behind > self._lateness:
                raise Disagreement(f"{self._behind:.3f} s late, at most {self._lateness} s are excused")
        self._follower.passed(due)


def attend(reactor: Reactor, *, lateness: float = 0.0, budget: int | None = None) -> Monitor:
    """Hold a reactor that has not begun yet against the semantics."""
    return Monitor(
        reactor.executer, EQUATION_3, reactor.host, reactor.trace, lateness=lateness, budget=budget
    )  # fmt: skip


def written(label: Label) -> str:
    """A label, for people: `SIT[order]<1, 4> ok`."""
    name, arguments, status, values = label
    given = f"[{', '.join(map(str, arguments))}]" if arguments else ""
    results = f"<{', '.join(map(str, values))}>" if values else ""
    return f"{name}{given}{results} {status}"
