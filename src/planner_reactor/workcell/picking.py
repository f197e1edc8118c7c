"""Basic processes that find and take parts and trays: Find, Get, Locate, Track, PutBack.

`Find` trusts one picture (AM): it reaches for the place where the part was, and aborts if the gripper closes
on nothing. `Locate`, then `Track # Get`, does not: the camera keeps the part in view and the arm follows it.
Each checks with the palm camera what it holds, and puts back what it was not asked for. When the one tray
that stands there is known to have the part already, that part is found, and nothing is done: retrying is
idempotent. A `tray` comes from the stack, or, when the tray area is full, it is the tray that stands there:
work left over by a withdrawn reaction is resumed.
"""

from __future__ import annotations

from planner_reactor.runtime.signals import Aborted
from planner_reactor.workcell.arm import FIXED, OPPORTUNE, Turn
from planner_reactor.workcell.arm import TRAY as TRAY_RANK
from planner_reactor.workcell.cell import TRAY, Cell, Steps
from planner_reactor.workcell.memory import PartRecord, TrayRecord
from planner_reactor.workcell.sensors import TrayView

TRIES = 3
"""How often a process tries by itself: after a wrong part, or one that moved while it was followed."""


class Picking:
    """The processes that take something into the gripper, and the one that puts it back."""

    def __init__(self, cell: Cell) -> None:
        self._cell = cell

    def find(self, d: str) -> Steps[str]:
        """Find[d]<x>: locate an instance of a kind or variant and take it; x is its handle."""
        if d == TRAY:
            return (yield from self._find_tray())
        cell = self._cell
        kind = cell.kind(d)
        if settled := cell.memory.settled(kind):
            return settled
        turn = cell.arm.enter(d, cell.rank(kind))
        try:
            handle = yield from self.take(turn, d)
            cell.arm.stand()
            return handle
        finally:
            cell.arm.leave(turn)

    def take(self, turn: Turn, wanted: str) -> Steps[str]:
        """Wait for the turn, take a picture, take the part; returns its handle. Aborts if it is not there."""
        cell = self._cell
        deadline = cell.scheduler.now + cell.wait_s
        for _ in range(TRIES):
            record = yield from self._choose(turn, wanted, deadline)
            yield cell.arm.go("reach", cell.calibration.reach_s + cell.calibration.close_s)
            if not cell.arm.close_on_part(record.u, record.y):
                self._missed(record)
                cell.memory.drop(record)
                raise Aborted(f"no {record.kind} where one was seen")
            if self._is(record, wanted):
                return record.handle
            yield cell.arm.go("put back", cell.calibration.put_back_s)
            self.put_down()
        raise Aborted(f"no {wanted} among {TRIES} parts")

    def locate(self, d: str) -> Steps[str]:
        """Locate[d]<x>: see an instance of a kind or variant, without touching it; x is its handle."""
        cell = self._cell
        if d == TRAY:
            yield cell.calibration.look_s
            tray = yield from self._standing_or_stacked()
            return tray.handle
        kind = cell.kind(d)
        if settled := cell.memory.settled(kind):
            return settled
        rank = cell.rank(kind)
        turn = cell.arm.enter(d, rank, waits_only=True) if rank >= FIXED else None
        try:
            record = yield from self._sight(d)
            record.claimed_until = cell.scheduler.now + cell.wait_s
            record.opportunistic = rank == OPPORTUNE
            return record.handle
        finally:
            cell.arm.leave(turn)

    def track(self, x: str) -> Steps[None]:
        """Track[x]: keep a located part in view for as long as it runs; ends only by being disabled."""
        cell = self._cell
        record = cell.memory.parts.get(x)
        if record is not None and record.state == "belt":
            record.follower = cell.sensors.follow(record.u, record.y)
        try:
            while True:
                yield cell.wait_s
        finally:
            if record is not None:
                record.follower = None

    def get(self, x: str) -> Steps[None]:
        """Get[x]: take a located part (where it is now, while it is tracked) or the tray on top of the stack."""
        cell = self._cell
        if cell.memory.held == x or self._is_placed(x):
            return
        if x in cell.memory.trays:
            yield from self._get_tray(cell.memory.trays[x])
            return
        record = cell.memory.parts.get(x)
        if record is None:
            raise Aborted(f"{x} is gone")
        turn = cell.arm.enter(record.kind, OPPORTUNE if record.opportunistic else self._fixed(record.kind))
        turn.ready = True
        try:
            yield from cell.arm.wait_for(turn, cell.scheduler.now + cell.wait_s)
            if not cell.memory.rides(record, cell.scheduler.now + cell.reach_s):
                cell.memory.drop(record)
                raise Aborted(f"{x} has left the belt before its turn came")
            yield cell.arm.go("reach", cell.calibration.reach_s + cell.calibration.close_s)
            yield from self._close_following(record)
            cell.arm.stand()
        finally:
            cell.arm.leave(turn)

    def put_back(self, x: str) -> Steps[None]:
        """PutBack[x]: put what is held back where it came from. What is not held needs none."""
        cell = self._cell
        if cell.memory.held != x:
            return
        turn = yield from cell.arm.take_up(x)
        try:
            yield cell.arm.go("put back", cell.calibration.put_back_s)
            self.put_down()
            cell.arm.stand()
        finally:
            cell.arm.leave(turn)

    def put_down(self) -> None:
        """The gripper puts back what it holds: a part will be seen again as something new, a tray is on the
        stack.
        """
        cell = self._cell
        cell.arm.put_back()
        cell.memory.let_go()

    def _choose(self, turn: Turn, wanted: str, deadline: float) -> Steps[PartRecord]:
        cell = self._cell
        while True:
            yield from cell.arm.wait_for(turn, deadline)
            yield cell.arm.go("look", cell.calibration.look_s)
            record = cell.spot(wanted)
            if record is not None:
                if turn.rank >= FIXED:
                    cell.evidence.supports("AO")
                return record
            if turn.rank == OPPORTUNE:
                raise Aborted(f"the {wanted} that had come is gone")
            cell.arm.give_way(turn)

    def _sight(self, wanted: str) -> Steps[PartRecord]:
        cell = self._cell
        deadline = cell.scheduler.now + cell.wait_s
        arrivals = cell.arrivals[cell.kind(wanted)]
        yield cell.calibration.look_s
        while (record := cell.spot(wanted, patient=True)) is None:
            if cell.scheduler.now >= deadline:
                raise Aborted(f"no {wanted} came in time")
            yield arrivals.within(cell.calibration.look_again_s)
        return record

    def _close_following(self, record: PartRecord) -> Steps[None]:
        """Close where the part is; one that is followed and slips away is chased."""
        cell = self._cell
        for attempt in range(TRIES):
            if attempt:
                yield cell.arm.go("chase", cell.calibration.chase_s)
            follower = record.follower if cell.sensors.has_picture() else None
            pose = follower.pose() if follower is not None else (record.u, record.y)
            if pose is None or record.state != "belt":
                break
            if self._has_moved(record, pose):
                cell.evidence.against("AM", f"{record.kind} seen to move")
            record.u, record.y = pose
            if cell.arm.close_on_part(*pose):
                if self._is(record, record.kind):
                    return
                yield cell.arm.go("put back", cell.calibration.put_back_s)
                self.put_down()
                raise Aborted(f"{record.handle} is no {record.kind}")
            self._missed(record)
            if follower is None:
                break
        cell.memory.drop(record)
        raise Aborted(f"{record.handle} is gone")

    def _missed(self, record: PartRecord) -> None:
        """The gripper closed on nothing: evidence of motion, unless the part had to leave with the belt."""
        cell = self._cell
        if cell.memory.rides(record, cell.scheduler.now):
            cell.evidence.against("AM", f"no {record.kind} where one was seen")

    def _has_moved(self, record: PartRecord, pose: tuple[float, float]) -> bool:
        tolerance = self._cell.calibration.seen_tolerance
        return max(abs(pose[0] - record.u), abs(pose[1] - record.y)) > tolerance

    def _is(self, record: PartRecord, wanted: str) -> bool:
        """Look at what was taken, and remember it; is it what was wanted?"""
        cell = self._cell
        view = cell.in_palm(record)
        if view.variant == cell.part(view.kind).wanted:
            cell.evidence.supports("AS")
        else:
            cell.evidence.against("AS", f"a {view.kind} is {view.variant}")
        if wanted in (view.kind, view.variant):
            cell.evidence.supports("AM")
            return True
        return False

    def _fixed(self, kind: str) -> int:
        return FIXED + self._cell.kit.priority[kind]

    def _is_placed(self, handle: str) -> bool:
        """Is it where it was to go, or has it left with its tray?"""
        memory = self._cell.memory
        part, tray = memory.parts.get(handle), memory.trays.get(handle)
        if part is None and tray is None:
            return handle.startswith(TRAY) and memory.was_given(handle)
        return (part is not None and part.state == "placed") or (tray is not None and tray.state == "area")

    def _find_tray(self) -> Steps[str]:
        tray = yield from self._standing_or_stacked()
        if tray.state == "stack":
            yield from self._get_tray(tray)
        return tray.handle

    def _standing_or_stacked(self) -> Steps[TrayRecord]:
        """The tray to work on: one that stands there when there is no place for another, else the topmost."""
        cell = self._cell
        deadline = cell.scheduler.now + cell.wait_s
        while True:
            if cell.free_place() < 0:
                return next(tray for tray in cell.memory.trays.values() if tray.state == "area")
            if cell.sensors.stack_height() > 0:
                return cell.memory.new_tray()
            if not (yield cell.refilled.within(deadline - cell.scheduler.now)):
                raise Aborted("no tray came in time")

    def _get_tray(self, tray: TrayRecord) -> Steps[None]:
        cell = self._cell
        turn = cell.arm.enter(TRAY, TRAY_RANK)
        try:
            yield from cell.arm.wait_for(turn, cell.scheduler.now + cell.wait_s)
            yield cell.arm.go("reach stack", cell.calibration.stack_s + cell.calibration.close_s)
            if not cell.arm.close_on_stack():
                raise Aborted("the stack is empty")
            view = cell.sensors.palm()
            assert isinstance(view, TrayView)
            self._remember_tray(tray, view)
            cell.arm.stand()
        finally:
            cell.arm.leave(turn)

    def _remember_tray(self, tray: TrayRecord, view: TrayView) -> None:
        """The palm camera reads the tag, and sees whether the tray is empty."""
        cell = self._cell
        cell.memory.tray_taken(tray, view.tag)
        tray.came_filled = set(view.filled)
        if view.filled:
            cell.evidence.against("AF", f"a tray came with {len(view.filled)} filled slots")
        else:
            cell.evidence.supports("AF")
