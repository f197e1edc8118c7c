"""How long the limit sets of the papers take: `python benchmarks/bench_limits.py [--executions N]`.

X (8), (12) and (15), from text to set, and the Zeno loop of the tracking world as printed. Each is asked seven times;
what is shown is processor time, the median and the least, with the goal beside it. With `--executions`, so many
concrete runs of each model are held against its set as well.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Callable
from pathlib import Path
from statistics import median

from planner_reactor.analysis.zeno import zeno
from planner_reactor.workcell.environments.dynamics import model

sys.path.insert(0, str(Path(__file__).parent.parent))
from tests.analysis.executions import campaign  # the tests hold runs against sets in the same way
from tests.analysis.models import CALLS, SENSORS, limits, read, shipped

ROUNDS = 7
EQUATIONS = {"tracking": "(8) TEM", "guarded_move": "(12) GEM", "belt": "(15) BEM"}
AS_PRINTED = model("tracking").replace("STREAM", "Printed") + "Printed[y, v] = OUT[y, v] :; STOP\n"


def measured(work: Callable[[], object]) -> list[float]:
    """Processor seconds of each round."""
    found = []
    for _ in range(ROUNDS):
        start = time.process_time()
        work()
        found.append(time.process_time() - start)
    return found


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--executions", type=int, default=0, metavar="N", help="concrete runs of each model")
    given = parser.parse_args()
    print(f"{'what':22} {'median ms':>10} {'least ms':>9} {'goal ms':>8} {'limits':>7} {'states':>7}")
    for name, equation in EQUATIONS.items():
        seconds = measured(lambda name=name: limits(shipped(name)))  # type: ignore[misc]
        found = limits(shipped(name))
        _row(equation, seconds, 100, len(found.limits), found.states)
    seconds = measured(lambda: zeno(*read(AS_PRINTED, "ThisWorld[p, a]")))
    _row("(7) as printed: Zeno", seconds, 1_000, 1, zeno(*read(AS_PRINTED, "ThisWorld[p, a]")).states)
    for name in CALLS if given.executions else ():
        symbolic = shipped(name)
        unforetold, unreached, ended = campaign(
            name, given.executions, 11, SENSORS, limits(symbolic).limits, symbolic
        )
        runs = f"{ended} of {given.executions} runs came to a limit"
        print(f"{EQUATIONS[name]}: {runs}, {len(unforetold)} to one that the set lacks; {len(unreached)} not reached")
    return 0


def _row(what: str, seconds: list[float], goal: int, entries: int, states: int) -> None:
    middle, least = 1_000 * median(seconds), 1_000 * min(seconds)
    print(f"{what:22} {middle:10.1f} {least:9.1f} {goal:8} {entries:7} {states:7}")


if __name__ == "__main__":
    raise SystemExit(main())
