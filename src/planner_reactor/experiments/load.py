"""`load`: how long an adaptation waits while instances of the situation that it changes overlap, in each mode.

One to eight roots assert a situation again and again, each up to 10 s after it was done; an instance takes 5 to 20 s,
all are served at once. After 100 s an adaptation changes the reaction. What is measured is the time from then until it
is applied, and until a new instance is served by the new reaction. The papers' WAITINHIBIT (`wait`) has to meet an
instant at which nothing is on; it is given up after 600 s.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from math import inf
from pathlib import Path
from typing import Any, get_args

import msgspec

from planner_reactor.experiments.trials import middle, run_trials, write_json, write_rows
from planner_reactor.link.messages import Adaptation, Change, Mode
from planner_reactor.reactor.reactor import Reactor
from planner_reactor.runtime import Host, Scheduler, VirtualClock
from planner_reactor.trace import Event, Trace

TRIALS = 100
OVERLAPPING = range(1, 9)
MODES: tuple[Mode, ...] = get_args(Mode)
SHORTEST, LONGEST = 5.0, 20.0
"""Seconds that an instance takes."""

PAUSE = 10.0
"""Seconds after which a root asserts again at the latest."""

AT, PATIENCE = 100.0, 600.0
"""Seconds: when the adaptation comes, and how long it may wait."""


class Trial(msgspec.Struct, frozen=True):
    mode: Mode
    overlapping: int
    seed: int


def experiment(
    out: Path, *, trials: int | None, workers: int, watch: Callable[[int, int], object]
) -> Mapping[str, Any]:
    """The registry's entry: `load.csv`, `load.json` and the figure `load` in `out`."""
    from planner_reactor.experiments.figures_load import draw

    seeds = range(1, (trials or TRIALS) + 1)
    chosen = [Trial(mode, n, seed) for mode in MODES for n in OVERLAPPING for seed in seeds]
    rows = run_trials(one, chosen, workers=workers, watch=watch)
    found = {"trials": len(seeds), "waits": [_line(rows, mode, n) for mode in MODES for n in OVERLAPPING]}
    write_rows(out / "load.csv", rows)
    write_json(out / "load.json", found)
    draw(found["waits"], out)  # type: ignore[arg-type]  # the lines of just now
    return found


def one(trial: Trial) -> dict[str, Any]:
    """Seconds until the adaptation was applied, and until it was seen to act; None if it was given up."""
    scheduler = Scheduler(VirtualClock(), seed=trial.seed)
    trace = Trace(lambda: scheduler.now)
    reactor = Reactor(scheduler, host=_host(scheduler), trace=trace)
    reactor.start()
    reactor.receive(_first(trial.overlapping))
    scheduler.call_at(AT, lambda: reactor.receive(_second(trial.mode)))
    trace.sinks.append(lambda event: scheduler.stop() if _acts(event) else None)
    reactor.executer.run(until=AT + PATIENCE + LONGEST)
    applied = next((e.time - AT for e in trace.of("adaptation_applied") if e.data["id"] == 2), None)
    acted = next((e.time - AT for e in trace.events if _acts(e)), None)
    broken = [str(v) for v in reactor.laws.violations]
    return {"mode": trial.mode, "overlapping": trial.overlapping, "seed": trial.seed,
            "applied_s": applied, "acted_s": acted, "violations": broken}  # fmt: skip


def _acts(event: Event) -> bool:
    return event.kind == "entered" and event.data["guard"] == NEW


OLD, NEW = 1, 30
"""Labels: no label is used twice, and those of the roots lie between."""


def _host(scheduler: Scheduler) -> Host:
    host = Host("load")

    @host.process(window=(SHORTEST, LONGEST))
    def Work() -> Any:
        yield scheduler.random("work").uniform(SHORTEST, LONGEST)

    @host.process(window=(0.0, PAUSE))
    def Pause() -> Any:
        yield scheduler.random("pause").uniform(0.0, PAUSE)

    return host


def _reaction(label: int) -> str:
    return f"P[{label}] = SIT[work]<k> :: (~(Work : SUCCEED[work, k]) : FAIL[work, k])"


def _first(overlapping: int) -> Adaptation:
    roots = {10 + n: f"P[{10 + n}] = Pause :; ASSERT[work]" for n in range(overlapping)}
    return Adaptation(
        id=1,
        definitions="\n".join([_reaction(OLD), *roots.values()]),
        changes=(Change(situation="work", base=0, fresh=True),),
        adds=(OLD, *roots),
    )


def _second(mode: Mode) -> Adaptation:
    return Adaptation(
        id=2,
        definitions=_reaction(NEW),
        changes=(Change(situation="work", base=1),),
        kills=(OLD,),
        adds=(NEW,),
        mode=mode,
        deadline=PATIENCE,
    )


def _line(rows: Sequence[Mapping[str, Any]], mode: Mode, overlapping: int) -> dict[str, Any]:
    mine = [r for r in rows if (r["mode"], r["overlapping"]) == (mode, overlapping)]
    waits = [inf if r["applied_s"] is None else r["applied_s"] for r in mine]
    acts = [inf if r["acted_s"] is None else r["acted_s"] for r in mine]

    def shown(value: float | None) -> float | None:
        return None if value is None or value == inf else round(value, 3)

    return {
        "mode": mode, "overlapping": overlapping, "median_s": shown(middle(waits)), "p95_s": shown(middle(waits, 0.95)),
        "acted_median_s": shown(middle(acts)), "never": round(sum(w == inf for w in waits) / len(waits), 3),
        "violations": sum(len(r["violations"]) for r in mine),
    }  # fmt: skip
