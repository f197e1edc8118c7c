"""Basic processes that put things in place: FindGetInsert, Insert, Move, Deliver.

`Insert` trusts the remembered pose of the tray (ADT) and that the slot is vacant (AF, ACP): it presses the
part down without looking, feels whether it is seated, and drops a part that is not into the reject bin, so
that the arm is empty for the next attempt. Retrying is idempotent by the cell's own record: a slot known to
be filled is not filled again (a part held for it goes back), and a tray that has left needs nothing more.
"""

from __future__ import annotations

from planner_reactor.runtime.signals import Aborted
from planner_reactor.workcell.arm import DELIVER
from planner_reactor.workcell.cell import TRAY, Cell, Steps
from planner_reactor.workcell.memory import TrayRecord
from planner_reactor.workcell.picking import Picking

LOCATIONS = ("trayarea", "belt", "stack", "rejectbin")


class Placing:
    """The processes that leave the gripper empty."""

    def __init__(self, cell: Cell, picking: Picking) -> None:
        self._cell = cell
        self._picking = picking

    def find_get_insert(self, m: str, t: str) -> Steps[None]:
        """FindGetInsert[m,t]: one hard-wired instruction: take any part of that kind and press it into its
        slot.
        """
        cell = self._cell
        kind = cell.kind(m)
        tray = cell.tray(t)
        if tray is None or tray.done(kind):
            return
        turn = cell.arm.enter(m, cell.rank(kind))
        try:
            handle = yield from self._picking.take(turn, m)
            if tray.done(kind) or tray.state == "left":
                yield from self._give_back()
            else:
                yield from self._press_in(handle, tray)
            cell.arm.retreat()
        finally:
            cell.arm.leave(turn)

    def insert(self, x: str, t: str) -> Steps[None]:
        """Insert[x,t]: put the held part into the slot of its kind."""
        cell = self._cell
        tray = cell.tray(t)
        if tray is not None and x in tray.contents.values():
            return
        turn = yield from cell.arm.take_up(x)
        try:
            part = cell.memory.parts.get(x)
            if part is None:
                raise Aborted(f"{x} is no part")
            if tray is None or tray.state == "left" or tray.done(part.kind):
                yield from self._give_back()
            elif tray.state != "area":
                raise Aborted(f"{t} does not stand in the tray area")
            else:
                yield from self._press_in(x, tray)
            cell.arm.retreat()
        finally:
            cell.arm.leave(turn)

    def move(self, x: str, to: str) -> Steps[None]:
        """Move[x,l]: put what is held at a place: a tray into the tray area, anything onto belt, stack or
        reject bin.
        """
        cell = self._cell
        if to not in LOCATIONS:
            raise Aborted(f"no place is called {to}")
        tray = cell.memory.trays.get(x)
        if to == "trayarea" and x.startswith(TRAY) and (tray is None or tray.state == "area"):
            cell.tray(x)
            return
        if to in ("belt", "stack"):
            yield from self._picking.put_back(x)
            return
        turn = yield from cell.arm.take_up(x)
        try:
            if to == "rejectbin":
                yield from self.discard("moved there")
            elif tray is None:
                raise Aborted(f"{x} is no tray")
            else:
                yield from self._set_down(tray)
            cell.arm.stand()
        finally:
            cell.arm.leave(turn)

    def deliver(self, t: str) -> Steps[None]:
        """Deliver[t]: push the tray out to downstream, ready or not. Aborts if it is refused (then it is
        lost).
        """
        cell = self._cell
        tray = cell.tray(t)
        if tray is None:
            return
        held = cell.memory.held == t
        turn = (yield from cell.arm.take_up(t)) if held else cell.arm.enter(TRAY, DELIVER)
        try:
            if not held:
                yield from cell.arm.wait_for(turn, cell.scheduler.now + cell.wait_s)
                if tray.state == "left":
                    return
                yield from self._grip(tray)
            yield cell.arm.go("push out", cell.calibration.push_out_s)
            verdict = cell.arm.hand_over()
            cell.arm.stand()
            cell.memory.tray_left(tray)
        finally:
            cell.arm.leave(turn)
        if verdict is not None and "refused" in verdict.reasons:
            cell.evidence.against("ADD", "downstream refused a tray")
            raise Aborted("downstream refused the tray")

    def discard(self, why: str) -> Steps[None]:
        """Drop what the arm holds into the reject bin."""
        cell = self._cell
        yield cell.arm.go("discard", cell.calibration.discard_s)
        cell.arm.discard(why)
        if cell.memory.held in cell.memory.trays:
            cell.memory.tray_left(cell.memory.trays[cell.memory.held])
        cell.memory.let_go()

    def over_trays(self) -> Steps[None]:
        """Bring what the arm holds over the tray area."""
        cell = self._cell
        if not cell.arm.is_over_trays:
            yield cell.arm.go("carry", cell.calibration.carry_s)
            cell.arm.over_trays()

    def _press_in(self, handle: str, tray: TrayRecord) -> Steps[None]:
        cell = self._cell
        part = cell.memory.parts[handle]
        yield from self.over_trays()
        yield cell.arm.go("insert", cell.calibration.insert_s)
        felt = cell.arm.seat(tray.pose, part.kind)
        if felt == "seated":
            part.state = "placed"
            tray.fill(part.kind, handle)
            cell.memory.held = ""
            return
        if felt == "empty":
            cell.arm.feel_empty()
            raise Aborted(f"{handle} was lost on the way")
        self._look_why(tray, part.kind)
        yield from self.discard(f"not seated: {felt}")
        raise Aborted(f"{part.kind} not seated in {tray.handle}: {felt}")

    def _give_back(self) -> Steps[None]:
        yield self._cell.arm.go("put back", self._cell.calibration.put_back_s)
        self._picking.put_down()

    def _look_why(self, tray: TrayRecord, slot: str) -> None:
        """A part would not go in: does the camera see the tray elsewhere, or the slot filled?"""
        cell = self._cell
        for view in cell.sensors.trays() or ():
            if view.tag != tray.tag:
                continue
            if view.pose != tray.pose:
                cell.evidence.against("ADT", f"{tray.handle} is not where it was put")
            elif slot in view.filled:
                cell.memory.note(tray, slot)
                cell.evidence.against(tray.blames(slot), f"slot {slot} of {tray.handle} was filled already")

    def _grip(self, tray: TrayRecord) -> Steps[None]:
        """Take a standing tray by its handle, guided by the palm camera."""
        cell = self._cell
        if tray.state != "area":
            raise Aborted(f"{tray.handle} does not stand in the tray area")
        cell.arm.over_trays()
        yield cell.arm.go("grip tray", cell.calibration.grip_tray_s)
        pose = cell.arm.close_on_tray(tray.tag)
        if pose is None:
            raise Aborted(f"{tray.handle} is nowhere in the tray area")
        if pose != tray.pose:
            cell.evidence.against("ADT", f"{tray.handle} is not where it was put")
        tray.state = "held"
        cell.memory.held = tray.handle

    def _set_down(self, tray: TrayRecord) -> Steps[None]:
        cell = self._cell
        place = cell.free_place()
        if place < 0:
            raise Aborted("no place is free in the tray area")
        tray.place = place
        yield cell.arm.go("set down", cell.calibration.set_down_s)
        pose = cell.place_pose(place)
        if not cell.arm.set_down_tray(pose):
            raise Aborted(f"{tray.handle} could not be set down")
        tray.state, tray.pose = "area", pose
        cell.memory.held = ""
