"""What every picture of the workspace also shows: the tray area, compared with what is remembered of it.

The global camera covers the whole workspace (R §9.1), so a picture taken for a part shows the trays as well. The
comparison only gives evidence, for and against AF, ACT, ACP and ADT; it changes nothing that a process acts on.
"""

from __future__ import annotations

from planner_reactor.runtime.scheduler import Scheduler
from planner_reactor.workcell.evidence import Evidence
from planner_reactor.workcell.kit import KitSpec
from planner_reactor.workcell.memory import Memory, TrayRecord
from planner_reactor.workcell.sensors import Sensors, TrayView

GLANCE_S = 1.0
"""Pictures taken for something else are looked through for trays at most so often."""


class TrayWatch:
    """Compares the tray area with the record. `look` at once, `glance` when a picture is taken anyway."""

    def __init__(
        self, sensors: Sensors, memory: Memory, evidence: Evidence, kit: KitSpec, scheduler: Scheduler
    ) -> None:
        self._sensors = sensors
        self._memory = memory
        self._evidence = evidence
        self._kinds = kit.kinds
        self._scheduler = scheduler
        self._looked_at = -GLANCE_S

    def glance(self) -> None:
        """Look, unless that was done a moment ago."""
        if self._scheduler.now - self._looked_at >= GLANCE_S:
            self.look()

    def look(self) -> None:
        """Look at all trays that stand there, once an instant."""
        if self._looked_at == self._scheduler.now:
            return
        self._looked_at = self._scheduler.now
        views = self._sensors.trays()
        if views is None:
            self._evidence.note("camera")
            return
        standing = {tray.tag: tray for tray in self._memory.trays.values() if tray.state == "area"}
        for view in views:
            if view.tag in standing:
                self._compare(standing[view.tag], view)

    def _compare(self, tray: TrayRecord, view: TrayView) -> None:
        evidence, filled = self._evidence, view.filled
        if view.pose == tray.pose:
            evidence.supports("ADT")
        else:
            evidence.against("ADT", f"{tray.handle} is not where it was put")
        if tray.contents.keys() == set(filled) and tray.as_expected():
            evidence.supports("ACP")
            if filled:
                evidence.supports("ACT")
            return
        missing = [slot for slot in self._kinds if tray.expects(slot) and slot not in filled]
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
        for slot in strange:
            evidence.against(tray.blames(slot), f"slot {slot} of {tray.handle} was filled by somebody else")
