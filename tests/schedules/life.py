"""One life of a planner: schedule after schedule, each of which it has to end in the reactor that is right for it.

A schedule is some random events (assumptions fail and return, stubs are reached, situations fail, answers come, are
refused, time out), with random numbers of the planner's steps between; then quiet, until nothing is left to do.
What has to be true: at every instant what `ledger` asks, and `_asked_of_issued`; in the end `_ended_right`.
"""

from __future__ import annotations

import random
from collections import Counter
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path

from planner_reactor.link.messages import Adaptation, PerceptionKind
from planner_reactor.logic.domain import Domain
from planner_reactor.logic.formulas import Atom
from planner_reactor.planner import Planner
from planner_reactor.planner.relaxing import MOST_DOUBLINGS
from planner_reactor.planner.steps import Relax
from tests.planner.driving import KITTING, image, kitting, perception, planner_without, reinstatable, settle
from tests.schedules.ledger import Ledger, Unsafe, World

EXAMPLES = Path(__file__).parents[2] / "examples"
DOMAINS = {"cafe": EXAMPLES / "09_cafe.itl", "greenhouse": EXAMPLES / "greenhouse.itl", "kitting": KITTING}
MOST_REFUSED = 3
"""So often in a row an adaptation of one situation is not applied: more often, and it would be given up."""


@cache
def domain(name: str, returning: bool) -> Domain:
    """The domain as it is, or with every assumption `reinstatable`."""
    return reinstatable(DOMAINS[name]) if returning else kitting(DOMAINS[name])


@cache
def ideal(
    name: str, returning: bool, relaxed: frozenset[str], told: frozenset[tuple[Atom, bool]] = frozenset()
) -> object:
    """The reactor without these assumptions, planned from scratch; `told` is what is known from perception requests."""
    planner = planner_without(domain(name, returning), sorted(relaxed), verify=False)
    for atom, holds in sorted(told, key=str):
        planner.perceive(perception("information", atom.predicate, *atom.arguments, "holds" if holds else "fails"))
    settle(planner)
    return image(planner)


@dataclass
class Tally:
    """What the schedules came to. `most`: the most adaptations for one change of the assumptions."""

    schedules: int = 0
    issued: int = 0
    changes: int = 0  # assumptions given up or taken back
    flips: int = 0  # of the world
    unapplied: int = 0
    perceived: int = 0
    most: float = 0.0
    reached: Counter[str] = field(default_factory=Counter)

    def add(self, other: Tally) -> None:
        for key in ("schedules", "issued", "changes", "flips", "unapplied", "perceived"):
            setattr(self, key, getattr(self, key) + getattr(other, key))
        self.most = max(self.most, other.most)
        self.reached += other.reached


@dataclass
class Life:
    """A planner, what it has brought about, and the world. `run` does one schedule."""

    name: str
    returning: bool
    relax: Relax = ()
    tally: Tally = field(default_factory=Tally)

    def __post_init__(self) -> None:
        self.domain = domain(self.name, self.returning)
        self.planner = Planner(self.domain, relax=self.relax, verify=False)
        self.ledger = Ledger()
        declared = self.domain.assumptions.values()
        self.world = World(
            self_reported=frozenset(a.name for a in declared if a.monitor != "flag"),
            truth={a.name: True for a in declared},
            unit={a.name: a.period_ms for a in declared},
        )
        self.flight: list[Adaptation] = []
        self.told_false: set[str] = set()
        self.refused: Counter[str] = Counter()
        self.situations = 0

    # ---------------------------------------------------------------------------------------------- a schedule

    def run(self, seed: object) -> None:
        """One schedule; raises Unsafe if something is not as it has to be."""
        draw = random.Random(f"schedule {seed}")
        before = (self.tally.issued, len(self.planner.relaxations), self.tally.unapplied, self.world.flips)
        for _ in range(draw.randrange(2, 8)):
            self._event(draw)
            for _ in range(draw.randrange(3)):
                self._step()
        self._settle(draw)
        self._ended_right()
        self._counted(*before)

    def _event(self, draw: random.Random) -> None:
        self.world.now += 1
        chance = draw.random()
        if chance < 0.45:
            assumption = draw.choice(list(self.world.truth))
            self.world.change(assumption, holds=draw.random() < 0.4)
        elif chance < 0.6 and self.ledger.served:
            kind = draw.choice(("stub_trigger", "situation_failure", "situation_failure"))
            self._tell(kind, draw.choice(list(self.ledger.served)))
        elif chance < 0.65:
            kind = draw.choice(("assumption_unknown", "guard_kill", "error"))
            self._tell(kind, draw.choice(list(self.world.truth)) if kind == "assumption_unknown" else "1")
        elif self.flight:
            self._answer(draw)
        if draw.random() < 0.6:
            self._sense(draw)

    def _sense(self, draw: random.Random | None = None) -> bool:
        """Let the monitors that stand tell what they see; was that news?"""
        news = False
        for name in self.world.failures(self.ledger):
            known = name in self.told_false
            if not known or (draw is not None and draw.random() < 0.2):
                self.ledger.failed.add(name)
                self.told_false.add(name)
                self._tell("assumption_failure", name)
                news |= not known
        for name in self.world.returns():
            if name in self.told_false:
                self.ledger.failed.discard(name)
                self.told_false.discard(name)
                self._tell("assumption_holds", name)
                news = True
        return news

    def _tell(self, kind: PerceptionKind, subject: str, cause: str = "") -> None:
        self.tally.perceived += 1
        self.planner.perceive(perception(kind, subject, cause=cause))

    def _step(self) -> bool:
        step = self.planner.step()
        for adaptation in step.adaptations if step else ():
            self._asked_of_issued(adaptation)
            self.flight.append(adaptation)
            self.tally.issued += 1
        return step is not None

    def _answer(self, draw: random.Random | None) -> None:
        """The reactor answers what it was sent first."""
        adaptation = self.flight.pop(0)
        subject = adaptation.changes[0].situation if adaptation.changes else ""
        if draw is not None and self.refused[subject] < MOST_REFUSED and draw.random() < 0.08:
            self.refused[subject] += 1
            self.tally.unapplied += 1
            kind: PerceptionKind = draw.choice(("adaptation_refused", "adaptation_timed_out"))
            self._tell(kind, str(adaptation.id), "version")
            return
        self.refused[subject] = 0
        self.world.watch(self.ledger.apply(adaptation), self.ledger)
        self._tell("adaptation_applied", str(adaptation.id))

    def _settle(self, draw: random.Random) -> None:
        """Quiet: everything is answered, everything that can be seen is told, nothing is left to do."""
        for _ in range(1000):
            if self._step():
                continue
            if self.flight:
                self._answer(draw)
            elif not self._sense() and not (self.world.skip() and self._sense()):
                return
        raise Unsafe("it does not come to rest")

    # ------------------------------------------------------------------------------------- what has to be true

    def _asked_of_issued(self, adaptation: Adaptation) -> None:
        """One adaptation of a situation at a time, and none that rests on what the planner was told is false."""
        touched = {change.situation for change in adaptation.changes} | set(adaptation.removed)
        for other in self.flight:
            if touched & ({change.situation for change in other.changes} | set(other.removed)):
                raise Unsafe(f"adaptations {other.id} and {adaptation.id} are under way for one situation")
        for change in adaptation.changes:
            if set(change.assumptions) & self.told_false:
                raise Unsafe(f"{change.situation} is to rest on what was told to be false: {change.assumptions}")

    def _ended_right(self) -> None:
        """It is the ω-ideal reactor of the assumptions that survive, and it is all there."""
        planner, ledger, relaxed = self.planner, self.ledger, frozenset(self.planner.relaxed)
        if not planner.ideal or planner.breaches:
            raise Unsafe(f"not ideal: {planner.expectation}, {planner.impossible}, {planner.breaches}")
        by_choice = {name for name, cause in planner.relaxed.items() if cause == "normal"}
        gone = {name for name in self.told_false if not self.domain.assumptions[name].reinstatable}
        here = {name for name in self.told_false if not self.world.truth[name]}
        if relaxed != by_choice | gone | here:
            raise Unsafe(f"without {sorted(relaxed)}, but false are {sorted(here)}, by choice {sorted(by_choice)}")
        if ledger.disabled or {a for names in ledger.rests.values() for a in names if not self.world.truth[a]}:
            raise Unsafe(f"something rests on what is false: {ledger.rests}")
        if image(planner) != ideal(self.name, self.returning, relaxed):
            raise Unsafe(f"not what planning from scratch gives without {sorted(relaxed)}")
        if ledger.texts() != {segment.name: segment.text for segment in planner.model}:
            raise Unsafe("what stands is not what the planner knows")
        flags = {a for a in planner.assumptions_in_use if a not in self.world.self_reported}
        if {name for kind, name in ledger.monitors if kind == "ASSU"} != flags:
            raise Unsafe(f"monitors {sorted(ledger.monitors)} for {sorted(flags)}")

    def _counted(self, issued: int, changes: int, unapplied: int, flips: int) -> None:
        """The bounds of docs/regimes.md, in this schedule and over this life."""
        tally = self.tally
        new, given = tally.issued - issued, len(self.planner.relaxations) - changes
        again = tally.unapplied - unapplied
        self.situations = max(self.situations, len(self.ledger.served))
        begins = not tally.schedules
        if new > (self.situations + 1) * (given + again + begins):
            raise Unsafe(f"{new} adaptations for {given} changes and {again} that were not applied")
        tally.schedules += 1
        tally.changes += given
        tally.flips += self.world.flips - flips
        forced = sum(r.cause != "normal" for r in self.planner.relaxations)
        if forced > tally.flips:
            raise Unsafe(f"{forced} changes of mind, and the world has changed {tally.flips} times")
        tally.most = max(tally.most, new / (given + again + begins)) if new else tally.most
        tally.reached[",".join(sorted(self.planner.relaxed))] += 1
        returned = Counter(r.assumption for r in self.planner.relaxations if r.cause == "reinstated")
        for name, times in returned.items():
            if times > 1 + MOST_DOUBLINGS + self.world.now / 2**MOST_DOUBLINGS:
                raise Unsafe(f"{name} came back {times} times in {self.world.now} periods")
