"""What the sensors say of each of the nine assumptions, whenever a monitor asks (R §8.3, R §9.2.3).

A picture of the tray area serves AF, ACT, ACP and ADT; downstream's ready line is ADD; the arm's queue shows AO; the
others live on what processes, the palm camera, the entrance and downstream's verdicts have shown (`evidence`).
"""

from __future__ import annotations

from planner_reactor.runtime import Caution, Reading
from planner_reactor.workcell.cell import Cell

BY_PICTURE = ("AF", "ACT", "ACP", "ADT")
"""The assumptions about trays, which one look at the tray area tells about."""

CAUTIONS = {"ADD": Caution(stuck=10.0), **dict.fromkeys(BY_PICTURE, Caution(stale=30.0))}
"""A line without its life sign, or a picture that is this old, says nothing."""


class Monitors:
    """Answers `holds(assumption)`: True, False, or None for unknown."""

    def __init__(self, cell: Cell) -> None:
        self._cell = cell

    def reading(self, assumption: str) -> Reading:
        """The same, with when the picture was taken, or with the line's life sign."""
        sensors, now = self._cell.sensors, self._cell.scheduler.now
        holds = self.holds(assumption)
        if assumption == "ADD":
            return Reading(holds, now, sensors.downstream_life())
        return Reading(holds, sensors.pictured_at() if assumption in BY_PICTURE else now)

    def holds(self, assumption: str) -> bool | None:
        """Ask the sensors now."""
        cell = self._cell
        if assumption == "ADD":
            return cell.sensors.downstream_ready()
        if assumption in BY_PICTURE:
            cell.watch.look()
        elif assumption == "AO" and (awaited := cell.arm.starved()):
            cell.evidence.against("AO", f"{awaited} is starved while others wait")
        return cell.evidence.holds(assumption)
