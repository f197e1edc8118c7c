"""The papers' figures beside ours: one row for each thing that they print of their run (R §9.2).

Two runs are compared with theirs: one on the papers' clock (their planner's durations, in a world that is as slow as
theirs must have been) and one on our own. Nothing here runs or prints anything.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise

import msgspec

from planner_reactor.experiments.measures import Change, Measures

APART = 15.0
"""Seconds: what lies closer together is one set-back."""


class Row(msgspec.Struct, frozen=True):
    """One line of the table."""

    what: str
    paper: str
    on_their_clock: str
    on_ours: str


Reading = Callable[[Measures], str]


def compare(theirs: Measures, ours: Measures) -> list[Row]:
    """The rows: `theirs` was measured on the papers' clock, `ours` on our own."""
    return [Row(what, paper, read(theirs), read(ours)) for what, paper, read in _ROWS]


def setbacks(m: Measures) -> tuple[float, ...]:
    """When the papers' measure M fell, so that 1/M rose (seconds); close ones count as one."""
    points = list(zip(m.m.times, m.m.values, strict=True))
    falls = [time for (_, before), (time, after) in pairwise(points) if after < before]
    return tuple(t for n, t in enumerate(falls) if n == 0 or t - falls[n - 1] > APART)


def seconds(value: float | None) -> str:
    """A time or duration, in the unit that suits it."""
    if value is None:
        return "–"
    if abs(value) < 0.9995:
        return f"{1000 * value:.0f} ms"
    return f"{value:.1f} s"


def _forced(name: str, read: Callable[[Change], str]) -> Reading:
    return lambda m: "–" if (change := m.relaxation("forced", name)) is None else read(change)


def _normal(name: str) -> Reading:
    return lambda m: "–" if (change := m.relaxation("normal", name)) is None else seconds(change.thinking)


def _after(change: Change, times: Sequence[float], place: int) -> str:
    return seconds(times[place] - change.began) if times else "–"


def _follows(m: Measures) -> str:
    done = [max(r.applied) for r in m.relaxed if r.cause == "normal" and r.applied]
    return ", ".join(map(seconds, done)) or "–"


def _lag(change: Change) -> str:
    """The median lag of its changes behind its adaptations."""
    lags = sorted(a - i for i, a in zip(change.issued, change.applied, strict=False))
    return seconds(lags[len(lags) // 2]) if lags else "–"


def _first_lag(m: Measures) -> str:
    return seconds(m.lags[0].seconds) if m.lags else "–"


def _used(m: Measures, time: float | None) -> str:
    return "–" if time is None else f"{m.reactor.count.at(time):.0f}"


def _back(m: Measures) -> str:
    change = m.relaxation("reinstated")
    return "–" if change is None else seconds(change.began)


def _back_after(m: Measures) -> str:
    change = m.relaxation("reinstated")
    return "–" if change is None else seconds(change.response)


def _made(m: Measures) -> str:
    return f"{len(m.completed.times)}, {len(m.rejected.times)}"


_ROWS: tuple[tuple[str, str, Reading], ...] = (
    ("first adaptation issued", "26 s", lambda m: seconds(m.first_issued)),
    ("  applied after", "2 s", _first_lag),
    ("  assumptions that it uses", "6", lambda m: _used(m, m.first_applied)),
    ("the robot begins to act", "with it", lambda m: seconds(m.first_action)),
    ("first ideal reactor: issued", "42 s (or 38 s)", lambda m: seconds(m.ideal_issued)),
    ("  in place", "40 s", lambda m: seconds(m.ideal)),
    ("  assumptions that it uses", "9", lambda m: _used(m, m.ideal)),
    ("  stubs reached before that", "0", lambda m: str(m.stubs_before_ideal)),
    ("AQ relaxed: planning takes", "6 s (T: 5 s)", _normal("AQ")),
    ("AS relaxed: planning takes", "30 s", _normal("AS")),
    ("  the reactor has followed", "103 s, 104 s", _follows),
    ("AM fails: first signal", "152 s", _forced("AM", lambda c: seconds(c.began))),
    ("  first adaptation after", "3 s", _forced("AM", lambda c: _after(c, c.issued, 0))),
    ("  last adaptation after", "about 13 s", _forced("AM", lambda c: _after(c, c.issued, -1))),
    ("  changes lag behind, median", "1 s", _forced("AM", _lag)),
    ("  last signal after", "9 s", _forced("AM", lambda c: seconds((c.silent or c.began) - c.began))),
    ("  final change after", "11 s (or 14 s)", _forced("AM", lambda c: seconds(c.response))),
    ("ADD fails: first signal", "215 s", _forced("ADD", lambda c: seconds(c.began))),
    ("  final change after", "similar", _forced("ADD", lambda c: seconds(c.response))),
    ("ADD holds again: signal", "357 s", _back),
    ("  taken back after", "not given", _back_after),
    ("1/M is set back at", "152, 215, 357 s", lambda m: ", ".join(f"{t:.0f}" for t in setbacks(m)) + " s"),
    ("reactions interrupted", "none", lambda m: str(m.interruptions) if m.interruptions else "none"),
)


def products_row(noun: str, theirs: Measures, ours: Measures) -> Row:
    """What came out of the world until the end of the run."""
    return Row(f"{noun} completed, rejected in {theirs.end:.0f} s", "not given", _made(theirs), _made(ours))


def levels(m: Measures) -> tuple[float, ...]:
    """M along the run, only what lasted longer than a tick."""
    ends = (*m.m.times[1:], m.end)
    kept = [v for t, e, v in zip(m.m.times, ends, m.m.values, strict=True) if e - t > 1.0 + 1e-9]
    return tuple(kept[:1]) + tuple(b for a, b in pairwise(kept) if a != b)
