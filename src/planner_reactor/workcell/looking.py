"""Basic processes that find out: Choose, AwaitArrival, Test, LocateTray, SlotVacant, Verify, AwaitReady.

They are what relaxing an assumption adds to a reaction (R §8.3): testing (AQ), choosing a
variant (AS), looking into slots (AF, ACP), verifying (ACT), locating the tray again (ADT), waiting for
downstream (ADD), waiting for what comes first (AO). While there is no picture they wait; unknown is never
taken for no.
"""

from __future__ import annotations

from planner_reactor.runtime.signals import Aborted
from planner_reactor.workcell.cell import TRAY, Cell, Steps
from planner_reactor.workcell.memory import TrayRecord
from planner_reactor.workcell.placing import Placing
from planner_reactor.workcell.sensors import TrayView


class Looking:
    """The processes that sense."""

    def __init__(self, cell: Cell, placing: Placing) -> None:
        self._cell = cell
        self._placing = placing

    def choose(self, m: str) -> Steps[str]:
        """Choose[m]<d>: the variant to look for: the wanted one; when that is starved, a substitute in sight."""
        cell = self._cell
        if m == TRAY:
            return m
        part = cell.part(cell.kind(m))
        yield cell.calibration.look_s
        now = cell.scheduler.now
        if cell.spot(part.wanted) is not None:
            return part.wanted
        if now - cell.memory.last_seen[part.wanted] < cell.calibration.starved_s:
            return part.wanted
        for substitute in part.substitutes:
            if cell.memory.candidate(substitute, now, cell.reach_s) is not None:
                cell.evidence.against("AS", f"{part.wanted} is starved, {substitute} is there")
                return substitute
        return part.wanted

    def await_arrival(self, m: str) -> Steps[None]:
        """AwaitArrival[m]: until a part of the kind (or variant) is in sight; its turn is then opportunistic."""
        cell = self._cell
        if m == TRAY:
            return
        kind = cell.kind(m)
        if cell.memory.settled(kind):
            return
        began = cell.scheduler.now
        while not cell.in_sight(m):
            waited = cell.scheduler.now - began
            if waited > cell.wait_s:
                raise Aborted(f"no {m} came in time")
            if waited > cell.calibration.starved_s and cell.memory.sees_other(kind, cell.scheduler.now):
                cell.evidence.against("AO", f"{m} stays away while others come")
            yield cell.arrivals[kind].within(cell.calibration.look_again_s)
        cell.memory.due[kind] += 1

    def test(self, m: str, x: str) -> Steps[None]:
        """Test[m,x]: put what is held to the test; what fails is dropped into the reject bin, then it aborts."""
        cell = self._cell
        part, tray = cell.memory.parts.get(x), cell.memory.trays.get(x)
        record = part or tray
        if record is None or record.state in ("placed", "area") or record.tested:
            if record is None and not (x.startswith(TRAY) and cell.memory.was_given(x)):
                raise Aborted(f"{x} is gone")
            return
        turn = yield from cell.arm.take_up(x)
        try:
            yield cell.arm.go("test", cell.calibration.test_s)
            good = cell.sensors.test()
            if good is None:
                cell.arm.feel_empty()
                raise Aborted(f"{x} was lost on the way")
            if not good:
                cell.evidence.against("AQ", f"a {m} failed its test")
                yield from self._placing.discard("failed its test")
                raise Aborted(f"{x} failed its test")
            cell.evidence.supports("AQ")
            record.tested = True
            cell.arm.stand()
        finally:
            cell.arm.leave(turn)

    def locate_tray(self, t: str) -> Steps[None]:
        """LocateTray[t]: see where the tray now stands, and remember it. Aborts if it is not in the tray
        area.
        """
        cell = self._cell
        tray = cell.tray(t)
        if tray is None:
            return
        held = cell.memory.held
        view = yield from self._inspect(tray, held if held in cell.memory.parts else "")
        if view.pose != tray.pose:
            cell.evidence.against("ADT", f"{t} is not where it was put")
            tray.pose = view.pose

    def slot_vacant(self, t: str, k: str) -> Steps[None]:
        """SlotVacant[t,k]: look into the slot; stops if it is vacant, aborts if something is in it (or t has
        left).
        """
        cell = self._cell
        kind = cell.kind(k)
        tray = cell.tray(t)
        if tray is None:
            raise Aborted(f"{t} has left")
        held = cell.memory.parts.get(cell.memory.held)
        view = yield from self._inspect(tray, held.handle if held is not None and held.kind == kind else "")
        if kind not in view.filled:
            self._note_missing(tray, kind)
            return
        if not tray.done(kind):
            cell.memory.note(tray, kind)
            cell.evidence.against(tray.blames(kind), f"slot {kind} of {t} is filled already")
        raise Aborted(f"slot {kind} of {t} is filled")

    def verify(self, t: str) -> Steps[None]:
        """Verify[t]: look at the whole tray; aborts if a slot is vacant (and remembers that it is)."""
        cell = self._cell
        tray = cell.tray(t)
        if tray is None:
            return
        view = yield from self._inspect(tray, "", seconds=cell.calibration.verify_s)
        missing = [kind for kind in cell.ordered if kind not in view.filled]
        for kind in missing:
            self._note_missing(tray, kind)
        if missing:
            raise Aborted(f"{t} lacks {', '.join(missing)}")
        cell.evidence.supports("ACT")

    def await_ready(self) -> Steps[None]:
        """AwaitReady[]: until downstream is ready; it then keeps a place for some time."""
        cell = self._cell
        deadline = cell.scheduler.now + cell.calibration.patience_s
        while not cell.reserve_downstream():
            cell.evidence.against("ADD", "downstream is not ready")
            left = deadline - cell.scheduler.now
            if left <= 0 or not (yield cell.downstream_changed.within(left)):
                raise Aborted("downstream is not ready")

    def _inspect(self, tray: TrayRecord, holding: str, *, seconds: float = 0.0) -> Steps[TrayView]:
        """A picture of the tray; from above it, if the arm holds a part for it (so that nobody reaches in
        after).
        """
        cell = self._cell
        turn = None
        try:
            if holding and cell.arm.owner is None:
                turn = yield from cell.arm.take_up(holding)
                yield from self._placing.over_trays()
                yield cell.arm.go("inspect", cell.calibration.inspect_s)
                cell.arm.stand()
            else:
                yield seconds or cell.calibration.inspect_s
            return (yield from self._picture(tray))
        finally:
            cell.arm.leave(turn)

    def _picture(self, tray: TrayRecord) -> Steps[TrayView]:
        cell = self._cell
        deadline = cell.scheduler.now + cell.calibration.patience_s
        while (views := cell.sensors.trays()) is None:
            cell.evidence.note("camera")
            if cell.scheduler.now >= deadline:
                raise Aborted("there is no picture")
            yield cell.calibration.look_again_s
        for view in views:
            if view.tag == tray.tag:
                return view
        raise Aborted(f"{tray.handle} is not in the tray area")

    def _note_missing(self, tray: TrayRecord, kind: str) -> None:
        """A slot is vacant; if a part had been put there, it has been taken away."""
        if tray.expects(kind):
            self._cell.evidence.against("ACT", f"{kind} is missing from {tray.handle}")
        self._cell.memory.parts.pop(tray.vacate(kind), None)
