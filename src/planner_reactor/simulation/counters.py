"""The rows of the fault table that a simulation can bring about, each with what counts it (docs/reliability.md).

A campaign that leaves one of them at 0 has failed: the injector must show that the fault happened.
"""

from __future__ import annotations

from collections.abc import Mapping

ROWS: Mapping[str, tuple[int, str]] = {
    "1 planners killed while their adaptation was under way": (1, "planner killed mid-adaptation"),
    "1 planners that resumed on what stood": (1, "planner begins anew, on what the reactor says"),
    "2 crashes between KILL and ADD": (2, "reactor killed with the old reaction gone and the new one not there"),
    "3 writes torn": (3, "power loss that tears a write"),
    "3 writes lost": (3, "power loss that loses a write"),
    "4 frames lost": (4, "link: frames lost"),
    "4 frames repeated": (4, "link: frames repeated"),
    "4 frames reordered": (4, "link: frames reordered"),
    "4 frames delayed": (4, "link: frames that took longer than a resend"),
    "4 frames cut": (4, "link: frames while it was cut"),
    "5 half-open: the silent end is absent": (5, "half-open link, the lease ends"),
    "6 moves resumed after the drive was gone": (6, "driver link drops, resume"),
    "7 frames of a planner whose time is over": (7, "two planners: frames of the first come in beside the second's"),
    "7 adaptations of an older epoch refused": (7, "two planners, or a revoked one: a stale epoch (also row 22)"),
    "8 situations that did not end in time": (8, "active situation never ends: TIMEOUT"),
    "9 drained while instances overlapped": (9, "overlapping re-assertion: two in service as a drain begins"),
    "10 deeds that failed in what is being changed": (10, "a participant dies during adaptation"),
    "11 groups refused for one of them": (11, "one of a group fails to add"),
    "12 deeds of a version whose successor is there": (12, "old behaviour beside the new, one version an instance"),
    "13 commands abandoned by a crash": (13, "what was commanded is abandoned, once"),
    "13 commands abandoned by the reactor": (13, "the same, of what is cancelled, halted or too late"),
    "14 deeds that raised": (14, "basic process raises"),
    "15 deeds that outlived their limit": (15, "basic process outlives its limit and is abandoned"),
    "16 livelocks": (16, "zero-delay livelock"),
    "17 recursions without a guard refused": (17, "unguarded recursion in an adaptation"),
    "18 parser bombs refused": (18, "parser bomb in an adaptation"),
    "20 unknown processes refused": (20, "an adaptation names an unknown process"),
    "21 repeats that changed nothing": (21, "replayed adaptation, acknowledged and not applied again"),
    "21 replays under another content refused": (21, "a spent id with other content"),
    "23 refusals told with their reason": (23, "a refusal is told"),
    "24 jumps of the time of day": (24, "clock jump of a day"),
    "24 runs that were done twice, with jumps and without": (24, "the trace is the same (law 16)"),
    "25 readings found stale": (25, "sensor late"),
    "25 signals found stuck": (25, "sensor stuck"),
    "25 readings that slipped": (25, "sensor noisy"),
    "25 times that a sensor knew nothing": (25, "sensor silent"),
    "26 flips that were noticed": (26, "assumption flapping ten times a second"),
    "27 adaptations refused for want of a disk": (27, "disk full, or sync fails"),
    "27 beats while the disk took nothing": (27, "and the reactor goes on reacting"),
    "29 crowds of 10,000": (29, "10,000 simultaneous situations"),
    "29 instances beyond the budget turned away": (29, "the admission limit"),
    "30 crashes while something was held": (30, "reactor crash while the arm holds something"),
    "31 other versions of the link refused": (31, "version mismatch, both named"),
    "32 restarts in a storm": (32, "restart storm"),
    "32 situations that failed too often": (32, "a storm of failures, then the safe stop"),
    "what only a process noticed, and fails still": (0, "failures that no sensor reads, told until the planner knows"),
    "what failed and came back to the planner": (0, "assumptions reinstated by the cell's planner"),
    "halts": (0, "stop button (law 15)"),
    "watchdog: the machine was stopped": (0, "watchdog not kicked in time"),
}
"""Counter → row of the fault table (0: none), and what it counts."""

ELSEWHERE: Mapping[int, tuple[str, str]] = {
    3: ("tests/reactor/test_journal.py", "journal cut at and flipped in every byte"),
    17: ("tests/rs/test_guardedness.py", "recursion that nothing guards, at load"),
    18: ("tests/rs/test_budgets.py", "nesting, sizes and budgets of texts"),
    19: ("tests/runtime/test_budgets.py", "budgets of what a text comes to when it runs"),
    15: ("tests/runtime/test_isolation.py", "one hangs and one raises among a thousand"),
}
"""Rows that tests outside the simulation cover, too: where, and what."""


def missing(rows: Mapping[str, int]) -> list[str]:
    """The counters that are still at 0."""
    return [name for name in ROWS if not rows.get(name)]
