"""`ideal`: are the planner's kitting reactors ω-ideal? Equations (8), (10) to (12) of R, checked, not sampled.

The planner plans for a kit of one or two kinds with all assumptions, with each given up, and with all but AO given up;
each reactor is explored beside the environment model in which all hold and those in which one fails. What is checked:
no kit is ever refused, and under strong fairness kits are accepted again and again. The reactor is sliced: guards and
monitors do nothing while no planner speaks to them.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import msgspec

from planner_reactor.analysis.ideal import Partial, Reactor, achieves, converges, partially_ideal
from planner_reactor.analysis.labels import show_label
from planner_reactor.analysis.notation import read_property
from planner_reactor.analysis.properties import Verdict
from planner_reactor.experiments.trials import write_json
from planner_reactor.link.messages import Adaptation, Perception, PerceptionKind
from planner_reactor.logic.domain import Domain
from planner_reactor.logic.reader import read_domain
from planner_reactor.planner import Planner
from planner_reactor.rs.parser import parse_program
from planner_reactor.rs.printer import show
from planner_reactor.rs.terms import Number, Schema, calls
from planner_reactor.workcell.domains import shipped_domain, with_kit
from planner_reactor.workcell.environments import ASSUMPTIONS, kitting
from planner_reactor.workcell.kit import KitSpec, PartKind

GOAL = read_property("never sent kit[refused] and always eventually sent kit[accepted] under strong fairness")
"""GEM, seen from downstream: whatever happens, kits come, and each has what it should have."""

MONITORS = ("ASSUMONITOR", "HOLDMONITOR")
NOTHING: frozenset[str] = frozenset()


class Planned(msgspec.Struct):
    """A reactor as it grows: its clauses by label, and the assumptions that each situation rests on."""

    clauses: dict[object, Schema] = msgspec.field(default_factory=dict)
    rests: dict[str, frozenset[str]] = msgspec.field(default_factory=dict)

    def apply(self, adaptation: Adaptation) -> None:
        for killed in adaptation.kills:
            self.clauses.pop(killed, None)
        for schema in parse_program(adaptation.definitions).schemas:
            (label,) = schema.head
            assert isinstance(label, Number)
            self.clauses[label.value] = schema
        for situation in adaptation.removed:
            self.rests.pop(situation, None)
        for change in adaptation.changes:
            self.rests[change.situation] = frozenset(change.assumptions)

    def text(self) -> str:
        """The program, without guards and monitors."""
        kept = [s for _, s in sorted(self.clauses.items(), key=lambda c: str(c[0]).zfill(9)) if not _monitor(s)]
        clauses = "".join(f"P[{show_head(s)}] = {show(s.body)}\n" for s in kept)
        return f"REACTOR = {' | '.join(f'P[{show_head(s)}]' for s in kept)}\n{clauses}"

    def used(self) -> frozenset[str]:
        return frozenset().union(*self.rests.values())


def show_head(schema: Schema) -> str:
    (label,) = schema.head
    return str(label.value) if isinstance(label, Number) else str(label)


def _monitor(schema: Schema) -> bool:
    return any(call.name in MONITORS for call in calls(schema.body))


class Planning:
    """The planner, whose adaptations are applied at once to a reactor that is only written down."""

    def __init__(self, kinds: Sequence[str]) -> None:
        self.reactor = Planned()
        self._planner = Planner(domain_for(kinds), relax=())
        self._perceived = 0

    def without(self, *assumptions: str) -> Iterator[Planned]:
        """Give these up; the reactor after each adaptation that follows, the same object."""
        for name in assumptions:
            self._perceive("assumption_failure", name)
        while (step := self._planner.step()) is not None:
            for adaptation in step.adaptations:
                self.reactor.apply(adaptation)
                self._perceive("adaptation_applied", str(adaptation.id))
                yield self.reactor

    def _perceive(self, kind: PerceptionKind, subject: str) -> None:
        self._perceived += 1
        self._planner.perceive(Perception(number=self._perceived, time=0.0, kind=kind, subject=subject))


def domain_for(kinds: Sequence[str]) -> Domain:
    """The shipped domain for a kit of these kinds."""
    parts = tuple(PartKind(kind, (f"{kind}_a",), f"{kind}_a") for kind in kinds)
    kit = KitSpec("slice", parts, tuple(kinds), 30.0)
    return read_domain(with_kit(shipped_domain(), kit), file="kitting.itl")


def planned(kinds: Sequence[str], without: Sequence[str] = ()) -> Reactor:
    """The complete reactor for this kit without these assumptions, and what it rests on."""
    planning = Planning(kinds)
    for _ in planning.without(*without):
        """Up to the last adaptation."""
    return Reactor(planning.reactor.text(), planning.reactor.used())


def chain(kinds: Sequence[str], assumption: str) -> tuple[Partial, ...]:
    """(9), (10): the reactors from the ideal one with the assumption to the ideal one without it.

    What is not finished is counted by kinds: which of them some situation still rests on the assumption for.
    """
    planning = Planning(kinds)
    for _ in planning.without():
        """The ideal reactor with everything assumed."""
    everything = (*kinds, "tray")
    found = [Partial(planning.reactor.text(), _still(planning.reactor, assumption, everything))]
    for reactor in planning.without(assumption):
        found.append(Partial(reactor.text(), _still(reactor, assumption, everything)))
    return tuple(found)


def _still(reactor: Planned, assumption: str, kinds: Sequence[str]) -> frozenset[str]:
    """For which kinds does some situation rest on it?"""
    resting = [situation for situation, names in reactor.rests.items() if assumption in names]
    return frozenset(f"{assumption}({kind})" for kind in kinds if any(s.endswith(kind.title()) for s in resting))


def environment(kinds: Sequence[str]) -> Callable[[frozenset[str]], str]:
    """The environment model for this kit, by the assumptions that fail."""
    return lambda failing: kitting(kinds, sorted(failing))


# ------------------------------------------------------------------------------------------------- the experiment


def experiment(
    out: Path, *, trials: int | None, workers: int, watch: Callable[[int, int], object]
) -> Mapping[str, Any]:
    """The registry's entry: `ideal.json` in `out`; the verdicts as rows."""
    rows = []
    asked = list(questions())
    for number, (assumption, kinds) in enumerate(asked):
        rows.append(regimes(assumption, kinds))
        watch(number + 1, len(asked))
    partial = partial_reactors(("cap", "motor"), "AQ")
    found = {"goal": str(GOAL), "regimes": rows, "partial": partial}
    write_json(out / "ideal.json", found)
    return found


def questions() -> Iterator[tuple[str, tuple[str, ...]]]:
    """Each assumption, with the kit that it is asked of: AO needs two kinds."""
    for name in ASSUMPTIONS:
        yield name, ("cap", "motor") if name == "AO" else ("cap",)


def regimes(assumption: str, kinds: Sequence[str]) -> dict[str, Any]:
    """(8), (12) about one assumption: the reactor that rests on it, and the one that does not, where it holds and
    where it fails. The second works in both: relaxing is monotone.
    """
    resting, relaxed = planned(kinds), planned(kinds, [assumption])
    holds, fails = environment(kinds)(NOTHING), environment(kinds)(frozenset({assumption}))
    refuted = achieves(resting.text, fails, GOAL)
    return {
        "assumption": assumption,
        "kinds": list(kinds),
        "rests_on_it": assumption in resting.rests_on,
        "resting_where_it_holds": achieves(resting.text, holds, GOAL).holds,
        "resting_where_it_fails": refuted.holds,
        "relaxed_where_it_holds": achieves(relaxed.text, holds, GOAL).holds,
        "relaxed_where_it_fails": achieves(relaxed.text, fails, GOAL).holds,
        "counterexample": _steps(refuted),
    }


def partial_reactors(kinds: Sequence[str], assumption: str) -> dict[str, Any]:
    """(10), (11): the partial reactors from one ideal reactor to the next."""
    partials = chain(kinds, assumption)
    given_up = partials[0].unfinished
    verdicts = partially_ideal(partials, environment(kinds), GOAL, given_up)
    return {
        "assumption": assumption,
        "unfinished": [sorted(partial.unfinished) for partial in partials],
        "achieve": [verdict.holds for verdict in verdicts],
        "converges": converges(partials, given_up),
    }


def _steps(verdict: Verdict) -> list[str]:
    found = verdict.counterexample
    return [] if found is None else [show_label(label) for label in (*found.prefix, *found.cycle)]
