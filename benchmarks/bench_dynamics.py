"""How long it takes to find all actions in a model: `python benchmarks/bench_dynamics.py`.

From text to action schemas (X §5, §6): TEM, GEM and BEM with open names, and with every delay a number, where time is
exact and there are more states. Processor time of five rounds, the median and the least; the goal is one second.
"""

from __future__ import annotations

import time
from statistics import median

from planner_reactor.planner.dynamics import derive
from planner_reactor.rs.parser import parse_program
from planner_reactor.workcell.environments.dynamics import host, model
from planner_reactor.workcell.environments.worlds import TIMING

ROUNDS = 5
MODELS = {"tracking": "TEM", "guarded_move": "GEM", "belt": "BEM"}


def main() -> int:
    print(f"{'model':14} {'delays':8} {'median ms':>10} {'least ms':>9} {'actions':>8}")
    for name, process in MODELS.items():
        source = model(name)
        for delays, given in (("open", {}), ("numbers", {k: v for k, v in TIMING.items() if k in source})):
            seconds = []
            for _ in range(ROUNDS):
                start = time.process_time()
                found = derive(parse_program(source), process, signatures=host.signatures, given=given)
                seconds.append(time.process_time() - start)
            middle, best = 1000 * median(seconds), 1000 * min(seconds)
            print(f"{process:14} {delays:8} {middle:10.0f} {best:9.0f} {len(found.actions):8}")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
