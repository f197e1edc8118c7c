"""An adaptation, a failure and HALT at one instant of a reactor, in every order that the semantics leaves open.

    python -m tests.reactor.races [--workers 2]      all of them; goes on where it stopped (make races)

In a body, where one ends, where the next begins. After each run nothing runs, nothing is left, no law is broken. The
progress of each case is kept in out/races.jsonl.
"""

from __future__ import annotations

import argparse
import json
import time
from concurrent.futures import ProcessPoolExecutor
from itertools import product
from pathlib import Path

from planner_reactor.link.messages import Adaptation
from planner_reactor.runtime.guiding import GuidedScheduler, guide
from tests.reactor.driving import Bench, change
from tests.reactor.interleavings import STEPS, interleavings

OUT = Path("out/races.jsonl")
IN_A_BODY = 1.0
INSTANTS = (0.5, IN_A_BODY, 2.0)
TOGETHER = (("adapt", "fail"), ("adapt", "halt"), ("fail", "halt"), ("adapt", "fail", "halt"))
KEPT = 1_000
"""Runs after which the progress is kept."""

SERVED = Adaptation(
    id=1,
    definitions="""
    P[0] = Delay[0.5] :; ASSERT[part]
    P[1] = SIT[part]<k> :; (~(Do[old, 1.5] : SUCCEED[part, k]) : FAIL[part, k])
    """,
    changes=(change("part", 0, "A"),),
    adds=(1, 0),
)
REPLACED = Adaptation(
    id=2,
    definitions="P[2] = SIT[part]<k> :; (~(Do[new, 1.5] : SUCCEED[part, k]) : FAIL[part, k])",
    changes=(change("part", 1, "B"),),
    kills=(1,),
    adds=(2,),
)


def cancelled(scheduler: GuidedScheduler, at: float, what: tuple[str, ...]) -> None:
    """One run: what is done at this instant, in one of its orders; `AssertionError` if anything is wrong after it."""
    bench = Bench(scheduler=scheduler, budgets=STEPS)
    guide(bench.reactor.executer, scheduler)
    does = {
        "adapt": lambda: bench.reactor.receive(REPLACED),
        "fail": lambda: bench.reactor.assumption_sensed("A", False),
        "halt": bench.reactor.halt,
    }
    bench.at(0.0, SERVED)
    for one in what:
        scheduler.call_at(at, does[one])
    bench.run(5.1)
    bench.reactor.halt()
    bench.run(6.0)
    assert bench.reactor.laws.violations == []
    assert bench.reactor.executer.statistics().basic_running == 0
    assert len(bench.times("entered")) == len(bench.times("left"))
    assert not bench.reactor.situations.instances


def main() -> None:
    """All cases, the largest first; ends with 1 at a run that is wrong."""
    parser = argparse.ArgumentParser(prog="python -m tests.reactor.races", description=__doc__)
    parser.add_argument("--workers", type=int, default=2, help="processes [default: 2]")
    workers = parser.parse_args().workers
    OUT.parent.mkdir(exist_ok=True)
    cases = sorted(product(INSTANTS, TOGETHER), key=lambda case: -len(case[1]))
    with ProcessPoolExecutor(workers) as pool:
        counts = list(pool.map(_case, cases))
    print(f"{sum(counts):,} orders of {len(cases)} cases, nothing wrong")


def _case(case: tuple[float, tuple[str, ...]]) -> int:
    """How many orders one case has."""
    at, what = case
    name, (count, begin) = f"{' '.join(what)} at {at:g}", (0, [])
    for line in OUT.read_text().splitlines() if OUT.exists() else ():
        if (row := json.loads(line))["case"] == name:
            count, begin = row["count"], row["next"]
    if begin is None:
        return count
    began = time.process_time()
    for following in interleavings(lambda scheduler: cancelled(scheduler, at, what), at=at, begin=begin):
        count += 1
        if count % KEPT == 0 or following is None:
            with OUT.open("a") as file:
                file.write(json.dumps({"case": name, "count": count, "next": following}) + "\n")
    print(f"{name}: {count:,} orders, {time.process_time() - began:.0f} s", flush=True)
    return count


if __name__ == "__main__":
    main()
