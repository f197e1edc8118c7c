"""Small controls, such as a reactor would plug in."""

from __future__ import annotations

from dataclasses import dataclass, field

from planner_reactor.rs.terms import Value
from planner_reactor.rs.vocabulary import Signature
from planner_reactor.runtime import Body, Outcome, Strand


@dataclass(eq=False)
class Latch:
    """Waits until the test ends or wakes it."""

    name: str = "LATCH"
    resting: bool = False
    announces: bool = False
    opens_body: bool = False
    guards: bool = False
    ready: Outcome | None = None
    started: int = 0
    waiting: list[Strand] = field(default_factory=list)
    cancelled: list[Strand] = field(default_factory=list)

    @property
    def signature(self) -> Signature:
        return Signature(self.name, ("any",), ("k",), optional=1)

    def start(self, strand: Strand, arguments: tuple[Value, ...]) -> Outcome | None:
        self.started += 1
        if self.ready is None:
            self.waiting.append(strand)
        return self.ready

    def cancel(self, strand: Strand) -> None:
        self.cancelled.append(strand)


@dataclass(eq=False)
class Opener(Latch):
    """Delivers a number each time, and keeps account of the bodies that follow."""

    name: str = "OPEN"
    resting: bool = True
    opens_body: bool = True
    most: int = 3
    log: list[tuple[str, object]] = field(default_factory=list)
    causes: list[str] = field(default_factory=list)

    def start(self, strand: Strand, arguments: tuple[Value, ...]) -> Outcome | None:
        if self.started >= self.most:
            self.waiting.append(strand)
            return None
        self.started += 1
        return Outcome(True, (self.started,), context=self.started)

    def opened(self, strand: Strand, body: Body) -> None:
        assert strand.body is body
        self.log.append(("opened", body.context))

    def closed(self, body: Body) -> None:
        assert body.outcome is not None
        self.log.append((body.outcome, body.context))
        self.causes.append(body.strand.cause)


@dataclass(eq=False)
class Guardian(Latch):
    """Labels the other parts of its `#`."""

    name: str = "GUARD"
    resting: bool = True
    guards: bool = True
    set_for: list[tuple[Value, Strand, tuple[Strand, ...]]] = field(default_factory=list)

    def guard_set(self, label: Value, strand: Strand, siblings: tuple[Strand, ...]) -> None:
        self.set_for.append((label, strand, siblings))
