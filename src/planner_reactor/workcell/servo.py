"""Picking by a derived reaction: the cell behind the ports of a guarded move environment (X §5.2; AM relaxed).

`Track # Get` of `kitting.itl` is written by hand, in Python. Here the cell offers no more than an interface: where the
camera sees the part that is followed (s1), where the gripper is (j), whether something is between its fingers (t), and
a command that moves it by an increment (r), all along the belt, in the belt's frame: the arm moves with the belt, as in
every motion of this cell, and across it keeps to the part. With it come two basic processes: `Over[x]` waits for its
turn and goes over the part where it was last seen; `Close[x]` closes the gripper. What is done in between is found by
the planner from guarded_move.rsl.

A gripper that missed stays where it is, and the camera goes on following, so that the next try begins there. What
nobody closes within `PATIENCE_S` is given up: a reaction that is withdrawn in between cannot keep the arm.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping

from planner_reactor.rs.given import with_values
from planner_reactor.rs.parser import parse_program
from planner_reactor.runtime import Executer, Host, Root
from planner_reactor.runtime.scheduler import Timer
from planner_reactor.runtime.signals import Aborted
from planner_reactor.workcell.arm import FIXED, OPPORTUNE, Turn
from planner_reactor.workcell.arm import TRAY as TRAY_RANK
from planner_reactor.workcell.cell import TRAY, Cell, Steps
from planner_reactor.workcell.memory import PartRecord, TrayRecord
from planner_reactor.workcell.sensors import TrayView

PORTS = ("s1", "j", "t", "r")
TIMING: Mapping[str, float] = {
    "gl": 0.02, "tl": 0.05, "gj": 0.01, "tj": 0.02, "gto": 0.01, "tto": 0.05, "gmv": 0.1, "tmv": 0.005,
    "t0": 5.0, "ts0": 0.05, "ts1": 0.02, "tt0": 0.05, "tt1": 0.02, "gm": 0.02, "tm": 0.005, "eps": 0.1,
}  # fmt: skip
"""Seconds of the interface (and what guarded_move.rsl leaves open beside: how seldom parts slide, and how far)."""

INTERFACE = """
sense1 = (Eye<v> ; Delay[gl]) :; (STREAM[s1, v] # Delay[tl])
joint = (Where<v> ; Delay[gj]) :; (STREAM[j, v] # Delay[tj])
touch = (Felt<v> ; Delay[gto]) :; (STREAM[t, v] # Delay[tto])
move = IN[r]<d> :; Step[d]
settled = OUT[t, 1] # Delay[tto]
"""
GLANCE_S = 0.05
STRIDE_M = 0.08
"""A command goes so far at most."""
SHORTEST_S = 0.1
TOLERANCE_M = 0.004
"""What the gripper is off by, and need not be moved for: the camera is no more exact."""

STACK = (0.0, 0.0)
"""Where the topmost tray is: the arm goes to it, and it does not move."""

PATIENCE_S = 12.0
"""More than a reaction takes from Over to Close."""


class Servo:
    """The interface, and who has it: one part at a time, that of the process whose turn it is."""

    def __init__(self, host: Host, cell: Cell) -> None:
        self._cell = cell
        self._turn: Turn | None = None
        self._record: PartRecord | TrayRecord | None = None
        self._moves = False
        self._hand: tuple[float, float] | None = None  # over the belt, in its frame
        self._roots: list[Root] = []
        self._given_up: Timer | None = None
        self._executer = Executer(
            with_values(parse_program(INTERFACE, file="<interface>"), dict(TIMING)),
            scheduler=cell.scheduler,
            host=self._leaves(),
        )
        host.ports = self._executer.share(*PORTS)
        wait = cell.wait_s + 3 * cell.calibration.pick_and_place_s
        host.process(window=(0.0, wait), name="Over")(self.over)
        host.process(window=(0.0, 2 * cell.calibration.pick_and_place_s), name="Close")(self.close)

    # -- the interface

    def _leaves(self) -> Host:
        made = Host("interface")
        made.process(results=("v",), limit=10 * PATIENCE_S, name="Eye")(self._eye)
        made.process(results=("v",), limit=10 * PATIENCE_S, name="Where")(self._where)
        made.process(results=("v",), limit=10 * PATIENCE_S, name="Felt")(self._felt)
        made.process(window=(0.0, 2.0), name="Step")(self._step)
        return made

    def _eye(self) -> Iterator[float]:
        while (pose := self._pose()) is None:
            yield GLANCE_S
        return pose[0]  # type: ignore[return-value]  # what a generator returns are its results

    def _pose(self) -> tuple[float, float] | None:
        if isinstance(self._record, TrayRecord):
            return STACK
        follower = self._record.follower if self._record is not None else None
        return follower.pose() if follower is not None and self._cell.sensors.has_picture() else None

    def _where(self) -> Iterator[float]:
        while self._moves or self._hand is None:
            yield GLANCE_S / 5
        return self._hand[0]  # type: ignore[return-value]

    def _felt(self) -> Iterator[float]:
        while not self._feels():
            yield GLANCE_S
        return 1.0  # type: ignore[return-value]

    def _feels(self) -> bool:
        if self._hand is None or self._moves:
            return False
        return isinstance(self._record, TrayRecord) or self._cell.sensors.between_fingers(*self._hand)

    def _step(self, d: float) -> Iterator[float]:
        """Along the belt by d; across it the arm keeps to the part by itself."""
        pose, hand = self._pose(), self._hand
        if pose is None or hand is None:
            return
        step = max(-STRIDE_M, min(STRIDE_M, d))
        distance = max(abs(step), abs(pose[1] - hand[1]))
        if distance < TOLERANCE_M:
            return
        self._moves = True
        try:
            yield self._cell.arm.go("follow", self._travel(distance))
        finally:
            self._moves = False
        self._hand = (hand[0] + step, pose[1])

    def _travel(self, distance: float) -> float:
        """`chase_s` is what it takes to go after a part that slid away so far and to close on it."""
        calibration = self._cell.calibration
        return max(SHORTEST_S, (calibration.chase_s - calibration.close_s) * abs(distance) / STRIDE_M)

    # -- the processes

    def over(self, x: str) -> Steps[None]:
        """Over[x]: wait for the turn, and go over the part, where it was last seen, or over the stack of trays.

        What is held or placed already needs no reaching: that is told as a contact, while nobody else waits for one.
        """
        cell = self._cell
        if self._is_done(x):
            while self._turn is not None:
                yield GLANCE_S
            self._executer.start("settled")
            return
        record = cell.memory.trays.get(x) or cell.memory.parts.get(x)
        if record is None or record.state not in ("belt", "stack"):
            raise Aborted(f"{x} is gone")
        if self._record is record:
            return
        turn = self._enter(record)
        try:
            yield from cell.arm.wait_for(turn, cell.scheduler.now + cell.wait_s)
            if isinstance(record, PartRecord) and not cell.memory.rides(record, cell.scheduler.now + cell.reach_s):
                cell.memory.drop(record)
                raise Aborted(f"{x} has left the belt before its turn came")
            yield cell.arm.go("reach", self._approach(record))
            cell.arm.stand()
        except BaseException:
            cell.arm.leave(turn)
            raise
        self._take(turn, record)

    def _enter(self, record: PartRecord | TrayRecord) -> Turn:
        cell = self._cell
        if isinstance(record, TrayRecord):
            return cell.arm.enter(TRAY, TRAY_RANK)
        rank = OPPORTUNE if record.opportunistic else FIXED + cell.kit.priority[record.kind]
        turn = cell.arm.enter(record.kind, rank)
        turn.ready = True
        return turn

    def _approach(self, record: PartRecord | TrayRecord) -> float:
        calibration = self._cell.calibration
        return calibration.stack_s if isinstance(record, TrayRecord) else calibration.reach_s

    def _take(self, turn: Turn, record: PartRecord | TrayRecord) -> None:
        self._turn, self._record, self._hand = turn, record, STACK
        if isinstance(record, PartRecord):
            self._hand = (record.u, record.y)
            record.follower = self._cell.sensors.follow(record.u, record.y)
        self._serve()

    def _serve(self) -> None:
        """The interface is there for the part that is followed, for as long as somebody may want it."""
        self._quiet()
        self._roots = [self._executer.start(name) for name in ("sense1", "joint", "touch", "move")]
        self._given_up = self._cell.scheduler.call_after(PATIENCE_S, self._release)

    def locating(self, locate: Callable[[str], Steps[str]]) -> Callable[[str], Steps[str]]:
        """Locate[d]<x>, with a part that the camera follows already found at once."""

        def located(d: str) -> Steps[str]:
            record = self._record
            if isinstance(record, PartRecord) and d in (record.kind, record.variant) and self._pose() is not None:
                return record.handle
            return (yield from locate(d))

        return located

    def close(self, x: str) -> Steps[None]:
        """Close[x]: close where the gripper is."""
        if self._is_done(x):
            return
        record, hand = self._record, self._hand
        if record is None or record.handle != x or hand is None:
            raise Aborted(f"the gripper is not over {x}")
        self._quiet()
        missed = False
        try:
            yield self._cell.arm.go("close", self._cell.calibration.close_s)
            if isinstance(record, TrayRecord):
                self._take_tray(record)
            else:
                missed = not self._cell.arm.close_on_part(*hand)
                yield from self._missed(record) if missed else self._check(record)
            self._cell.arm.stand()
        finally:
            if missed and self._pose() is not None:
                self._serve()
            else:
                self._release()

    def _take_tray(self, tray: TrayRecord) -> None:
        cell = self._cell
        if not cell.arm.close_on_stack():
            raise Aborted("the stack is empty")
        view = cell.sensors.palm()
        assert isinstance(view, TrayView)
        cell.memory.tray_taken(tray, view.tag)
        tray.came_filled = set(view.filled)
        if view.filled:
            cell.evidence.against("AF", f"a tray came with {len(view.filled)} filled slots")

    def _missed(self, record: PartRecord) -> Steps[None]:
        """It slid away: evidence of motion; where the camera sees it now is remembered, if it does."""
        cell, pose = self._cell, self._pose()
        cell.arm.stand()
        if cell.memory.rides(record, cell.scheduler.now):
            cell.evidence.against("AM", f"no {record.kind} where one was felt")
        if pose is None:
            cell.memory.drop(record)
        else:
            record.u, record.y = pose
        yield 0.0
        raise Aborted(f"no {record.kind} where one was felt")

    def _check(self, record: PartRecord) -> Steps[None]:
        cell = self._cell
        view = cell.in_palm(record)
        if view.kind != record.kind:
            yield cell.arm.go("put back", cell.calibration.put_back_s)
            cell.arm.put_back()
            cell.memory.let_go()
            raise Aborted(f"{record.handle} is no {record.kind}")

    # -- who has it

    def _is_done(self, x: str) -> bool:
        """Is it held, where it was to go, or has it left?"""
        memory = self._cell.memory
        part, tray = memory.parts.get(x), memory.trays.get(x)
        if memory.held == x or (part is None and tray is None):
            return memory.held == x or (x.startswith(TRAY) and memory.was_given(x))
        return (part is not None and part.state == "placed") or (tray is not None and tray.state == "area")

    def _quiet(self) -> None:
        for root in self._roots:
            self._executer.kill(root)
        self._roots = []
        if self._given_up is not None:
            self._given_up.cancel()
            self._given_up = None

    def _release(self) -> None:
        """Whoever has the interface has it no longer."""
        turn, record = self._turn, self._record
        self._turn = self._record = None
        self._quiet()
        self._hand = None
        if isinstance(record, PartRecord):
            record.follower = None
        if turn is not None:
            self._cell.arm.leave(turn)
