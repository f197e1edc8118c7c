"""The rows of the fault table that a simulation can bring about, each with what counts it (docs/reliability.md).

A campaign that leaves one of them at 0 has failed: the injector must show that the fault happened.
"""

from __future__ import annotations

from collections.abc import Mapping

ROWS: Mapping[str, tuple[int, str]] = {
    "1 planner ends with adaptations unanswered": (1, "planner killed mid-adaptation"),
    "2 crash between KILL and ADD": (2, "reactor killed between COMMIT and the last ADD"),
    "3 writes torn": (3, "power loss that tears a write"),
    "4 frames lost": (4, "link: frames lost"),
    "4 frames repeated": (4, "link: frames repeated"),
    "4 frames reordered": (4, "link: frames reordered"),
    "4 frames cut": (4, "link: frames while it was cut"),
    "5 half-open: the silent end is absent": (5, "half-open link, the lease ends"),
    "6 moves resumed after the drive was gone": (6, "driver link drops, resume"),
    "7 frames of a planner whose time is over": (7, "two planners: the first goes on talking"),
    "7 adaptations of a planner whose time is over": (7, "two planners: a stale epoch"),
    "8 situations that did not end in time": (8, "active situation never ends: TIMEOUT"),
    "9 drained while instances overlapped": (9, "overlapping re-assertion"),
    "10 deeds that failed inside an adaptation": (10, "a participant dies during adaptation"),
    "11 groups refused as one": (11, "one of a group fails to add"),
    "12 deeds of a version whose successor is there": (12, "old behaviour beside the new, one version an instance"),
    "13 commands abandoned by a crash": (13, "what was commanded is abandoned, once"),
    "14 deeds that raised": (14, "basic process raises"),
    "14 deeds that hung": (15, "basic process outlives its limit"),
    "16 livelocks": (16, "zero-delay livelock"),
    "16 runs that were done twice": (24, "time of day jumps, and the trace is the same (law 16)"),
    "21 adaptations replayed": (21, "replayed adaptation"),
    "24 jumps of the time of day": (24, "clock jump of a day"),
    "25 sensors that failed": (25, "sensor stuck, noisy, silent"),
    "26 times that an assumption flapped": (26, "assumption flapping"),
    "27 writes refused by the disk": (27, "disk full, or sync fails"),
    "27 and the reactor went on": (27, "disk full, and the reactor goes on reacting"),
    "29 crowds of 500 or more": (29, "many simultaneous situations"),
    "30 crashes while something was held": (30, "reactor crash while the arm holds something"),
    "32 restart storms": (32, "restart storm"),
    "halts": (0, "stop button (law 15)"),
}
"""Counter → row of the fault table (0: none), and what it counts."""


def missing(rows: Mapping[str, int]) -> list[str]:
    """The counters that are still at 0."""
    return [name for name in ROWS if not rows.get(name)]
