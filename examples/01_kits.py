"""A robot is already building kits while a planner writes its program, piece by piece, and rewrites it.

    $ python examples/01_kits.py
"""

from __future__ import annotations

from textwrap import shorten
from typing import Any

import planner_reactor
from planner_reactor.trace import Event


def tell(event: Event) -> None:
    """A line for whatever the robot does, and for whatever changes its program."""
    about = event.data
    match event.kind:
        case "tray_moved_to" if about["target"] == "area":
            say(event, "robot: puts an empty tray into its place")
        case "part_moved_to" if ":" in about["target"]:
            say(event, f"robot: puts a {about['target'].partition(':')[2]} into the tray")
        case "kit_judged":
            say(event, f"robot: a kit is {'complete' if about['accepted'] else 'rejected'}")
        case "stub_trigger":
            say(event, f"robot: needs {about['situation']}, which is not written yet")
        case "adaptation_issued":
            say(event, f"planner: {about['purpose']}")
            for clause in about["text"].splitlines():
                print(" " * 10, shorten(clause, 110, placeholder=" ..."))
        case "adaptation_applied":
            say(event, f"reactor: now runs it ({about['purpose']})")


def say(event: Event, line: str) -> None:
    print(f"{event.time:6.1f} s  {line}")


def watch(loop: Any) -> None:
    loop.trace.sinks.append(tell)


# the planner is charged what it took in 1994: 26 seconds until it has a first piece to send
result = planner_reactor.kit(trays=2, seed=1, planner_time="papers", relax="AQ", watch=watch)
print("kits:", result["kits"], " adaptations:", result["adaptations"])
print("reactions interrupted:", result["interruptions"], " laws broken:", len(result["violations"]))
print("still assumed:", *result["assumptions"]["reactor"])
