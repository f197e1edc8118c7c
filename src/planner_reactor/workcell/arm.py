"""One arm, who may use it, and what it holds.

A process that wants the empty arm enters a `Turn` and waits until it is granted; a process that goes on with
what the arm holds takes it up (`take_up`). While assumption AO holds, turns are served in the kit's placing
order: a turn whose part is not yet in sight keeps later ones back. A turn entered after its arrival was
awaited (AO relaxed) is *opportunistic*: served in order of arrival, before those, and keeping nobody back.

`leave` is called when a process ends, however it ends: no command stays live, and what is still held must be
taken up within `reconcile_s`, or the arm puts it away by itself. So a reaction that is withdrawn between
finding and inserting cannot block the arm for ever.
"""

from __future__ import annotations

from collections.abc import Callable, Generator
from dataclasses import dataclass, field
from typing import Any

from planner_reactor.runtime.scheduler import Scheduler, Timer
from planner_reactor.runtime.signals import Aborted, Signal
from planner_reactor.workcell.calibration import Calibration
from planner_reactor.workcell.downstream import Verdict
from planner_reactor.workcell.memory import Memory
from planner_reactor.workcell.plant import Felt, Plant

DELIVER, TRAY, OPPORTUNE, FIXED = range(4)
"""Ranks of turns, first served first; a fixed turn adds its place in the kit's order."""

OVER_TRAYS = ("insert", "inspect", "grip tray")
"""Commands that keep the arm over the tray area; any other takes it away."""


@dataclass(slots=True, eq=False)
class Turn:
    """A process that wants the arm, or has it. `ready`: what it wants is in sight; `waits_only`: never
    served.
    """

    wanted: str
    rank: int
    number: int
    since: float
    ready: bool
    waits_only: bool = False
    granted: Signal = field(default_factory=lambda: Signal("arm granted"))


@dataclass(slots=True)
class Commands:
    """The commands ledger: sent = done + abandoned + live."""

    sent: int = 0
    done: int = 0
    abandoned: int = 0


class Arm:
    """The arm as a resource, and its motions. `in_sight(wanted)` says whether a part can be seen and reached."""

    def __init__(self, plant: Plant, memory: Memory, *, in_sight: Callable[[str], bool]) -> None:
        self.owner: Turn | None = None
        self.queue: list[Turn] = []
        self.live = ""
        self.commands = Commands()
        self.released = Signal("arm released")
        self._plant = plant
        self._scheduler: Scheduler = plant.scheduler
        self._calibration: Calibration = plant.calibration
        self._memory = memory
        self._in_sight = in_sight
        self._random = plant.scheduler.random("arm")
        self._numbers = 0
        self._granting: Timer | None = None
        self._watching: Timer | None = None
        self._reconcile: Timer | None = None
        self.slipped: Callable[[], None] = lambda: None
        self._busy_until = 0.0
        self._done_at = 0.0

    def enter(self, wanted: str, rank: int, *, waits_only: bool = False) -> Turn:
        """Queue for the empty arm; for `rank` FIXED and above it counts as ready only when its part is in
        sight.
        """
        self._numbers += 1
        ready = rank < OPPORTUNE or self._in_sight(wanted)
        turn = Turn(wanted, rank, self._numbers, self._scheduler.now, ready and not waits_only, waits_only)
        self.queue.append(turn)
        self._arrange()
        if not turn.ready:
            self._watch()
        return turn

    def wait_for(self, turn: Turn, deadline: float) -> Generator[Any, Any, None]:
        """Wait until the turn has the arm; aborts at the deadline."""
        while self.owner is not turn:
            left = deadline - self._scheduler.now
            if left <= 0 or not (yield turn.granted.within(left)):
                raise Aborted(f"no {turn.wanted} and no turn came in time")

    def give_way(self, turn: Turn) -> None:
        """Let go of the empty arm, but stay in the queue: nothing was in sight after all."""
        self._settle_command()
        turn.ready = False
        turn.since = self._scheduler.now
        self.queue.append(turn)
        self.owner = None
        self._arrange()
        self._watch()

    def leave(self, turn: Turn | None) -> None:
        """The process is over, however it ended: stop, let go of the turn, see to what is held."""
        if turn is None:
            return
        if turn in self.queue:
            self.queue.remove(turn)
            self._arrange()
        if self.owner is not turn:
            return
        if self.live and self._scheduler.now < self._done_at:
            self.live = ""
            self.commands.abandoned += 1
        self._settle_command()
        self.owner = None
        if self.gripped:
            self._expect_someone()
        elif self._memory.held:
            self.feel_empty()
        elif self._scheduler.now >= self._busy_until:
            self._clear_zone()
        self._arrange()
        self.released.fire()

    def take_up(self, handle: str) -> Generator[Any, Any, Turn]:
        """Go on with what the arm holds; aborts if it does not hold that (any more)."""
        while self._memory.held == handle and self.owner is not None:
            yield self.released
        if self._memory.held != handle:
            raise Aborted(f"{handle} is not held")
        self._numbers += 1
        self.owner = Turn(handle, DELIVER, self._numbers, self._scheduler.now, ready=True)
        if self._reconcile is not None:
            self._reconcile.cancel()
            self._reconcile = None
        return self.owner

    def noticed(self, kind: str) -> None:
        """A part of this kind came into sight."""
        changed = False
        for turn in self.queue:
            if not turn.ready and not turn.waits_only and self._plant.kit.kind_of.get(turn.wanted) == kind:
                turn.ready = self._in_sight(turn.wanted)
                changed = changed or turn.ready
        if changed:
            self._arrange()

    def starved(self) -> str:
        """What is awaited for too long while another part waits for its turn (AO does not hold), or ''."""
        late = self._scheduler.now - self._calibration.starved_s
        fixed = [turn for turn in self.queue if turn.rank >= FIXED]
        for turn in fixed:
            if not turn.ready and turn.since <= late and any(t.ready and t.rank > turn.rank for t in fixed):
                return turn.wanted
        return ""

    @property
    def gripped(self) -> bool:
        """The gripper's own sensor: is it closed on something?"""
        return self._plant.gripper is not None

    def feel_empty(self) -> None:
        """Something was thought to be held, and the gripper is empty: forget it, and say so."""
        self._memory.let_go()
        self.slipped()

    @property
    def ahead(self) -> int:
        """How many have the arm or wait for it."""
        return len(self.queue) + (self.owner is not None or self.gripped)

    @property
    def reconciling(self) -> bool:
        """Is it waiting for somebody to take up what it holds, or putting it away?"""
        return self._reconcile is not None

    def go(self, command: str, seconds: float) -> float:
        """Send a command; yields its duration (varied a little) for the process to wait."""
        self._settle_command()
        if command not in OVER_TRAYS:
            self._clear_zone()
        self.live = command
        self.commands.sent += 1
        duration = seconds * (1 + self._calibration.spread * (2 * self._random.random() - 1))
        self._done_at = self._scheduler.now + duration
        return duration

    def stand(self) -> None:
        """The last command is done; the arm stays where it is."""
        self._settle_command()

    def retreat(self) -> None:
        """The last command is done; the arm needs a moment to clear the tray area."""
        self._settle_command()
        self._busy_until = self._scheduler.now + self._calibration.retreat_s
        self._scheduler.call_after(self._calibration.retreat_s, self._clear_zone)

    def over_trays(self) -> None:
        """From now on it works over the tray area."""
        self._plant.arm_over_trays = True

    @property
    def is_over_trays(self) -> bool:
        """Is it over the tray area, where nobody else may reach in?"""
        return self._plant.arm_over_trays

    def close_on_part(self, u: float, y: float) -> bool:
        """Close at a place of the belt's frame; does the gripper feel something?"""
        return self._plant.close_on_part(u, y)

    def close_on_stack(self) -> bool:
        """Close on the topmost tray; does the gripper feel something?"""
        return self._plant.close_on_stack()

    def close_on_tray(self, tag: str) -> tuple[float, float] | None:
        """Close on a standing tray, guided by the palm camera; gives where it stood, or None."""
        return self._plant.close_on_tray(tag)

    def seat(self, pose: tuple[float, float], slot: str) -> Felt:
        """Press the part down where that slot of a tray at `pose` would be; what the force sensor feels."""
        return self._plant.seat(pose, slot)

    def set_down_tray(self, pose: tuple[float, float]) -> bool:
        """Set the held tray down; False if there is none or no room."""
        return self._plant.set_down_tray(pose)

    def put_back(self) -> None:
        """Put back what is held; an empty gripper is noticed."""
        if not self._plant.put_back():
            self.slipped()

    def discard(self, why: str) -> None:
        """Drop what is held into the reject bin; an empty gripper is noticed."""
        if not self._plant.discard(why):
            self.slipped()

    def hand_over(self) -> Verdict | None:
        """Push the held tray out: what downstream says of it (a refusal is felt at once), or None if none is held."""
        return self._plant.hand_over()

    def _arrange(self) -> None:
        if self._granting is None and self.owner is None and not self.gripped and self.queue:
            delay = max(self._calibration.arbitration_s, self._busy_until - self._scheduler.now)
            self._granting = self._scheduler.call_after(delay, self._grant)

    def _grant(self) -> None:
        self._granting = None
        if self.owner is not None or self.gripped:
            return
        kept_back = False
        for turn in sorted(self.queue, key=lambda turn: (turn.rank, turn.number)):
            if turn.ready and not (kept_back and turn.rank >= FIXED):
                self.queue.remove(turn)
                self.owner = turn
                turn.granted.fire(True)
                return
            kept_back = kept_back or (turn.rank >= FIXED and not turn.ready)

    def _watch(self) -> None:
        if self._watching is None:
            self._watching = self._scheduler.call_after(self._calibration.look_again_s, self._look_again)

    def _look_again(self) -> None:
        self._watching = None
        unready = [turn for turn in self.queue if not turn.ready]
        for turn in unready:
            if not turn.waits_only:
                turn.ready = self._in_sight(turn.wanted)
        if unready:
            self._watch()
            self._arrange()

    def _settle_command(self) -> None:
        if self.live:
            self.live = ""
            self.commands.done += 1

    def _clear_zone(self) -> None:
        if self._plant.arm_over_trays:
            self._plant.arm_over_trays = False
            self._plant.happened()

    def _expect_someone(self) -> None:
        if self._reconcile is None:
            self._reconcile = self._scheduler.call_after(self._calibration.reconcile_s, self._put_away)

    def _put_away(self) -> None:
        if not self.gripped:
            self._reconcile = None
            self.feel_empty()
            self._arrange()
            return
        self._numbers += 1
        self.owner = Turn("put away", DELIVER, self._numbers, self._scheduler.now, ready=True)
        self._reconcile = self._scheduler.call_after(self.go("put away", self._calibration.put_back_s), self._put)

    def _put(self) -> None:
        """Put away what nobody took up: a tray on which work was done stands again where it stood."""
        self._settle_command()
        self._reconcile = None
        memory = self._memory
        tray = memory.trays.get(memory.held)
        if tray is not None and tray.place >= 0 and self._plant.set_down_tray(tray.pose):
            tray.state, memory.held = "area", ""
        else:
            self.put_back()
            memory.let_go()
        self.owner = None
        self._arrange()
        self.released.fire()
