"""The reactor and its world as far as assumptions go: what stands, what rests on what, what monitors would tell.

`Ledger` takes adaptations as the reactor does (R §5.5), all at once, and says where it would be unsafe to. `World` says
which assumptions hold, and lets the monitors that stand tell it, on a clock of ticks. Bodies of reactions do not run
here: that a swap waits for them is modelled by answers that come late. Texts are read once each.
"""

from __future__ import annotations

import re
from collections import Counter
from dataclasses import dataclass, field
from functools import cache

import msgspec

from planner_reactor.link.messages import Adaptation

_CLAUSE = re.compile(r"^P\[(\d+)\] = (.*)$", re.MULTILINE)
_SERVES = re.compile(r"^SIT\[(\w+)")
_ASSERTS = re.compile(r"ASSERT\[(\w+)")
_MONITOR = re.compile(r"^(ASSU|HOLD)MONITOR\[\"?([\w(),]+?)\"?, (\d+)\]$")


class Read(msgspec.Struct, frozen=True):
    """A reaction's text, read: what it serves (or ""), what it asserts, which monitor it is (kind, assumption, ms)."""

    serves: str
    asserts: tuple[str, ...]
    monitor: tuple[str, str, int] | None


@cache
def read(text: str) -> Read:
    serves, monitor = _SERVES.match(text), _MONITOR.match(text)
    return Read(
        serves[1] if serves else "",
        tuple(_ASSERTS.findall(text)),
        (monitor[1], monitor[2], int(monitor[3])) if monitor else None,
    )


class Unsafe(AssertionError):
    """A state that no reactor may be in, or that no planner may bring about."""


@dataclass
class Ledger:
    """What stands: reactions by label; what each situation rests on; which assumptions count as failed."""

    reactions: dict[int, str] = field(default_factory=dict)
    rests: dict[str, frozenset[str]] = field(default_factory=dict)
    failed: set[str] = field(default_factory=set)
    versions: Counter[str] = field(default_factory=Counter)
    served: dict[str, int] = field(default_factory=dict)
    asserted: Counter[str] = field(default_factory=Counter)
    monitors: dict[tuple[str, str], int] = field(default_factory=dict)  # (kind, assumption): label
    highest: int = -1

    def apply(self, adaptation: Adaptation) -> dict[tuple[str, str], int]:
        """Change what stands; the monitors that are new, with their periods in ms."""
        for change in adaptation.changes:
            if self.versions[change.situation] != change.base or change.fresh != (change.situation not in self.served):
                raise Unsafe(f"adaptation {adaptation.id} was planned against another {change.situation}")
        for label in adaptation.kills:
            self._kill(label)
        new = dict(found for label, text in _CLAUSE.findall(adaptation.definitions) for found in self._add(label, text))
        for change in adaptation.changes:
            self.versions[change.situation] += 1
            self.rests[change.situation] = frozenset(change.assumptions)
        for situation in adaptation.removed:
            self.versions[situation] += 1
            self.rests.pop(situation, None)
        self.check()
        return new

    def _kill(self, label: int) -> None:
        if label not in self.reactions:
            raise Unsafe(f"reaction {label} is removed, and does not stand")
        gone = read(self.reactions.pop(label))
        self.asserted -= Counter(gone.asserts)
        if gone.serves and self.served.get(gone.serves) == label:
            del self.served[gone.serves]
        if gone.monitor:
            del self.monitors[gone.monitor[:2]]

    def _add(self, number: str, text: str) -> list[tuple[tuple[str, str], int]]:
        label, new = int(number), read(text)
        if label <= self.highest:
            raise Unsafe(f"label {label} was used before")
        self.highest, self.reactions[label] = label, text
        self.asserted += Counter(new.asserts)
        if new.serves:
            if new.serves in self.served:
                raise Unsafe(f"{new.serves} is served by {self.served[new.serves]} and by {label}")
            self.served[new.serves] = label
        if new.monitor is None:
            return []
        if new.monitor[:2] in self.monitors:
            raise Unsafe(f"{new.monitor} stands twice")
        self.monitors[new.monitor[:2]] = label
        return [(new.monitor[:2], new.monitor[2])]

    def check(self) -> None:
        """Everything that is asserted is served, and the other way round; what is served says what it rests on."""
        if self.asserted.keys() != self.served.keys():
            raise Unsafe(f"asserted: {sorted(self.asserted)}, served: {sorted(self.served)}")
        if self.rests.keys() != self.served.keys():
            raise Unsafe(f"it is not said what {sorted(self.served.keys() ^ self.rests.keys())} rests on")

    def resting_on(self, assumption: str) -> bool:
        return any(assumption in names for names in self.rests.values())

    @property
    def disabled(self) -> list[str]:
        """The situations that are not served, since they rest on what has failed."""
        return [situation for situation, names in self.rests.items() if names & self.failed]

    def texts(self) -> dict[str, str]:
        return {situation: self.reactions[label] for situation, label in self.served.items()}


@dataclass
class World:
    """Which assumptions hold, and who is there to tell. Times are ticks; a period is `ms // unit` ticks."""

    self_reported: frozenset[str]
    truth: dict[str, bool]
    unit: dict[str, int]  # ms of a tick, by assumption
    now: int = 0
    flips: int = 0  # how often it has changed
    due: dict[str, tuple[int, int]] = field(default_factory=dict)  # HOLDMONITORs: when they read, how long they wait

    def change(self, assumption: str, holds: bool) -> None:
        self.flips += self.truth[assumption] != holds
        self.truth[assumption] = holds

    def watch(self, new: dict[tuple[str, str], int], ledger: Ledger) -> None:
        """These monitors begin; those of returns read after their period."""
        self.due = {name: times for name, times in self.due.items() if ("HOLD", name) in ledger.monitors}
        for (kind, name), period in new.items():
            if kind == "HOLD":
                wait = period // self.unit[name]
                self.due[name] = (self.now + wait, wait)

    def failures(self, ledger: Ledger) -> list[str]:
        """The assumptions of which somebody who stands there sees that they are false."""
        return [
            name
            for name, holds in self.truth.items()
            if not holds
            and (("ASSU", name) in ledger.monitors or (name in self.self_reported and ledger.resting_on(name)))
        ]

    def returns(self) -> list[str]:
        """The assumptions that a HOLDMONITOR reads now, and that hold."""
        found = []
        for name, (when, wait) in self.due.items():
            if when <= self.now:
                self.due[name] = (self.now + wait, wait)
                if self.truth[name]:
                    found.append(name)
        return found

    def skip(self) -> bool:
        """Let time pass to the next reading of something that has returned; False if there is none."""
        times = [when for name, (when, _) in self.due.items() if self.truth[name]]
        if times:
            self.now = max(self.now, min(times))
        return bool(times)
