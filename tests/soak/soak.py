"""A busy reactor on a virtual clock, changed again and again, and what it leaves behind: bytes, threads, open files.

Situations succeed, fail, are asserted anew and time out; an assumption fails and holds again; reactions are replaced in
all modes; the journal is a file that is begun anew by snapshots; once ten thousand instances are on at the same time.
Memory is looked at after every so many situations, when all have ended, and a line laid through it.
"""

from __future__ import annotations

import gc
import os
import threading
from collections.abc import Callable, Iterator
from pathlib import Path
from random import Random
from typing import NamedTuple

from planner_reactor.link.messages import Adaptation, Change, Mode
from planner_reactor.reactor.disks import FileDisk
from planner_reactor.reactor.journal import Journal
from planner_reactor.reactor.reactor import Reactor
from planner_reactor.runtime import Aborted, Budgets, Host, Scheduler, Signal, VirtualClock

MODES: tuple[Mode, ...] = ("drain", "versions", "wait")
BETWEEN = 500
"""Situations between two adaptations."""

LIMIT = 60.0
"""Seconds that a deed takes at most."""

FIRST = """
P[0] = Pace :: ASSERT[work]
P[1] = SIT[work]<k> :: (~(Do[0.3] : REASSERT[part] : SUCCEED[work, k]) : FAIL[work, k])
P[2] = HOLDMONITOR[A, 1000]
P[3] = ASSUMONITOR[A, 1000]
"""
PART = "P[{}] = SIT[part]<k> :: (~(Do[0.2] : SUCCEED[part, k]) : FAIL[part, k])"
CROWD = "P[{}] = Delay[0.001] :: ASSERT[crowd]\nP[{}] = SIT[crowd]<k> :: (Do[{:g}] ; SUCCEED[crowd, k])"


class Sample(NamedTuple):
    """After so many situations: bytes, threads, open files."""

    situations: int
    held: int
    threads: int
    files: int


class Soak:
    """One reactor; `situations` counts what was asserted, `most` how many were on at once."""

    def __init__(self, path: Path, *, leaves: bool = False) -> None:
        self.scheduler = Scheduler(VirtualClock(), seed=1)
        self.draw = Random(1)
        self.leaves = leaves  # the defect: something of each situation stays
        self.left: list[bytes] = []
        self.holds, self.resting, self.goes_on = True, False, Signal("goes on")
        self.most = self.applied = 0
        self.reactor = Reactor(
            self.scheduler, host=self._host(), journal=Journal(FileDisk(path)),
            budgets=Budgets(processes=1_000_000),
        )  # fmt: skip
        self.reactor.start()
        self._id = 0
        changes = tuple(Change(situation=s, base=0, fresh=True) for s in ("work", "part"))
        self._send(FIRST + PART.format(4), changes, adds=(1, 2, 3, 4, 0))
        self.run(0.01)

    @property
    def situations(self) -> int:
        return self.reactor.situations.asserted

    def _host(self) -> Host:
        host = Host("soak")

        @host.process(window=(0.0, LIMIT))
        def Do(seconds: float) -> Iterator[float]:
            yield seconds
            if self.leaves:
                self.left.append(bytes(100))
            if self.draw.random() < 0.05:
                raise Aborted("it did not work")

        @host.process(window=(0.0, 2 * LIMIT))
        def Pace() -> Iterator[float | Signal]:
            yield 0.05
            if self.resting:
                yield self.goes_on

        host.assumption("A")(lambda: self.holds)
        return host

    def _send(
        self, text: str, changes: tuple[Change, ...], *, adds: tuple[int, ...], kills: tuple[int, ...] = (),
        removed: tuple[str, ...] = (), mode: Mode = "drain",
    ) -> None:  # fmt: skip
        self._id += 1
        asked = Adaptation(
            id=self._id, definitions=text, changes=changes, kills=kills, adds=adds, removed=removed, mode=mode
        )
        self.reactor.receive(asked)

    # -- what goes on

    def live(self, situations: int) -> None:
        """So many situations more; an adaptation now and then, each in another mode."""
        until = self.situations + situations
        due = self.situations
        while self.situations < until and self.reactor.reactions.get(0):
            if self.situations >= due:
                due += BETWEEN
                self._change()
                self.holds = not self.holds if self.draw.random() < 0.3 else True
            self.run(1.0)

    def run(self, seconds: float) -> None:
        self.reactor.executer.run(until=self.scheduler.now + seconds)
        for perception in self.reactor.perceptions.take():
            self.applied += perception.kind == "adaptation_applied"
        self.most = max(self.most, len(self.reactor.situations.instances))

    def _change(self) -> None:
        """The reaction of `part` is replaced; one time in two the new one rests on A."""
        (old,) = (n for n, r in self.reactor.reactions.items() if r.situation == "part")
        new = self.reactor.journal.state.committed.highest_label + 1
        rests = ("A",) if self.draw.random() < 0.5 else ()
        change = Change(situation="part", base=self.reactor.versions["part"], assumptions=rests)
        self._send(PART.format(new), (change,), adds=(new,), kills=(old,), mode=self.draw.choice(MODES))

    def crowd(self, size: int) -> None:
        """So many instances at once, and then none of them."""
        root = self.reactor.journal.state.committed.highest_label + 1
        change = Change(situation="crowd", base=self.reactor.versions.get("crowd", 0), fresh=True)
        self._send(CROWD.format(root, root + 1, size / 800), (change,), adds=(root + 1, root))
        self.run(size / 800 + 1.0)
        self._send("", (), adds=(), kills=(root, root + 1), removed=("crowd",))
        self.run(size / 800 + 30.0)

    def sample(self, held: Callable[[], int]) -> Sample:
        """What is held while nothing is on and nothing under way: the same each time, but for what stays behind."""
        self.holds = self.resting = True
        self.run(LIMIT + 10.0)  # what was scheduled and is not awaited any more has come due
        assert not self.reactor.situations.instances
        gc.collect()
        found = Sample(self.situations, held(), threading.active_count(), open_files())
        self.resting = False
        self.goes_on.fire()
        return found


def open_files() -> int:
    """How many files this process has open; 0 where nobody can tell."""
    places = [Path(p) for p in ("/proc/self/fd", "/dev/fd") if Path(p).is_dir()]
    return len(os.listdir(places[0])) if places else 0


def resident() -> int:
    """Bytes of memory that this process has, as the system counts."""
    with open("/proc/self/statm") as statm:
        return int(statm.read().split()[1]) * os.sysconf("SC_PAGE_SIZE")


def slope(samples: list[Sample]) -> float:
    """Bytes a situation: the line through the samples with the least squares."""
    n = len(samples)
    x = sum(s.situations for s in samples) / n
    y = sum(s.held for s in samples) / n
    return sum((s.situations - x) * (s.held - y) for s in samples) / sum((s.situations - x) ** 2 for s in samples)
