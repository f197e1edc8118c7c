"""Downstream automation: takes full trays, judges them by what is truly in them, and can refuse (R §8.1).

What the cell can sense of it: the ready line (`ready`, with the signal `changed`), a promised place
(`reserve`), a refusal at the moment of handing over, and a verdict some seconds after it took a tray, with
reasons but without causes. The causes (numbers of faults) are for the record of the run only.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable

import msgspec

from planner_reactor.runtime.scheduler import Scheduler
from planner_reactor.runtime.signals import Signal
from planner_reactor.workcell.calibration import Calibration
from planner_reactor.workcell.kit import KitSpec, PartKind
from planner_reactor.workcell.things import Part, Tray

REASONS = ("refused", "missing", "bad", "damaged", "wrong variant", "wrong kind", "surplus", "damaged tray")


class Verdict(msgspec.Struct, frozen=True):
    """What downstream says of a tray: its tag, whether it serves, and why not."""

    tag: str
    accepted: bool
    reasons: tuple[str, ...] = ()


class Rejection(msgspec.Struct, frozen=True):
    """A kit that was lost: when, why, and the numbers of the faults that spoiled it (empty: our own doing)."""

    time: float
    tray: int
    reasons: tuple[str, ...]
    faults: tuple[int, ...]


class Downstream:
    """Judges, counts, and tells. `answer` hears each verdict after `verdict_s`, `told` each change of the
    line.
    """

    def __init__(self, kit: KitSpec, calibration: Calibration, scheduler: Scheduler) -> None:
        self.ready = True
        self.changed = Signal("downstream")
        self.completed = 0
        self.rejections: list[Rejection] = []
        self.blocked_by: tuple[int, ...] = ()
        self.answer: Callable[[Verdict], None] = lambda verdict: None
        self.told: Callable[[bool], None] = lambda ready: None
        self._reserved_until = -1.0
        self.accepted: Callable[[KitSpec], None] = lambda kit: None
        self.made: Counter[str] = Counter()  # kits by what was ordered
        self._orders: list[KitSpec] = [kit]  # the newest first; the others are taken until the newest comes
        self._beside: tuple[KitSpec, ...] = ()
        self._calibration = calibration
        self._scheduler = scheduler

    @property
    def expected(self) -> KitSpec:
        """What is ordered now."""
        return self._orders[0]

    def expect(self, kit: KitSpec, *, beside: tuple[KitSpec, ...] = ()) -> None:
        """This is ordered from now on; what is ordered `beside` it is taken too, for as long as that is so."""
        self._orders = [kit, *(other for other in self._orders if other != kit)]
        self._beside = beside

    def block(self, mark: int) -> None:
        """Stop taking trays (but keep a promise)."""
        self.ready = False
        self.blocked_by = (mark,)
        self._tell()

    def unblock(self) -> None:
        """Take trays again."""
        self.ready = True
        self.blocked_by = ()
        self._tell()

    def reserve(self) -> bool:
        """Promise a place for the next tray, for some time; False if blocked."""
        if self.ready:
            self._reserved_until = self._scheduler.now + self._calibration.reservation_s
        return self.ready

    def take(self, tray: Tray) -> Verdict:
        """A tray is pushed out: refused and lost if blocked, else judged. The verdict is told later."""
        now = self._scheduler.now
        if not self.ready and now > self._reserved_until:
            kit, faulty = self.expected, [("refused", self.blocked_by)]
        else:
            kit, faulty = self._judged(tray)
        self._reserved_until = -1.0
        reasons = tuple(dict.fromkeys(reason for reason, _ in faulty))
        verdict = Verdict(tray.tag, not faulty, reasons)
        if faulty:
            causes = tuple(dict.fromkeys(mark for _, marks in faulty for mark in marks))
            self.rejections.append(Rejection(now, tray.number, reasons, causes))
        else:
            self.completed += 1
            self.made["+".join(kit.order)] += 1
            self.accepted(kit)
        self._scheduler.call_after(self._calibration.verdict_s, lambda: self.answer(verdict))
        return verdict

    def _tell(self) -> None:
        self.told(self.ready)
        self.changed.fire(self.ready)

    def _judged(self, tray: Tray) -> tuple[KitSpec, list[tuple[str, tuple[int, ...]]]]:
        """As which order it serves; if as none, what is wrong with it by the newest."""
        for kit in (*self._orders, *self._beside):
            if not self._faults(tray, kit):
                if kit == self.expected:
                    del self._orders[1:]  # nothing older can come any more
                return kit, []
        return self.expected, self._faults(tray, self.expected)

    def _faults(self, tray: Tray, kit: KitSpec) -> list[tuple[str, tuple[int, ...]]]:
        found: list[tuple[str, tuple[int, ...]]] = []
        if not tray.good:
            found.append(("damaged tray", tray.marks))
        found += [("surplus", part.marks) for kind, part in tray.slots.items() if kind not in kit.by_kind]
        for kind in kit.kinds:
            part = tray.slots.get(kind)
            if part is None:
                found.append(("missing", tray.marks))
            else:
                found.extend((reason, part.marks) for reason in self._wrong(part, kit.by_kind[kind]))
        return found

    def _wrong(self, part: Part, slot: PartKind) -> list[str]:
        if part.damaged:
            return ["damaged"]
        if part.kind != slot.kind:
            return ["wrong kind"]
        reasons = [] if part.good else ["bad"]
        if part.variant not in slot.accepted:
            reasons.append("wrong variant")
        return reasons
