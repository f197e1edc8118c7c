"""What can be seen and felt of the cell: the only way from the plant to the robot's side.

    global camera   parts on the belt: place, kind, appearance of the variant (with noise, misses and
                    confusions), never quality; trays in the tray area: printed tag, place, which slots are
                    filled. Blind while it is dark.
    entrance        a light barrier triggers a burst of three pictures of each part that comes onto the belt
    palm camera     what the gripper holds, close up: kind and variant of a part, tag and slots of a tray
    gripper         closed on something or empty
    test station    good or bad (takes time, which the process spends)
    downstream      its ready line, its refusal, its verdict on a tray: see `downstream`

No number of a part or a fault ever passes through here.
"""

from __future__ import annotations

from collections.abc import Callable

import msgspec

from planner_reactor.workcell.plant import Plant
from planner_reactor.workcell.things import Part, Tray


class Glimpse(msgspec.Struct, frozen=True):
    """A part as the global camera sees it: `u`, `y` in the belt's frame (m). `certain`: seen the same thrice."""

    kind: str
    variant: str
    u: float
    y: float
    certain: bool = False


class PartView(msgspec.Struct, frozen=True):
    """A held part as the palm camera sees it."""

    kind: str
    variant: str


class TrayView(msgspec.Struct, frozen=True):
    """A tray as a camera sees it: its tag, where it stands (m), which slots are filled."""

    tag: str
    pose: tuple[float, float]
    filled: tuple[str, ...]


class Follower:
    """The camera keeps a part in view while it moves (X §4.1): `pose` is always fresh."""

    __slots__ = ("_part", "_sensors")

    def __init__(self, sensors: Sensors, part: Part) -> None:
        self._sensors = sensors
        self._part = part

    def pose(self) -> tuple[float, float] | None:
        """Where it now is in the belt's frame, or None when it is out of view."""
        return self._sensors.pose_of(self._part)


class Sensors:
    """All sensors of one cell. `noticed` hears of each part that the entrance sees, `blind` of each that it
    cannot.
    """

    def __init__(self, plant: Plant) -> None:
        self.noticed: Callable[[Glimpse], None] = lambda glimpse: None
        self.blind: Callable[[], None] = lambda: None
        self._plant = plant
        self._random = plant.scheduler.random("camera")
        self._test_random = plant.scheduler.random("test")
        plant.entered = self._entered
        self._pictured_at = plant.scheduler.now
        self._hung: tuple[TrayView, ...] | None = None  # the picture that the camera repeats
        self._dead_line: tuple[bool, int] | None = None  # what the ready line stands at, and its life sign

    def has_picture(self) -> bool:
        """Does the global camera give a picture?"""
        return not self._plant.dark

    def look(self, kind: str) -> list[Glimpse] | None:
        """The parts of a kind on the belt, in one picture; None without a picture."""
        plant = self._plant
        if plant.dark:
            return None
        calibration, draw, gauss = plant.calibration, self._random.random, self._random.gauss
        noise, miss, error = calibration.pose_noise, calibration.miss, calibration.variant_error
        return [
            Glimpse(
                kind,
                self._other_variant(part) if draw() < error else part.variant,
                part.u + gauss(0.0, noise),
                part.y + gauss(0.0, noise),
            )
            for part in plant.belt.parts[kind].values()
            if draw() >= miss
        ]

    def trays(self) -> tuple[TrayView, ...] | None:
        """The trays in the tray area, in one picture; None without a picture."""
        if self._plant.dark:
            return None
        if self._hung is not None:
            return self._hung
        return tuple([TrayView(tray.tag, tray.pose, tuple(tray.slots)) for tray in self._plant.area.values()])

    def pictured_at(self) -> float:
        """When the picture was taken that the global camera gives now, or gave last (seconds)."""
        if not self._plant.dark and self._hung is None:
            self._pictured_at = self._plant.scheduler.now
        return self._pictured_at

    def hang(self, *, camera: bool = False, line: bool = False) -> None:
        """Break sensors: the camera repeats its last picture, the ready line stands still; False: they work again."""
        self.pictured_at()
        self._hung = (self.trays() if self._hung is None else self._hung) if camera else None
        self._dead_line = (self.downstream_ready(), self.downstream_life()) if line else None

    def stack_height(self) -> int:
        """How many trays are stacked."""
        return len(self._plant.stack)

    def follow(self, u: float, y: float) -> Follower | None:
        """Keep the part at this place in view; None if there is none, or no picture."""
        if self._plant.dark:
            return None
        part = self._plant.belt.under(u, y, self._plant.calibration.seen_tolerance)
        return Follower(self, part) if part is not None else None

    def pose_of(self, part: Part) -> tuple[float, float] | None:
        """For a `Follower`: the part's place with noise, while it is on the belt and there is a picture."""
        if part.place != "belt" or self._plant.dark:
            return None
        gauss, noise = self._random.gauss, self._plant.calibration.pose_noise
        return part.u + gauss(0.0, noise), part.y + gauss(0.0, noise)

    def between_fingers(self, u: float, y: float) -> bool:
        """The light barrier between the fingers: is something there when the gripper is open at this place?"""
        return self._plant.belt.under(u, y, self._plant.calibration.grasp_tolerance / 2) is not None

    def palm(self) -> PartView | TrayView | None:
        """What the palm camera sees in the gripper."""
        thing = self._plant.gripper
        if isinstance(thing, Tray):
            return TrayView(thing.tag, (0.0, 0.0), tuple(thing.slots))
        return PartView(thing.kind, thing.variant) if thing is not None else None

    def test(self) -> bool | None:
        """What the test station says of the held thing; None without one."""
        thing = self._plant.gripper
        if thing is None:
            return None
        good = thing.good and not (isinstance(thing, Part) and thing.damaged)
        return good != (self._test_random.random() < self._plant.calibration.test_error)

    def downstream_ready(self) -> bool:
        """Downstream's ready line."""
        return self._plant.downstream.ready if self._dead_line is None else self._dead_line[0]

    def downstream_life(self) -> int:
        """The life sign that comes with the ready line: it counts seconds."""
        return int(self._plant.scheduler.now) if self._dead_line is None else self._dead_line[1]

    def _entered(self, part: Part) -> None:
        plant, draw = self._plant, self._random.random
        if plant.dark:
            self.blind()
            return
        if draw() < plant.calibration.miss:
            return
        error = plant.calibration.variant_error
        wrong = (draw() < error) + (draw() < error) + (draw() < error)
        variant = self._other_variant(part) if wrong >= 2 else part.variant
        self.noticed(Glimpse(part.kind, variant, part.u, part.y, certain=wrong in (0, 3)))

    def _other_variant(self, part: Part) -> str:
        others = [v for v in self._plant.kit.by_kind[part.kind].variants if v != part.variant]
        return self._random.choice(others) if others else part.variant
