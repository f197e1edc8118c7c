"""The page about the cell names every process, window, fault and parameter there is."""

from __future__ import annotations

from pathlib import Path

from planner_reactor.runtime import Scheduler, VirtualClock
from planner_reactor.workcell.disturbances import DISTURBANCES
from planner_reactor.workcell.host import host

PAGE = (Path(__file__).parents[2] / "docs" / "workcell.md").read_text(encoding="utf-8")


def test_every_process_stands_there_with_the_end_of_its_window() -> None:
    for name, signature in host(Scheduler(VirtualClock())).signatures.items():
        (row,) = [line for line in PAGE.splitlines() if line.startswith(f"| `{name}[")]
        assert signature.window is not None
        assert f"| {signature.window[1]:g} |" in row


def test_every_fault_stands_there_with_what_it_breaks_and_its_parameters() -> None:
    for kind, disturbance in DISTURBANCES.items():
        (row,) = [line for line in PAGE.splitlines() if line.startswith(f"| `{kind}` |")]
        assert f"| {disturbance.breaks or '–'} |" in row
        assert all(f"`{key} = " in row for key in disturbance.defaults)
