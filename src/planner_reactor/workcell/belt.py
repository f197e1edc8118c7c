"""The belt: parts arrive on it, ride along, and leave at its end.

Each kind comes from a feeder of its own (random stream `belt.KIND`): intervals around a mean, a variant, a
quality. Disturbances act on feeders: a spoiled batch, another variant, a kind that stays away, kinds that
come in turns. The belt is already loaded when the run starts. Truth only: what is seen of it is for
`sensors`.
"""

from __future__ import annotations

import random
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from itertools import count

import msgspec

from planner_reactor.runtime.scheduler import Scheduler, Timer
from planner_reactor.workcell.calibration import Calibration
from planner_reactor.workcell.kit import KitSpec, PartKind
from planner_reactor.workcell.things import Part

CLEAR = 0.035
"""Metres along the belt that a part keeps clear of others in its lane."""
ROOM = 5
"""How far back, in parts, room is looked for."""


@dataclass(slots=True)
class Batch:
    """Spoiled parts among those of a feeder: each, with probability `share`, is bad or of another variant.

    The batch is over after `left` of them; or, `until_taken`, when the arm has taken so many.
    """

    left: int
    share: float
    mark: int
    variant: str = ""  # empty: bad quality
    until_taken: bool = False


class Feeder:
    """Brings one kind: draws when the next part comes and what it is like."""

    __slots__ = ("_random", "away_until", "batches", "jitter", "kind")

    def __init__(self, kind: PartKind, jitter: float, stream: random.Random) -> None:
        self.kind = kind
        self.jitter = jitter
        self.batches: list[Batch] = []
        self.away_until = 0.0
        self._random = stream

    def interval(self) -> float:
        """Seconds to the next part."""
        return self.kind.interval_s * (1 + self.jitter * (2 * self._random.random() - 1))

    def across(self) -> float:
        """A draw from -1 to 1 for the pose across the belt."""
        return 2 * self._random.random() - 1

    def part(self, number: int) -> Part:
        """A new part, spoiled by the batches that are due."""
        part = Part(number, self.kind.kind, self._variant(), good=self._random.random() < self.kind.quality)
        for batch in self.batches:
            if batch.left > 0 and self._random.random() < batch.share:
                batch.left -= not batch.until_taken
                part.marks = (*part.marks, batch.mark)
                if batch.variant:
                    part.variant = batch.variant
                else:
                    part.good = False
        self.batches = [batch for batch in self.batches if batch.left > 0]
        return part

    def taken(self, part: Part) -> None:
        """The arm has taken this part."""
        for batch in self.batches:
            if batch.until_taken and batch.mark in part.marks:
                batch.left -= 1

    def _variant(self) -> str:
        if not self.kind.mix:
            return self.kind.wanted
        draw = self._random.random()
        for variant, share in self.kind.mix:
            draw -= share
            if draw < 0:
                return variant
        return self.kind.wanted


class Turns(msgspec.Struct, frozen=True):
    """Kinds that come one at a time: each for `phase_s`, in this order, until `until`."""

    start: float
    phase_s: float
    until: float
    order: tuple[str, ...]

    def admits(self, kind: str, now: float) -> bool:
        """Is it this kind's turn?"""
        if now >= self.until:
            return True
        return self.order[int((now - self.start) / self.phase_s) % len(self.order)] == kind


class Belt:
    """The parts on the belt, by kind, and who feeds them. `arrived` and `left` tell the world."""

    def __init__(
        self,
        kit: KitSpec,
        calibration: Calibration,
        scheduler: Scheduler,
        numbers: count[int],
        *,
        arrived: Callable[[Part], None],
        left: Callable[[Part], None],
    ) -> None:
        self.length = calibration.belt_speed * kit.dwell_s
        self.speed = calibration.belt_speed
        self.parts: dict[str, dict[int, Part]] = {kind: {} for kind in kit.kinds}
        self.turns: Turns | None = None
        self.feeders = {p.kind: Feeder(p, kit.jitter, scheduler.random(f"belt.{p.kind}")) for p in kit.parts}
        self._calibration = calibration
        self._scheduler = scheduler
        self._numbers = numbers
        self._lane = 0
        self._riding: dict[int, Part] = {}
        self._leaving: dict[int, Timer] = {}
        self._arrived = arrived
        self._left = left

    @property
    def count(self) -> int:
        """How many parts ride on it (each has a time at which it leaves)."""
        return len(self._leaving)

    def start(self) -> None:
        """Load the belt as if it had been running, and let the feeders go on."""
        for feeder in self.feeders.values():
            age = feeder.interval() / 2
            due = feeder.interval() - age
            while age < self.length / self.speed:
                self._enter(feeder, travelled=age * self.speed)
                age += feeder.interval()
            self._scheduler.call_after(max(due, 0.0), partial(self._due, feeder))

    def position(self, part: Part) -> float:
        """Metres from the entrance."""
        return part.u + self.speed * self._scheduler.now

    def put(self, part: Part, travelled: float) -> None:
        """Lay a part on the belt, where there is room: in the next free lane, or a little further back."""
        u = travelled - self.speed * self._scheduler.now
        lanes = self._calibration.lanes
        for attempt in range(ROOM * len(lanes)):
            lane = (self._lane + 1 + attempt) % len(lanes)
            if attempt and lane == self._lane:
                u -= CLEAR
            if self._is_clear(u, lanes[lane]):
                break
        self._lane = lane
        part.u = u
        part.y = lanes[lane] + self._calibration.lane_noise * self.feeders[part.kind].across()
        self.parts[part.kind][part.number] = self._riding[part.number] = part
        self._time_leaving(part)

    def remove(self, part: Part) -> None:
        """Take a part off the belt."""
        del self.parts[part.kind][part.number], self._riding[part.number]
        self._leaving.pop(part.number).cancel()

    def shift(self, part: Part, along: float, across: float) -> None:
        """A part slides along the belt (m): the other way if it would slide over an end, and further if on
        another.
        """
        del self._riding[part.number]
        travelled = self.position(part) + along
        if not 0.0 <= travelled < self.length - 0.03:
            travelled = min(max(travelled - 2 * along, 0.0), self.length - 0.03)
        part.u = travelled - self.speed * self._scheduler.now
        part.y += across
        while not self._is_clear(part.u, part.y):
            part.y += CLEAR if across >= 0 else -CLEAR
        self._riding[part.number] = part
        self._leaving.pop(part.number).cancel()
        self._time_leaving(part)

    def under(self, u: float, y: float, tolerance: float) -> Part | None:
        """The part that lies at this place of the belt's frame, the nearest if several do."""
        best: Part | None = None
        least = tolerance
        for part in self._riding.values():
            if -least <= part.u - u <= least and (away := max(abs(part.u - u), abs(part.y - y))) <= least:
                best, least = part, away
        return best

    def _is_clear(self, u: float, y: float) -> bool:
        return not any(-CLEAR < part.u - u < CLEAR and abs(part.y - y) < CLEAR / 2 for part in self._riding.values())

    def _time_leaving(self, part: Part) -> None:
        when = (self.length - part.u) / self.speed
        self._leaving[part.number] = self._scheduler.call_at(when, partial(self._gone, part))

    def _gone(self, part: Part) -> None:
        self.remove(part)
        self._left(part)

    def _due(self, feeder: Feeder) -> None:
        now = self._scheduler.now
        if now < feeder.away_until:
            pause = feeder.away_until - now + feeder.interval() / 2
        else:
            if self.turns is None or self.turns.admits(feeder.kind.kind, now):
                self._enter(feeder, travelled=0.0)
            pause = feeder.interval()
        self._scheduler.call_after(pause, partial(self._due, feeder))

    def _enter(self, feeder: Feeder, *, travelled: float) -> None:
        part = feeder.part(next(self._numbers))
        self.put(part, travelled)
        self._arrived(part)
