"""The robot's side of the cell, in one place: what every basic process and every monitor works with.

Nothing here or in the processes reads the plant: pictures come from `sensors`, deeds go through the `arm`,
and what is known is what `memory` holds. `Steps` is what a basic process is: a generator that yields seconds
or signals.
"""

from __future__ import annotations

from collections.abc import Generator
from functools import partial
from typing import Any, TypeAlias, TypeVar

from planner_reactor.runtime.scheduler import Scheduler
from planner_reactor.runtime.signals import Aborted, Signal
from planner_reactor.workcell.arm import FIXED, OPPORTUNE, Arm
from planner_reactor.workcell.calibration import Calibration
from planner_reactor.workcell.downstream import Verdict
from planner_reactor.workcell.evidence import Evidence
from planner_reactor.workcell.kit import KitSpec, PartKind
from planner_reactor.workcell.memory import Memory, PartRecord, TrayRecord
from planner_reactor.workcell.plant import Plant
from planner_reactor.workcell.sensors import Glimpse, PartView, Sensors
from planner_reactor.workcell.watching import TrayWatch

T = TypeVar("T")
Steps: TypeAlias = Generator[Any, Any, T]
TRAY = "tray"
AWAY = 4.0
"""Mean intervals without a part of its kind after which a feeder is thought to have stopped."""


class Cell:
    """Sensors, arm, memory and evidence of one workcell."""

    def __init__(self, plant: Plant) -> None:
        self.kit: KitSpec = plant.kit
        self.calibration: Calibration = plant.calibration
        self.scheduler: Scheduler = plant.scheduler
        self.sensors = Sensors(plant)
        self.memory = Memory(self.kit, self.calibration)
        self.evidence = Evidence(self.scheduler, self.calibration.quiet_s, plant.trace)
        self.watch = TrayWatch(self.sensors, self.memory, self.evidence, self.kit, self.scheduler)
        self._downstream = plant.downstream
        self.arm = Arm(plant, self.memory, in_sight=self.in_sight)
        self.arrivals = {kind: Signal(f"{kind} seen") for kind in self.kit.kinds}
        self.refilled: Signal = plant.refilled
        self.downstream_changed: Signal = plant.downstream.changed
        self.reserve_downstream = plant.downstream.reserve
        self.wait_s = self.calibration.wait_s(len(self.kit.kinds))
        self.reach_s = self.calibration.look_s + self.calibration.reach_s + self.calibration.close_s
        self._last_came = dict.fromkeys(self.kit.kinds, self.scheduler.now)
        self._too_long = {part.kind: AWAY * part.interval_s for part in self.kit.parts}
        self._turn_s = self.calibration.pick_and_place_s + self.calibration.test_s
        self.arm.slipped = partial(self.evidence.note, "gripper")
        self.sensors.noticed = self._noticed
        self.sensors.blind = self._blind
        plant.downstream.answer = self._answered
        plant.downstream.told = self._ready_line

    def part(self, kind: str) -> PartKind:
        """What is ordered of a kind; what the belt brings of it, if none is."""
        return self._downstream.expected.by_kind.get(kind) or self.kit.by_kind[kind]

    @property
    def ordered(self) -> tuple[str, ...]:
        """The kinds of which a kit is made now."""
        return self._downstream.expected.kinds

    def look(self, kind: str) -> bool:
        """Take a picture and remember what is in it; False without a picture."""
        glimpses = self.sensors.look(kind)
        if glimpses is None:
            self.evidence.note("camera")
            return False
        self.watch.glance()
        wanted = self.part(kind).wanted
        for record in self.memory.see_all(kind, glimpses, self.scheduler.now):
            self._judge_variant(record, wanted)
        return True

    def spot(self, wanted: str, *, patient: bool = False) -> PartRecord | None:
        """The part of this kind or variant to pick next, in a fresh picture.

        `patient`: rather one that will still be there when all others who wait for the arm have had it.
        """
        if not self.look(self.kind(wanted)):
            return None
        now, found = self.scheduler.now, None
        if patient:
            found = self.memory.candidate(wanted, now, self.reach_s + self.arm.ahead * self._turn_s)
        return found or self.memory.candidate(wanted, now, self.reach_s)

    def in_sight(self, wanted: str) -> bool:
        """Is one remembered, or in a fresh picture, that can be reached?"""
        found = self.memory.candidate(wanted, self.scheduler.now, self.reach_s)
        return found is not None or self.spot(wanted) is not None

    def kind(self, name: str) -> str:
        """The part kind of a kind or variant; aborts if there is none of that name."""
        kind = self.kit.kind_of.get(name)
        if kind is None:
            raise Aborted(f"no part is called {name}")
        return kind

    def in_palm(self, record: PartRecord) -> PartView:
        """What the palm camera sees of a part that was gripped, remembered. Aborts if it is not there any more."""
        view = self.sensors.palm()
        if not isinstance(view, PartView):
            self.memory.forget(record)
            self.arm.feel_empty()
            raise Aborted(f"{record.handle} slipped out of the gripper")
        self.memory.grip(record, view.kind, view.variant)
        return view

    def tray(self, handle: str) -> TrayRecord | None:
        """What is remembered of a tray; None once it has left; aborts for what is no tray."""
        tray = self.memory.trays.get(handle)
        if tray is None and not (handle.startswith(TRAY) and self.memory.was_given(handle)):
            raise Aborted(f"{handle} is no tray")
        return tray

    def free_place(self) -> int:
        """A free place of the tray area, or -1."""
        taken = {tray.place for tray in self.memory.trays.values() if tray.state == "area"}
        return next((place for place in range(self.kit.places) if place not in taken), -1)

    def place_pose(self, place: int) -> tuple[float, float]:
        """Where the tray in that place stands (m)."""
        return (0.4 * place, 0.5)

    def rank(self, kind: str) -> int:
        """The rank of a turn for this kind: opportunistic when its arrival was awaited (uses that up), else
        fixed.
        """
        if self.memory.due[kind] > 0:
            self.memory.due[kind] -= 1
            return OPPORTUNE
        return FIXED + self.kit.priority[kind]

    def _noticed(self, glimpse: Glimpse) -> None:
        now = self.scheduler.now
        self.memory.prune(glimpse.kind, now)
        record = self.memory.see(glimpse, now)
        self.watch.glance()
        self._came(glimpse.kind, now)
        self._judge_variant(record, self.part(glimpse.kind).wanted)
        self.arm.noticed(glimpse.kind)
        self.arrivals[glimpse.kind].fire()

    def _came(self, kind: str, now: float) -> None:
        """One kind came: does another stay away far longer than the feeders' mean interval says?"""
        self._last_came[kind] = now
        for other, when in self._last_came.items():
            if now - when > self._too_long[other]:
                self.evidence.against("AO", f"{other} stays away while {kind} comes")

    def _blind(self) -> None:
        """Something came, and there was no picture of it: nothing is known of who came last."""
        self.evidence.note("camera")
        self._last_came = dict.fromkeys(self.kit.kinds, self.scheduler.now)

    def _judge_variant(self, record: PartRecord, wanted: str) -> None:
        if len(record.votes) == 1 and wanted in record.votes:
            return
        for variant, votes in record.votes.items():
            if variant != wanted and votes >= 3:
                self.evidence.against("AS", f"a part looks like {variant}")

    def _answered(self, verdict: Verdict) -> None:
        if verdict.accepted:
            for assumption in ("AQ", "AS", "ACT"):
                self.evidence.supports(assumption)
        for reason in verdict.reasons:
            if reason in _TELLS:
                self.evidence.against(_TELLS[reason], f"downstream rejected a kit: {reason}")

    def _ready_line(self, ready: bool) -> None:
        if ready:
            self.evidence.note("ready")
            self.evidence.forget("ADD")
        else:
            self.evidence.against("ADD", "downstream signals that it takes no trays")


_TELLS = {"bad": "AQ", "damaged tray": "AQ", "missing": "ACT", "wrong variant": "AS", "refused": "ADD"}
"""What downstream's reasons for a rejection tell about the assumptions."""
