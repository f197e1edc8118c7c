"""What the sensors say of each of the nine assumptions, whenever a monitor asks (R §8.3, R §9.2.3).

One picture of the tray area serves AF, ACT, ACP and ADT; downstream's ready line is ADD; the arm's queue
shows AO; the others live on what processes, the palm camera, the entrance and downstream's verdicts have
shown (`evidence`).
"""

from __future__ import annotations

from planner_reactor.workcell.cell import Cell
from planner_reactor.workcell.memory import TrayRecord
from planner_reactor.workcell.sensors import TrayView


class Monitors:
    """Answers `holds(assumption)`: True, False, or None for unknown."""

    def __init__(self, cell: Cell) -> None:
        self._cell = cell
        self._looked_at = -1.0

    def holds(self, assumption: str) -> bool | None:
        """Ask the sensors now."""
        cell = self._cell
        if assumption == "ADD":
            return cell.sensors.downstream_ready()
        if assumption in ("AF", "ACT", "ACP", "ADT"):
            self._look_at_trays()
        elif assumption == "AO" and (awaited := cell.arm.starved()):
            cell.evidence.against("AO", f"{awaited} is starved while others wait")
        return cell.evidence.holds(assumption)

    def _look_at_trays(self) -> None:
        """One picture of all trays that stand there, at most one at an instant."""
        cell = self._cell
        if self._looked_at == cell.scheduler.now:
            return
        self._looked_at = cell.scheduler.now
        views = cell.sensors.trays()
        if views is None:
            cell.evidence.note("camera")
            return
        standing = {tray.tag: tray for tray in cell.memory.trays.values() if tray.state == "area"}
        for view in views:
            if view.tag in standing:
                self._compare(standing[view.tag], view)

    def _compare(self, tray: TrayRecord, view: TrayView) -> None:
        evidence, filled = self._cell.evidence, view.filled
        if view.pose == tray.pose:
            evidence.supports("ADT")
        else:
            evidence.against("ADT", f"{tray.handle} is not where it was put")
        missing = [slot for slot in self._cell.kit.kinds if tray.expects(slot) and slot not in filled]
        strange = [slot for slot in filled if slot in tray.gone or not tray.done(slot)]
        tray.gone.difference_update(strange)
        tray.gone.update(missing)
        tray.glimpsed.update(strange)
        if missing:
            evidence.against("ACT", f"{missing[0]} is missing from {tray.handle}")
        elif tray.contents:
            evidence.supports("ACT")
        if not strange:
            evidence.supports("ACP")
            return
        for slot in strange:
            evidence.against(tray.blames(slot), f"slot {slot} of {tray.handle} was filled by somebody else")
