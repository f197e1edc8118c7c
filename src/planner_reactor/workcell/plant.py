"""What truly happens in the cell: belt, stack of trays, tray area, what the gripper holds, downstream, the
books.

The arm acts on it (`close_on_part`, `seat` …) and learns only what its own sensors feel; `sensors` look at
it; `disturbances` strike it. After every event `happened` compares the books with the containers, and lets
faults that wait for their moment try again. ("Plant": the controlled part of a control system.)

Zones: `arm_over_trays` is true while the arm works over the tray area (nobody reaches in there meanwhile);
`closing` is where the gripper is about to close, for the disturbance that strikes just then.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import count
from typing import Literal

from planner_reactor.runtime.scheduler import Scheduler
from planner_reactor.runtime.signals import Signal
from planner_reactor.trace import Trace
from planner_reactor.workcell.belt import Belt
from planner_reactor.workcell.calibration import Calibration
from planner_reactor.workcell.downstream import Downstream, Verdict
from planner_reactor.workcell.kit import KitSpec
from planner_reactor.workcell.ledger import Books, Finding
from planner_reactor.workcell.things import Part, Tray

Felt = Literal["seated", "jammed", "nothing", "empty"]
"""What the force sensor feels of a part pressed down: in a slot, on something, in the air; or no part."""


class Plant:
    """The truth about one cell."""

    def __init__(
        self, kit: KitSpec, calibration: Calibration, scheduler: Scheduler, *, trace: Trace | None = None
    ) -> None:
        self.kit = kit
        self.calibration = calibration
        self.scheduler = scheduler
        self.trace = trace
        self.books = Books(trace)
        self.findings: list[Finding] = []
        self.numbers = count(1)
        self.belt = Belt(kit, calibration, scheduler, self.numbers, arrived=self._part_arrived, left=self._part_left)
        self.downstream = Downstream(kit, calibration, scheduler)
        self.stack: list[Tray] = []
        self.area: dict[int, Tray] = {}
        self.gripper: Part | Tray | None = None
        self.arm_over_trays = False
        self.closing: tuple[float, float] | None = None
        self.dark_until = -1.0
        self.reached_in = -1e9  # when somebody else last reached into the tray area
        self.entered: Callable[[Part], None] = lambda part: None
        self.refilled = Signal("stack")
        self.attempts: list[Callable[[], bool]] = []
        self._refilling = False
        self._tray_numbers = count(1)
        self._started = False

    def start(self) -> None:
        """Stack the trays, load the belt, let the feeders run. Once."""
        if not self._started:
            self._started = True
            self._restock(self.kit.trays)
            self.belt.start()

    def balanced(self) -> bool:
        """Has every comparison of books and containers come out, so far and now?"""
        self._compare()
        return not self.findings

    @property
    def dark(self) -> bool:
        """Is the global camera without a picture?"""
        return self.scheduler.now < self.dark_until

    def close_on_part(self, u: float, y: float) -> bool:
        """Close the gripper at a place of the belt's frame; does it close on something?"""
        self.closing = (u, y)
        self._let_faults_strike()
        self.closing = None
        part = self.belt.under(u, y, self.calibration.grasp_tolerance) if self.gripper is None else None
        if part is None:
            return False
        self.belt.remove(part)
        self.belt.feeders[part.kind].taken(part)
        self.gripper = part
        self.books.part_moved(part, "gripper", source="belt", target="gripper")
        self.happened()
        return True

    def close_on_stack(self) -> bool:
        """Close the gripper on the topmost tray of the stack; does it close on something?"""
        if not self.stack or self.gripper is not None:
            return False
        tray = self.stack.pop()
        self.gripper = tray
        self.books.tray_moved(tray, "gripper")
        self._order_trays()
        self.happened()
        return True

    def close_on_tray(self, tag: str) -> tuple[float, float] | None:
        """Close the gripper on the handle of a tray, guided by the palm camera; gives where it stood, or
        None.
        """
        tray = next((tray for tray in self.area.values() if tray.tag == tag), None)
        if tray is None or self.gripper is not None:
            return None
        del self.area[tray.number]
        self.gripper = tray
        self.books.tray_moved(tray, "gripper")
        self.happened()
        return tray.pose

    def seat(self, pose: tuple[float, float], slot: str) -> Felt:
        """Press the part down where that slot of a tray at `pose` would be; if "seated", it has let go.

        Whatever already is in the slot is damaged: the place is not looked at.
        """
        part = self.gripper
        if not isinstance(part, Part):
            return "empty"
        tolerance = self.calibration.seat_tolerance
        for tray in self.area.values():
            if max(abs(tray.pose[0] - pose[0]), abs(tray.pose[1] - pose[1])) <= tolerance:
                return self._seat_in(tray, part, slot)
        return "nothing"

    def set_down_tray(self, pose: tuple[float, float]) -> bool:
        """Set the held tray down in the tray area; False if no tray is held, or one stands there."""
        tray = self.gripper
        if not isinstance(tray, Tray) or any(other.pose == pose for other in self.area.values()):
            return False
        self.gripper = None
        tray.pose = pose
        self.area[tray.number] = tray
        self.books.tray_moved(tray, "area")
        self.happened()
        return True

    def put_back(self) -> bool:
        """Put what is held back where it came from: a part onto the belt, a tray onto the stack."""
        thing = self.gripper
        if thing is None:
            return False
        self.gripper = None
        if isinstance(thing, Tray):
            self.stack.append(thing)
            self.books.tray_moved(thing, "stack", why="put back")
        else:
            self.belt.put(thing, self.belt.length / 3)
            self.books.part_moved(thing, "belt", source="gripper", target="belt", why="put back")
        self.happened()
        return True

    def discard(self, why: str) -> bool:
        """Drop what is held into the reject bin (a tray with all that is in it)."""
        thing = self.gripper
        if thing is None:
            return False
        self.gripper = None
        if isinstance(thing, Tray):
            self._empty(thing, "rejected", why)
            self.books.tray_moved(thing, "rejected", why=why)
        else:
            self.books.part_moved(thing, "rejected", source="gripper", target="rejected", why=why)
        self.happened()
        return True

    def hand_over(self) -> Verdict | None:
        """Push the held tray out to downstream, which judges it; None if no tray is held."""
        tray = self.gripper
        if not isinstance(tray, Tray):
            return None
        self.gripper = None
        verdict = self.downstream.take(tray)
        place: Literal["shipped", "rejected"] = "shipped" if verdict.accepted else "rejected"
        self._empty(tray, place, ", ".join(verdict.reasons))
        self.books.tray_moved(tray, place, why=", ".join(verdict.reasons))
        if self.trace is not None:
            faults = () if verdict.accepted else self.downstream.rejections[-1].faults
            self.trace.record(
                "kit_judged",
                tray=tray.number,
                accepted=verdict.accepted,
                reasons=verdict.reasons,
                faults=faults,
            )
        self.happened()
        return verdict

    def add_to_tray(self, tray: Tray, part: Part, why: str) -> None:
        """Somebody else puts a new part into a tray."""
        tray.slots[part.kind] = part
        self.books.part_arrived(part, "tray", at=f"{tray.tag}:{part.kind}", why=why)
        self.happened()

    def take_from_tray(self, tray: Tray, slot: str, why: str) -> None:
        """Somebody else takes a part out of a tray, and away."""
        part = tray.slots.pop(slot)
        self.books.part_moved(part, "taken", source=f"{tray.tag}:{slot}", target="taken", why=why)
        self.happened()

    def take_from_belt(self, part: Part, why: str) -> None:
        """Somebody takes a part off the belt, and away."""
        self.belt.remove(part)
        self.books.part_moved(part, "taken", source="belt", target="taken", why=why)
        self.happened()

    def drop_held_part(self, why: str) -> None:
        """The held part slips out of the gripper and is lost."""
        part, self.gripper = self.gripper, None
        assert isinstance(part, Part)
        self.books.part_moved(part, "taken", source="gripper", target="taken", why=why)
        self.happened()

    def happened(self) -> None:
        """After every event: compare the books, let faults that wait for their moment try."""
        self._compare()
        if self.attempts:
            self._let_faults_strike()

    def _part_arrived(self, part: Part) -> None:
        self.books.part_arrived(part, "belt", at="belt")
        self.happened()
        self.entered(part)

    def _part_left(self, part: Part) -> None:
        self.books.part_moved(part, "passed", source="belt", target="passed")
        self.happened()

    def _seat_in(self, tray: Tray, part: Part, slot: str) -> Felt:
        occupant = tray.slots.get(slot)
        if occupant is not None:
            occupant.damaged = True
            return "jammed"
        if part.kind != slot:
            return "jammed"
        self.gripper = None
        tray.slots[slot] = part
        self.books.part_moved(part, "tray", source="gripper", target=f"{tray.tag}:{slot}")
        self.happened()
        return "seated"

    def _empty(self, tray: Tray, place: Literal["shipped", "rejected"], why: str) -> None:
        for slot, part in tray.slots.items():
            self.books.part_moved(part, place, source=f"{tray.tag}:{slot}", target=place, why=why)
        tray.slots = {}

    def _restock(self, trays: int) -> None:
        self._refilling = False
        for _ in range(trays):
            tray = Tray(next(self._tray_numbers))
            self.stack.insert(0, tray)
            self.books.tray_arrived(tray)
        self.happened()
        self.refilled.fire()

    def _order_trays(self) -> None:
        if len(self.stack) < self.calibration.refill_below and not self._refilling:
            self._refilling = True
            self.scheduler.call_after(self.calibration.refill_s, lambda: self._restock(self.calibration.refill_count))

    def _let_faults_strike(self) -> None:
        waiting, self.attempts = self.attempts, []
        self.attempts = [attempt for attempt in waiting if not attempt()] + self.attempts

    def _compare(self) -> None:
        gripper = self.gripper
        in_trays = 0
        for tray in self.stack:
            in_trays += len(tray.slots)
        for tray in self.area.values():
            in_trays += len(tray.slots)
        held = held_trays = 0
        if isinstance(gripper, Tray):
            in_trays, held_trays = in_trays + len(gripper.slots), 1
        elif gripper is not None:
            held = 1
        counted = (self.belt.count, held, in_trays, len(self.stack), held_trays, len(self.area))
        for message in self.books.differences(counted):
            self.findings.append(Finding("ledger", self.scheduler.now, message))
            if self.trace is not None:
                self.trace.record("violation", law="ledger", message=message)
