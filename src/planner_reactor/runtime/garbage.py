"""The garbage collector of Python, where milliseconds count.

It looks at everything that there is at some instant, for as long as that takes: some ten milliseconds in a process
that has loaded a domain. What planner and reactor drop is nearly all freed at once, by counting, so that the collector
finds next to nothing. In runs on the wall clock it leaves alone what was loaded before, and looks at the rest seldom.
"""

from __future__ import annotations

import gc
from collections.abc import Iterator
from contextlib import contextmanager

SELDOM = (10_000, 20, 100)
"""Of new objects: so many before the youngest are looked at, so often before the next ones are, and before all are."""


@contextmanager
def seldom_collected() -> Iterator[None]:
    """As long as this lasts; then it is as before."""
    before = gc.get_threshold()
    gc.collect()
    gc.freeze()
    gc.set_threshold(*SELDOM)
    try:
        yield
    finally:
        gc.set_threshold(*before)
        gc.unfreeze()
