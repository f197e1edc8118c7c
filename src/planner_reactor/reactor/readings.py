"""From readings to a change of mind: what the sensors say of assumptions, and when that is believed.

Three things can be wrong with a reading. It may be *stale* (taken too long ago) or its sensor *stuck* (its signal never
changes): then it is unknown, which is not false, and that is told as a perception of its own. It may be a *slip*: only
so many of so many readings make a failure. And it may *flap*: what rests on the assumption is disabled at once each
time, but the planner hears of at most one change in a hold-off, and of a return only after a hold-on. So an assumption
that flaps costs at most one change of assumptions in a hold-off, whatever its frequency. How much of this is wanted an
assumption's `Caution` says; the default is none of it.

What was told last may have gone with the reactor's process. So one that begins anew tells both again: that what its
journal says to fail fails, as long as something rests on it, and, once, that what is watched for its return holds.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, field
from math import inf

from planner_reactor.link.messages import PerceptionKind
from planner_reactor.reactor.assumptions import CALM, Assumptions
from planner_reactor.runtime import Host, Scheduler, Timer
from planner_reactor.runtime.sensing import PLAIN, Caution, Reading, Sensed

TIE = 1e-9
REPEAT = 2.0
"""Seconds after which a failure that a process noticed is sent again (R §9.2.3; the monitors' period in R §8.3)."""


@dataclass(slots=True)
class Mind:
    """What is remembered of one assumption's readings. Times are seconds."""

    caution: Caution
    told_failing: bool  # is that what the planner was told last?
    recent: deque[bool] = field(init=False)
    told: float = -inf  # when the planner was told of a change last
    held_since: float | None = None  # since when every reading of a failed one says that it holds
    signal: object = None
    changed: float = -inf  # when the signal was first as it is
    doubt: str = ""  # stale or stuck, as long as it is, or unsensed
    timer: Timer | None = None

    def __post_init__(self) -> None:
        self.recent = deque(maxlen=self.caution.window)

    def vet(self, reading: Reading, now: float) -> str:
        """"" if the reading may be believed, else what is wrong with it."""
        if now - reading.taken > self.caution.stale:
            return "stale"
        if reading.signal is None:
            return ""
        if self.signal is None or reading.signal != self.signal:
            self.signal, self.changed = reading.signal, reading.taken
        return "stuck" if now - self.changed > self.caution.stuck else ""


class Readings:
    """All assumptions' readings. `told(kind, assumption, cause)` hears when a sensor begins to be of no worth."""

    def __init__(
        self,
        scheduler: Scheduler,
        host: Host,
        assumptions: Assumptions,
        told: Callable[[PerceptionKind, str, str], None],
    ) -> None:
        self._scheduler = scheduler
        self._host = host
        self._assumptions = assumptions
        self._told = told
        self._minds: dict[str, Mind] = {}
        self._repeats: dict[str, Timer] = {}
        self._surely_told: set[str] | None = None  # assumptions whose return was told, if it was; None: all of them
        self.doubts = 0  # readings that were stale or stuck
        self.failing: dict[str, int] = {}  # of those that count as holding: readings in a row that say it fails

    def mind(self, assumption: str) -> Mind:
        if (mind := self._minds.get(assumption)) is None:
            caution = self._host.cautions.get(assumption, PLAIN)
            mind = self._minds[assumption] = Mind(caution, assumption in self._assumptions.failed)
        return mind

    def read(self, assumption: str, sensed: Sensed, *, returns: bool, fails: bool = True) -> None:
        """One reading; may it say that a failed one holds again (`returns`), or that it `fails`?"""
        mind = self.mind(assumption)
        if assumption not in self._host.assumptions:
            self._doubt(assumption, mind, "unsensed")
        holds = self._vetted(assumption, mind, sensed) if isinstance(sensed, Reading) else sensed
        if holds is None:
            mind.held_since = None
            return
        mind.recent.append(holds)
        if holds:
            self.failing.pop(assumption, None)
            if returns and assumption in self._assumptions.failed:
                mind.held_since = self._scheduler.now if mind.held_since is None else mind.held_since
                self._holds(assumption, mind)
            elif returns and self._surely_told is not None and assumption not in self._surely_told:
                self._surely_told.add(assumption)
                self._told("assumption_holds", assumption, "")
            return
        mind.held_since = None
        if not fails:
            return
        self.failing[assumption] = self.failing.get(assumption, 0) + 1
        if assumption in self._assumptions.failed or mind.recent.count(False) >= mind.caution.fails:
            self._fails(assumption, mind)

    def disbelieved(self) -> list[str]:
        """The assumptions that were read to fail as often as it takes and count as holding: none (law 14)."""
        return [a for a, times in self.failing.items() if times >= self.mind(a).caution.fails]

    def noticed(self, assumption: str, holds: bool, evidence: str) -> None:
        """A process noticed by itself: a failure is sent again while something rests on it (nobody asks)."""
        known = assumption in self._assumptions.failed
        self.read(assumption, holds, returns=True)
        if not known and assumption in self._assumptions.failed:
            self._repeat_later(assumption)

    def restored(self) -> None:
        """The reactor stands on its journal: who is to hear of assumptions may not have heard what was told last."""
        self._surely_told = set(self._assumptions.failed)
        for assumption in self._assumptions.failed:
            if not assumption.startswith(CALM):  # the planner cannot give that up
                self._repeat_later(assumption)

    def _repeat_later(self, assumption: str) -> None:
        """It is told again and again while it fails and something rests on it, also if that comes to be later."""

        def repeat() -> None:
            if assumption not in self._assumptions.failed:
                return
            if self._assumptions.resting_on(assumption):
                self._fails(assumption, self.mind(assumption))
            self._repeat_later(assumption)

        if (before := self._repeats.get(assumption)) is not None:
            before.cancel()
        self._repeats[assumption] = self._scheduler.call_after(REPEAT, repeat)

    # -- changes of mind

    def _fails(self, assumption: str, mind: Mind) -> None:
        now = self._scheduler.now
        news = not mind.told_failing
        tells = not news or now >= mind.told + mind.caution.hold_off - TIE
        if tells and news:
            mind.told, mind.told_failing = now, True
        self.failing.pop(assumption, None)
        self._assumptions.sensed(assumption, False, tell=tells)
        if not tells:
            self._later(assumption, mind, mind.told + mind.caution.hold_off)

    def _holds(self, assumption: str, mind: Mind) -> None:
        """It has held since `held_since`: is that long enough?"""
        now, caution = self._scheduler.now, mind.caution
        assert mind.held_since is not None
        due = mind.held_since + caution.hold_on
        if mind.told_failing:
            due = max(due, mind.told + caution.hold_off)
        if now < due - TIE:
            self._later(assumption, mind, due)
            return
        tells = mind.told_failing
        if tells:
            mind.told, mind.told_failing = now, False
        mind.held_since = None
        mind.recent.clear()
        self._assumptions.sensed(assumption, True, tell=tells)

    def _later(self, assumption: str, mind: Mind, due: float) -> None:
        """Ask again at this instant, unless that will be done anyway."""
        if mind.timer is None or not mind.timer.active or mind.timer.when > due + TIE:
            if mind.timer is not None:
                mind.timer.cancel()
            mind.timer = self._scheduler.call_at(due, lambda: self._again(assumption, mind))

    def _again(self, assumption: str, mind: Mind) -> None:
        if assumption in self._assumptions.failed:
            if mind.held_since is not None:
                self._holds(assumption, mind)
            elif not mind.told_failing:
                self._fails(assumption, mind)

    def _vetted(self, assumption: str, mind: Mind, reading: Reading) -> bool | None:
        doubt = mind.vet(reading, self._scheduler.now)
        if doubt:
            self.doubts += 1
        self._doubt(assumption, mind, doubt)
        return None if doubt else reading.holds

    def _doubt(self, assumption: str, mind: Mind, doubt: str) -> None:
        if doubt and doubt != mind.doubt:
            self._told("assumption_unknown", assumption, doubt)
        mind.doubt = doubt
