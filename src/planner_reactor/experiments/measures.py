"""The papers' quantities, read off the trace of a run (R §9.2, Figs 12 to 19).

`measure` takes the events of any run, kept in memory or read from JSONL, and nothing else. When things count: the
planner drops an assumption when the last adaptation for it is *issued*, the reactor when its last change is *applied*.
Times are seconds on the run's clock; what never happened is None.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field

import msgspec

from planner_reactor.experiments.improvement import Members, improvement
from planner_reactor.experiments.staircases import Staircase
from planner_reactor.trace import Event

Verdict = Callable[[Event], bool | None]
"""Whether an event says that a product was completed (True) or rejected (False); None: it says neither."""


class Lag(msgspec.Struct, frozen=True):
    """One adaptation that was applied: from issued to applied, and the situations that it changed."""

    adaptation: int
    issued: float
    applied: float
    situations: tuple[str, ...]

    @property
    def seconds(self) -> float:
        return self.applied - self.issued


@dataclass(slots=True)
class Change:
    """One assumption given up (`normal`, `forced`) or taken back (`reinstated`), with the times of all that it took.

    `signalled`: the first signal that led to it (none for a normal one); `silent`: the last signal of the failure.
    """

    assumption: str
    cause: str
    decided: float
    signalled: float | None = None
    silent: float | None = None
    issued: list[float] = field(default_factory=list)
    applied: list[float] = field(default_factory=list)
    changes: int = 0

    @property
    def began(self) -> float:
        """When it became necessary: the signal, or the decision."""
        return self.decided if self.signalled is None else self.signalled

    @property
    def thinking(self) -> float | None:
        """From the decision to the last adaptation issued."""
        return self.issued[-1] - self.decided if self.issued else None

    @property
    def response(self) -> float | None:
        """From the signal (or decision) to the final change in the reactor."""
        return max(self.applied) - self.began if self.applied and len(self.applied) == len(self.issued) else None


class Measures(msgspec.Struct, frozen=True):
    """What there is to say of one run."""

    end: float
    issued: Staircase
    changes: Staircase  # structural changes applied: reactions added or removed
    planner: Members
    reactor: Members
    failures: Staircase
    m: Staircase
    completed: Staircase
    rejected: Staircase
    lags: tuple[Lag, ...]
    relaxed: tuple[Change, ...]
    first_issued: float | None
    first_applied: float | None
    first_action: float | None
    ideal_issued: float | None
    ideal: float | None
    stub_triggers: tuple[float, ...]
    interruptions: int

    def relaxation(self, cause: str, assumption: str | None = None) -> Change | None:
        """The first of this cause (and of this assumption), or None."""
        fitting = (r for r in self.relaxed if r.cause == cause and assumption in (None, r.assumption))
        return next(fitting, None)

    @property
    def stubs_before_ideal(self) -> int:
        """How often an unrefined situation was reached before the first ω-ideal reactor was there."""
        return sum(time <= (self.end if self.ideal is None else self.ideal) for time in self.stub_triggers)


def measure(events: Iterable[Event], *, verdict: Verdict = lambda event: None) -> Measures:
    """Read the papers' quantities off the events of a run."""
    kept = list(events)
    issued = [e for e in kept if e.kind == "adaptation_issued"]
    applied = [e for e in kept if e.kind == "adaptation_applied"]
    lags = _lags(issued, applied)
    planner, reactor, failing = _used_by_planner(kept), _used_by_reactor(kept), _failing(kept)
    ideal = _first(kept, "ideal")
    verdicts = [(e.time, said) for e in kept if (said := verdict(e)) is not None]
    return Measures(
        end=kept[-1].time if kept else 0.0,
        issued=Staircase.counting(e.time for e in issued),
        changes=Staircase.counting(_times(kept, "added", "removed")),
        planner=planner,
        reactor=reactor,
        failures=Staircase.counting(_times(kept, "assumption_failure")),
        m=improvement(planner, reactor, failing),
        completed=Staircase.counting(time for time, good in verdicts if good),
        rejected=Staircase.counting(time for time, good in verdicts if not good),
        lags=lags,
        relaxed=_relaxed(kept, lags),
        first_issued=_first(kept, "adaptation_issued"),
        first_applied=_first(kept, "adaptation_applied"),
        first_action=_first(kept, "entered"),
        ideal_issued=_ideal_issued(issued, ideal),
        ideal=ideal,
        stub_triggers=tuple(_times(kept, "stub_trigger")),
        interruptions=sum(bool(e.data["cut"]) for e in kept if e.kind == "left"),
    )


def _times(events: Sequence[Event], *kinds: str) -> list[float]:
    return [e.time for e in events if e.kind in kinds]


def _first(events: Sequence[Event], kind: str) -> float | None:
    return next((e.time for e in events if e.kind == kind), None)


def _ideal_issued(issued: Sequence[Event], ideal: float | None) -> float | None:
    """When the last adaptation was issued that the first ω-ideal reactor needed."""
    needed = [e.time for e in issued if not e.data["cause"] and ideal is not None and e.time <= ideal]
    return needed[-1] if needed else None


def _lags(issued: Sequence[Event], applied: Sequence[Event]) -> tuple[Lag, ...]:
    when = {e.data["id"]: e.time for e in applied}
    return tuple(
        Lag(e.data["id"], e.time, when[e.data["id"]], (*e.data["situations"], *e.data["removed"]))
        for e in issued
        if e.data["id"] in when
    )


def _used_by_planner(events: Sequence[Event]) -> Members:
    told = (e for e in events if e.kind in ("adaptation_issued", "planner_step"))
    return Members.through((e.time, frozenset(e.data["assumptions"])) for e in told)


def _used_by_reactor(events: Sequence[Event]) -> Members:
    """What its reactions rest on, and what was brought in with them and is watched."""
    applied = (e for e in events if e.kind == "adaptation_applied")
    return Members.through((e.time, frozenset(e.data["assumptions"])) for e in applied)


def _failing(events: Sequence[Event]) -> Members:
    """The assumptions that do not hold, as far as the reactor has been told."""
    false: frozenset[str] = frozenset()
    points = [(0.0, false)]
    for event in events:
        if event.kind == "assumption_failure":
            false |= {event.data["assumption"]}
        elif event.kind == "assumption_holds":
            false -= {event.data["assumption"]}
        else:
            continue
        points.append((event.time, false))
    return Members.through(points)


def _relaxed(events: Sequence[Event], lags: Sequence[Lag]) -> tuple[Change, ...]:
    by_adaptation = {lag.adaptation: lag for lag in lags}
    found: list[Change] = []
    open_for: dict[tuple[str, str], Change] = {}
    signals: dict[tuple[str, str], list[float]] = {}
    for event in events:
        name, cause = str(event.data.get("assumption", "")), str(event.data.get("cause", ""))
        match event.kind:
            case "assumption_failure" | "assumption_holds":
                signals.setdefault((event.kind, name), []).append(event.time)
            case "relaxation":
                found.append(Change(name, cause, event.time))
                open_for[name, cause] = found[-1]
            case "adaptation_issued" if (name, cause) in open_for:
                change = open_for[name, cause]
                change.issued.append(event.time)
                change.changes += len(event.data["kills"]) + len(event.data["adds"])
                if (lag := by_adaptation.get(event.data["id"])) is not None:
                    change.applied.append(lag.applied)
            case _:
                pass
    for change in found:
        _signalled(change, signals, found)
    return tuple(found)


def _signalled(change: Change, signals: dict[tuple[str, str], list[float]], all_of_them: Sequence[Change]) -> None:
    """The first signal since the last time that something was decided about this assumption, and the last signal."""
    kind = {"forced": "assumption_failure", "reinstated": "assumption_holds"}.get(change.cause, "")
    same = [other.decided for other in all_of_them if other.assumption == change.assumption]
    before = max((t for t in same if t < change.decided), default=0.0)
    after = min((t for t in same if t > change.decided), default=float("inf"))
    heard = [t for t in signals.get((kind, change.assumption), ()) if before <= t < after]
    if heard:
        change.signalled, change.silent = heard[0], heard[-1]
