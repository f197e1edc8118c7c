"""Drives a planner against a stand-in for the reactor, which keeps the book that the real one keeps.

`Book` takes adaptations as the reactor does (R §5.5) and fails a test where the reactor would refuse: a
stale base, a label that is not there or was used, a situation that is asserted and that nothing serves,
text that does not load.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import planner_reactor.workcell
from planner_reactor.link.messages import Adaptation, Perception, PerceptionKind
from planner_reactor.logic.domain import Domain
from planner_reactor.logic.reader import read_domain
from planner_reactor.planner import Planner
from planner_reactor.rs.loading import load
from planner_reactor.rs.parser import parse_program
from planner_reactor.rs.vocabulary import BUILT_IN, Kind, Signature

WORKCELL = Path(planner_reactor.workcell.__file__).parent
KITTING = WORKCELL / "kitting.itl"
PAPERS = WORKCELL / "papers.itl"
TRIED = Path(__file__).parent.parent / "logic" / "notation.itl"
GREENHOUSE = Path(__file__).parent.parent.parent / "examples" / "greenhouse.itl"
TENDING = GREENHOUSE.with_name("tending.itl")

_CLAUSE = re.compile(r"^P\[(\d+)\] = (.*)$", re.MULTILINE)
_SERVES = re.compile(r"^SIT\[(\w+)")
_ASSERTS = re.compile(r"ASSERT\[(\w+)")


def signatures(domain: Domain) -> dict[str, Signature]:
    """What a host for the domain would declare."""
    found = dict(BUILT_IN)
    anything: Kind = "any"
    for schema in domain.schemas.values():
        if not schema.abstract:
            results = tuple(schema.variables[v] for v in schema.outputs)
            found[schema.name] = Signature(schema.name, (anything,) * len(schema.inputs), results)
    return found


@dataclass
class Book:
    """The reactor as far as its structure goes. With `loads` every text is parsed and checked as it
    would be.
    """

    domain: Domain
    loads: bool = True
    reactions: dict[int, str] = field(default_factory=dict)
    versions: dict[str, int] = field(default_factory=dict)
    highest: int = -1

    def apply(self, adaptation: Adaptation) -> None:
        new = {int(match[1]): match[2] for match in _CLAUSE.finditer(adaptation.definitions)}
        assert sorted(new) == sorted(adaptation.adds)
        assert all(label > self.highest for label in new)
        for change in adaptation.changes:
            assert self.versions.get(change.situation, 0) == change.base, change
            assert change.fresh == (change.situation not in self.served())
        for label in adaptation.kills:
            del self.reactions[label]
        if self.loads:
            standing = "".join(f"P[{label}] = {text}\n" for label, text in self.reactions.items())
            load(adaptation.definitions, signatures=signatures(self.domain), given=parse_program(standing))
        self.reactions |= new
        self.highest = max([self.highest, *new])
        for name in (*(c.situation for c in adaptation.changes), *adaptation.removed):
            self.versions[name] = self.versions.get(name, 0) + 1
        self._hangs_together(adaptation)

    def _hangs_together(self, adaptation: Adaptation) -> None:
        served = self.served()
        for text in self.reactions.values():
            for name in _ASSERTS.findall(text):
                assert name in served, f"{name} is asserted by {text}"
        assert not served & set(adaptation.removed)

    def served(self) -> set[str]:
        return {match[1] for text in self.reactions.values() if (match := _SERVES.match(text))}

    def monitors(self, kind: str) -> set[str]:
        found = (re.match(rf"{kind}\[\"?([\w(),]+?)\"?, ", text) for text in self.reactions.values())
        return {match[1] for match in found if match}


def perception(kind: PerceptionKind, subject: str, *values: object, cause: str = "") -> Perception:
    return Perception(number=1, time=0.0, kind=kind, subject=subject, cause=cause, values=values)


def applied(adaptation: Adaptation) -> Perception:
    return perception("adaptation_applied", str(adaptation.id))


def settle(planner: Planner, book: Book | None = None, *, most: int = 2000) -> list[Adaptation]:
    """Step until there is nothing to do; every adaptation is applied at once."""
    book = book or Book(planner.domain)
    issued: list[Adaptation] = []
    for _ in range(most):
        step = planner.step()
        if step is None:
            return issued
        for adaptation in step.adaptations:
            issued.append(adaptation)
            book.apply(adaptation)
            planner.perceive(applied(adaptation))
    raise AssertionError(f"not settled after {most} steps")


def first_adaptations(planner: Planner, count: int) -> list[Adaptation]:
    """The first `count` adaptations, each applied at once."""
    issued: list[Adaptation] = []
    while len(issued) < count:
        step = planner.step()
        assert step is not None
        issued.extend(step.adaptations)
        for adaptation in step.adaptations:
            planner.perceive(applied(adaptation))
    return issued


def planner_without(domain: Domain, names: Iterable[str], **options: Any) -> Planner:
    """A planner to which these assumptions have failed before it began, and which relaxes no other by
    itself.
    """
    planner = Planner(domain, **{"relax": (), **options})
    for name in names:
        planner.perceive(perception("assumption_failure", name))
    return planner


def texts(planner: Planner) -> dict[str, str]:
    """Situation → its reaction as text."""
    return {s.name: s.text for s in planner.model if s.text}


def image(planner: Planner) -> dict[str, tuple[str, frozenset[str], frozenset[str]]]:
    """Everything about the segments that incremental and fresh planning must agree on."""
    return {s.name: (s.text, s.required, s.in_use) for s in planner.model}


def kitting(path: Path = KITTING) -> Domain:
    return read_domain(path)


def reinstatable(path: Path) -> Domain:
    """The domain with every assumption declared to be reinstatable."""
    text = re.sub(r"(atp_assumption [^;]*?)( reinstatable)?;", r"\1 reinstatable;", path.read_text())
    return read_domain(text)
