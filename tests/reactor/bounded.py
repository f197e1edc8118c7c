"""Small random reactors that are adapted at random moments: how long did it take, how long may it take?"""

from __future__ import annotations

import random
from collections.abc import Iterator, Mapping

import msgspec

from planner_reactor.link.channels import PerceptionChannel
from planner_reactor.link.messages import Adaptation, Change
from planner_reactor.reactor.reactor import Reactor
from planner_reactor.reactor.structure import MARGIN
from planner_reactor.runtime import Aborted, Host, Scheduler, VirtualClock
from planner_reactor.trace import Trace

WORK = {"Quick": 1.0, "Slow": 4.0, "Long": 10.0}


class Observed(msgspec.Struct, frozen=True):
    """One adaptation: what was computed, what it took (seconds), None if it was not applied."""

    bound: float
    took: float | None
    violations: tuple[str, ...]


def host(scheduler: Scheduler, share: float | None) -> Host:
    """Processes that take a share of their windows (None: a random one) and fail now and then."""
    made = Host("random")
    draw = scheduler.random("work")
    for name, longest in WORK.items():

        def work(longest: float = longest) -> Iterator[float]:
            yield longest * (draw.random() if share is None else share)
            if share is None and draw.random() < 0.25:
                raise Aborted("as it happens")

        made.process(window=(0.0, longest), name=name)(work)
    return made


class Texts:
    """A random hierarchy of up to four situations, each served once or twice."""

    def __init__(self, seed: int) -> None:
        self.draw = random.Random(seed)
        self.names = [f"s{n}" for n in range(self.draw.randint(1, 4))]

    def body(self, at: int, depth: int = 2) -> str:
        draw, below = self.draw, self.names[at + 1 :]
        if depth == 0 or draw.random() < 0.3:
            if below and draw.random() < 0.55:
                return f"{draw.choice(['REASSERT', 'REASSERT', 'ASSERT'])}[{draw.choice(below)}]"
            return draw.choice([*WORK, f"Delay[{draw.randint(0, 6)}]"])
        parts = [self.body(at, depth - 1) for _ in range(draw.randint(2, 3))]
        kind = draw.choice([" : ", " : ", " ; ", " & ", " | ", " # ", "if", "~"])
        if kind == "if":
            return f"(if {parts[0]} then {parts[1]} else {parts[-1]})"
        return f"(~{parts[0]})" if kind == "~" else f"({kind.join(parts)})"

    def reaction(self, label: int, at: int) -> str:
        name, loop = self.names[at], self.draw.choice([":;", ":;", "::"])
        body = f"Delay[0.5] : {self.body(at)} : SUCCEED[{name}, k]"
        return f"P[{label}] = SIT[{name}]<k> {loop} (~({body}) : FAIL[{name}, k])"

    def first(self) -> Adaptation:
        """Every situation, and two roots that ask for the first and for another."""
        asked = [self.names[0], self.draw.choice(self.names)]
        lines = [f"P[{n}] = Delay[{self.draw.randint(1, 3)}] :; ASSERT[{s}]" for n, s in enumerate(asked)]
        lines += [self.reaction(10 + n, n) for n in range(len(self.names))]
        adds = (*(10 + n for n in reversed(range(len(self.names)))), 0, 1)
        changes = tuple(Change(situation=s, base=0, fresh=True) for s in self.names)
        return Adaptation(id=1, definitions="\n".join(lines), changes=changes, adds=adds)

    def next(self, number: int, labels: dict[str, int], versions: Mapping[str, int]) -> Adaptation:
        """Some of the situations anew; `labels` are those of the reactions that serve them, and are brought up to date.
        """
        chosen = sorted(self.draw.sample(range(len(self.names)), self.draw.randint(1, len(self.names))))
        names = [self.names[n] for n in chosen]
        kills = tuple(labels[name] for name in names)
        fresh = [10 * number + n for n in chosen]
        labels |= dict(zip(names, fresh, strict=True))
        return Adaptation(
            id=number,
            definitions="\n".join(self.reaction(label, n) for label, n in zip(fresh, chosen, strict=True)),
            changes=tuple(Change(situation=name, base=versions[name]) for name in names),
            kills=kills,
            adds=tuple(reversed(fresh)),
        )


class Adapted:
    """A reactor that is adapted now and then."""

    def __init__(self, first: Adaptation, *, seed: int, share: float | None = None) -> None:
        scheduler = Scheduler(VirtualClock(), seed=seed)
        self.trace = Trace(lambda: scheduler.now)
        self.reactor = Reactor(
            scheduler, host=host(scheduler, share), perceptions=PerceptionChannel(), trace=self.trace
        )
        self.reactor.start()
        self.reactor.receive(first)
        self.trace.sinks.append(lambda e: scheduler.stop() if e.kind == "adaptation_applied" else None)

    def run(self, seconds: float) -> None:
        self.reactor.executer.run(until=self.reactor.scheduler.now + seconds)

    def adapt(self, adaptation: Adaptation) -> Observed:
        """Adapt it now, and run until that is done, or should have been."""
        began, bound = self.reactor.scheduler.now, self.reactor.bound(adaptation) - MARGIN
        self.reactor.receive(adaptation)
        self.run(bound + MARGIN + 1)
        done = [e.time - began for e in self.trace.of("adaptation_applied") if e.data["id"] == adaptation.id]
        return Observed(bound, done[0] if done else None, tuple(map(str, self.reactor.laws.violations)))


def random_adaptations(seed: int, many: int) -> Iterator[Observed]:
    """So many adaptations of a random reactor, each at a random moment."""
    texts = Texts(seed)
    adapted = Adapted(texts.first(), seed=seed)
    labels = {name: 10 + n for n, name in enumerate(texts.names)}
    for number in range(2, many + 2):
        adapted.run(0.0)
        adapted.run(texts.draw.uniform(0, 20))
        yield adapted.adapt(texts.next(number, labels, adapted.reactor.versions))
