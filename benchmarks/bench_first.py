"""A process of its own that starts, reads a domain, plans, and ends when the first adaptation is there.

`python bench_first.py FILE.itl`: what a cold start takes is the time of this process.
"""

from __future__ import annotations

import sys

from planner_reactor.logic.reader import read_domain
from planner_reactor.planner import Planner

planner = Planner(read_domain(sys.argv[1]), relax=())
while (step := planner.step()) is not None and not step.adaptations:
    pass
