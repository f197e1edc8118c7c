"""A reactor of many segments, each of which waits for its own event, and is swapped while it runs.

A root waits for each event of its sensor and asserts a situation; the segment is what serves it, and what serves the
situation below. The world counts: every event has to lead to its action, whatever was swapped meanwhile; no root may
begin again but for the next event.

`check` asks after each swap whether that is so, of what has moved since; `counts` asks it of all that there is.
"""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Callable, Generator
from dataclasses import dataclass, field
from typing import Any

from planner_reactor.link.channels import PerceptionChannel
from planner_reactor.link.messages import Adaptation, Change, Perception
from planner_reactor.reactor.reactor import Reactor
from planner_reactor.runtime import Host, Scheduler, Signal
from planner_reactor.runtime.clock import Clock


@dataclass(slots=True)
class Segment:
    """What the world knows of one segment, and what it is made of."""

    index: int
    top: int = 0  # the label of its root
    labels: tuple[int, int] = (0, 0)  # of what serves its situation, and of what serves the one below
    version: int = 0
    events: int = 0  # that have happened
    taken: int = 0  # of these, by a root
    unanswered: set[int] = field(default_factory=set)  # events that have led to no action yet
    actions: int = 0
    begun: int = 0  # how often its root began to wait
    swaps: int = 0
    signal: Signal = field(default_factory=Signal)


class Told(PerceptionChannel):
    """Perceptions, and how long it takes until one says that an adaptation is in effect."""

    def __init__(self) -> None:
        super().__init__()
        self.asked: dict[str, float] = {}  # when, by id: seconds of processor time
        self.took: Callable[[float], object] = lambda seconds: None

    def report(self, kind: Any, subject: str, **told: Any) -> Perception:
        if kind == "adaptation_applied" and (asked := self.asked.pop(subject, None)) is not None:
            self.took(time.thread_time() - asked)
        return super().report(kind, subject, **told)


class SwapCell:
    """So many segments in one reactor; `swap` issues an adaptation that replaces one."""

    def __init__(self, count: int, clock: Clock) -> None:
        self.scheduler = Scheduler(clock, seed=1)
        self.segments = [Segment(n) for n in range(count)]
        self.told = Told()
        self.reactor = Reactor(self.scheduler, host=self._host(), perceptions=self.told)
        self.reactor.start()
        self._label = self.number = 0
        self.inside = 0  # swaps that a reaction asked for
        self.prepared_inside: Callable[[float], object] = lambda seconds: None
        self.unanswered = 0  # events
        self.checks = 0
        self.found: Counter[str] = Counter()  # what was not as it should be, after a swap
        self._begun: list[Segment] = []  # whose roots have begun since the last check
        self.perceived = 0
        self.lost = 0  # perceptions that are missing among the numbers
        self.outcomes: dict[str, int] = {}
        for segment in self.segments:
            self.reactor.receive(self.adaptation(segment))
            self.scheduler.run(self.scheduler.now)
        self.take()
        self._live = self.reactor.executer.processes_live

    def _host(self) -> Host:
        host = Host("swaps")

        @host.process(limit=1e9, results=("n",))
        def Event(index: float) -> Generator[Signal, None, int]:
            segment = self.segments[int(index)]
            segment.begun += 1
            self._begun.append(segment)
            while segment.taken == segment.events:
                yield segment.signal
            segment.taken += 1
            return segment.taken

        @host.process(window=(0, 0))
        def Act(index: float, event: float) -> None:
            segment = self.segments[int(index)]
            segment.actions += 1
            if int(event) in segment.unanswered:
                segment.unanswered.remove(int(event))
                self.unanswered -= 1

        @host.process(window=(0, 0))
        def Swap(index: float) -> None:
            """From inside a reaction: the segment in service swaps another, and every third time itself."""
            segment = self.segments[int(index)]
            self.inside += 1
            other = (segment.index * 7 + segment.actions) % len(self.segments)
            self.swap(segment if segment.actions % 3 == 0 else self.segments[other])

        return host

    def happen(self, segment: Segment) -> None:
        """An event of the world."""
        segment.events += 1
        segment.unanswered.add(segment.events)
        self.unanswered += 1
        segment.signal.fire()

    def adaptation(self, segment: Segment, *, swapping: bool = False) -> Adaptation:
        """The adaptation that replaces the segment as it stands; `swapping`: the new one swaps others when it acts."""
        top, below, i = self._label + 1, self._label + 2, segment.index
        self._label += 2
        self.number += 1
        fresh = segment.version == 0
        act = f"Act[{i}, n]" + (f" : Swap[{i}]" if swapping else "")
        lines = [
            f"P[{top}] = SIT[s{i}]<k, n> :; (~(REASSERT[t{i}, n] : SUCCEED[s{i}, k]) : FAIL[s{i}, k])",
            f"P[{below}] = SIT[t{i}]<k, n> :; (~({act} : SUCCEED[t{i}, k]) : FAIL[t{i}, k])",
        ]
        adds: tuple[int, ...] = (below, top)
        if fresh:
            self._label += 1
            lines.append(f"P[{self._label}] = Event[{i}]<n> :; REASSERT[s{i}, n]")
            adds = (below, top, self._label)
            segment.top = self._label
        adaptation = Adaptation(
            id=self.number,
            definitions="\n".join(lines),
            changes=tuple(Change(situation=s, base=segment.version, fresh=fresh) for s in (f"s{i}", f"t{i}")),
            kills=() if fresh else segment.labels,
            adds=adds,
            deadline=60.0,  # on the wall clock the machine may be held up
        )
        segment.labels = (top, below)
        segment.version += 1
        segment.swaps += not fresh
        return adaptation

    def swap(self, segment: Segment, *, swapping: bool = False) -> None:
        if f"s{segment.index}" not in self.reactor.transactions.pending_situations:
            adaptation = self.adaptation(segment, swapping=swapping)
            began = time.thread_time()
            prepared = self.reactor.prepare(adaptation)
            self.told.asked[str(adaptation.id)] = ready = time.thread_time()
            self.prepared_inside(ready - began)
            self.reactor.receive(prepared)

    def take(self) -> None:
        """Read the perceptions, as a planner does."""
        for perception in self.reactor.perceptions.take():
            self.perceived += 1
            self.lost += perception.number - self.perceived
            self.perceived = perception.number
            self.outcomes[perception.kind] = self.outcomes.get(perception.kind, 0) + 1

    @property
    def quiet(self) -> bool:
        """Is nothing under way?"""
        reactor = self.reactor
        return not (reactor.transactions.under_way or reactor.situations.instances or self.unanswered)

    def check(self, swapped: Segment) -> None:
        """After a swap, when nothing is under way: of all that has moved, and of what there is by its number."""
        self.checks += 1
        self.take()
        begun, self._begun = self._begun, []
        self._note("bystanders restarted", sum(abs(s.begun - 1 - s.taken) for s in begun))
        self._note("events lost", self.unanswered)
        for name, wrong in self._by_number().items():
            if wrong:
                self._note(name, wrong)
        reactions = self.reactor.reactions
        if not (swapped.labels[0] in reactions and swapped.labels[1] in reactions):
            self._note("swaps that were not applied", 1)

    def _note(self, name: str, wrong: int) -> None:
        if wrong:
            self.found[name] = max(self.found[name], abs(wrong))

    def _by_number(self) -> dict[str, int]:
        each, reactor = len(self.segments), self.reactor
        stands = reactor.executer.statistics()
        return {
            "swaps that were not applied": self.number - self.outcomes.get("adaptation_applied", 0),
            "perceptions lost": self.lost,
            "reactions left over": len(reactor.reactions) - 3 * each,
            "processes left over": stands.processes_live - self._live,
            "basic processes left over": stands.basic_running - each,
            "instances left over": len(reactor.situations.instances),
            "violations": len(reactor.laws.violations),
        }

    def counts(self) -> dict[str, int]:
        """What should be: 0 everywhere. To be asked when nothing is under way: looks at every segment."""
        self.take()
        reactions = self.reactor.reactions
        now = {
            **self._by_number(),
            "bystanders restarted": sum(abs(s.begun - 1 - s.taken) for s in self.segments),
            "events lost": sum(len(s.unanswered) for s in self.segments),
            "segments gone": sum(s.top not in reactions or not reactions.keys() >= {*s.labels} for s in self.segments),
        }
        for name, wrong in now.items():
            self._note(name, wrong)
        return {name: self.found[name] for name in now}
