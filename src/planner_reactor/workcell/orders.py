"""What is ordered while kitting goes on (R §2 (3), (6)): another kit, a mix of kits, a substitution, a few of a kind.

The belt brings what it brings; an order says which of these kinds make a kit from now on, in which placing order, and
which variants are wanted. Downstream and the cell's own record are told at once, the planner through `advise`: its text
has another contents rule (`domains.with_kit`). An order takes effect between two trays, so that none is begun for one
and finished for another; if the tray that stands there does not get done, because what it waits for does not come, then
as soon as it serves the new order. Trays that were begun before are taken as they were ordered, until the first of the
new ones comes. A mix goes round: so many kits of one order, then of the next.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import msgspec

from planner_reactor.errors import InputError, nearest
from planner_reactor.workcell.domains import with_kit
from planner_reactor.workcell.downstream import Downstream
from planner_reactor.workcell.kit import KitSpec
from planner_reactor.workcell.plant import Plant

ORDERS: Mapping[str, Mapping[str, Any]] = {
    "kit": {"kinds": []},
    "mix": {"kits": [], "counts": []},
    "once": {"kinds": [], "count": 1},
    "substitute": {"part": "", "variant": ""},
}
"""Kinds of orders, with their parameters and defaults."""

OVERDUE_S = 60.0
"""After so long a tray that stands there, and serves the new order as far as it goes, is finished for that."""

Advise = Callable[[Callable[[str], str] | None, tuple[str, ...]], None]


class _Batch(msgspec.Struct, frozen=True):
    kit: KitSpec
    count: int  # 0: as long as nothing else is ordered


@dataclass(slots=True)
class Orders:
    """The order book of one cell. `feed` is what the belt brings."""

    feed: KitSpec
    plant: Plant
    wanted: dict[str, str] = field(default_factory=dict)  # kind → the variant that replaces the one of the feed
    _batches: list[_Batch] = field(default_factory=list)
    _left: int = 0
    _again: bool = False
    _given: bool = False
    _asked_s: float = 0.0
    downstream: Downstream = field(init=False)
    _advise: Advise = lambda rewrite, doubts: None

    def __post_init__(self) -> None:
        self.downstream = self.plant.downstream
        self.downstream.accepted = self._accepted

    @property
    def given(self) -> bool:
        """Has anything been ordered since the beginning?"""
        return self._given

    def take(self, kind: str, advise: Advise, **given: Any) -> None:
        """An order: from now on. InputError for what the belt does not bring."""
        self._advise, self._given = advise, True
        match kind:
            case "kit":
                self._begin([_Batch(self._kit(given["kinds"]), 0)])
            case "once":
                now = self.downstream.expected
                self._begin([_Batch(self._kit(given["kinds"]), _count(given["count"])), _Batch(now, 0)])
            case "mix":
                kits, counts = given["kits"], given["counts"]
                if len(kits) != len(counts):
                    raise InputError(f"mix has {len(kits)} kits and {len(counts)} counts, expected as many")
                self._begin([_Batch(self._kit(k), _count(n)) for k, n in zip(kits, counts, strict=True)], again=True)
            case _:
                self._substitute(given["part"], given["variant"])

    def _begin(self, batches: list[_Batch], *, again: bool = False) -> None:
        self._batches, self._again, self._left = batches, again, 0
        self._go_on(batches[0])

    def _go_on(self, batch: _Batch) -> None:
        """As soon as that can be."""
        self._asked_s = self.plant.scheduler.now
        if not self._take_effect(batch):
            self.plant.attempts.append(lambda: self._take_effect(batch))

    def _take_effect(self, batch: _Batch) -> bool:
        """True if it has, or is no longer wanted."""
        if not self._batches or self._batches[0] is not batch:
            return True
        standing = {kind for tray in self.plant.area.values() for kind in tray.slots}
        surplus = {*self.downstream.expected.kinds} - {*batch.kit.kinds}
        overdue = self.plant.scheduler.now - self._asked_s >= OVERDUE_S and standing <= {*batch.kit.kinds}
        if surplus and self.plant.area and not overdue:
            return False
        self._left = batch.count
        others = tuple(other.kit for other in self._batches if other is not batch and self._again)
        self.downstream.expect(batch.kit, beside=others)
        self._advise(lambda text: with_kit(text, batch.kit), ())
        return True

    def _accepted(self, kit: KitSpec) -> None:
        """One more is done: is it time for the next batch?"""
        if not self._left or kit.order != self._batches[0].kit.order:
            return
        self._left -= 1
        if not self._left:
            done = self._batches.pop(0)
            if self._again:
                self._batches.append(done)
            self._go_on(self._batches[0])

    def _substitute(self, part: str, variant: str) -> None:
        kind = self._known(part)
        if variant not in self.feed.by_kind[kind].variants:
            known = self.feed.by_kind[kind].variants
            raise InputError(f"'{variant}' is no variant of {part}, {nearest(variant, known) or ', '.join(known)}")
        self.wanted[kind] = variant
        self._batches = [_Batch(self._kit(batch.kit.order), batch.count) for batch in self._batches]
        self.downstream.expect(self._kit(self.downstream.expected.order))
        self._advise(None, ("AS",))  # there is more than one variant about, from now on

    def _kit(self, kinds: Sequence[str]) -> KitSpec:
        """A kit of these kinds, in this order, of the variants wanted."""
        if not kinds or len(set(kinds)) < len(kinds):
            raise InputError(f"kit of {list(kinds)}, expected kinds, each once")
        parts = []
        for kind in map(self._known, kinds):
            part, wanted = self.feed.by_kind[kind], self.wanted.get(kind)
            if wanted is not None:
                part = msgspec.structs.replace(part, wanted=wanted, substitutes=())
            parts.append(part)
        return replace(self.feed, name="+".join(kinds), parts=tuple(parts), order=tuple(kinds))

    def _known(self, kind: str) -> str:
        if kind not in self.feed.by_kind:
            hint = nearest(kind, self.feed.kinds) or f"it brings {', '.join(self.feed.kinds)}"
            raise InputError(f"the belt brings no {kind}, {hint}")
        return kind


def _count(count: int) -> int:
    if not isinstance(count, int) or count < 1:
        raise InputError(f"count is {count!r}, expected 1 or more")
    return count
