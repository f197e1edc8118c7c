"""A process that starts, reads a domain, plans, and says how many CPU seconds it took to its first adaptation.

`python bench_first.py FILE.itl`: from the start of the interpreter on, loading included.
"""

from __future__ import annotations

import sys
import time

from planner_reactor.logic.reader import read_domain
from planner_reactor.planner import Planner

planner = Planner(read_domain(sys.argv[1]), relax=())
while (step := planner.step()) is not None and not step.adaptations:
    pass
print(time.process_time())
