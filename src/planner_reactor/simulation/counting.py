"""What the fault table asks for, counted as it happens: from the trace, and from what the world and the link saw.

That a fault was injected counts for nothing here. A row's counter moves when what the row describes has come to pass:
a drain with two instances on, a crash with the old reaction gone and the new one not there, a reading found stale.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from typing import TYPE_CHECKING

from planner_reactor.trace import Event

if TYPE_CHECKING:
    from planner_reactor.simulation.stage import Stage

BY_REASON = {"disk": "27 adaptations refused for want of a disk", "epoch": "7 adaptations of an older epoch refused"}
BY_WRONG = {
    "one of a group": "11 groups refused for one of them",
    "recursion": "17 recursions without a guard refused",
    "parser bomb": "18 parser bombs refused",
    "unknown process": "20 unknown processes refused",
}
BY_DOUBT = {"stale": "25 readings found stale", "stuck": "25 signals found stuck"}


class Counting:
    """Counts into `rows` what a stage's trace tells."""

    def __init__(self, stage: Stage) -> None:
        self._stage = stage
        self._rows: Counter[str] = stage.rows
        self._gone: set[int] = set()  # reactions that went, or came, since an adaptation was begun
        self._come: set[int] = set()
        self._kinds: dict[str, Callable[[Event], object]] = {
            "adaptation_received": self._received, "adaptation_applied": self._applied,
            "adaptation_timed_out": self._timed_out, "adaptation_refused": self._refused, "draining": self._draining,
            "removed": lambda event: self._gone.add(event.data["label"]),
            "retired": lambda event: self._gone.add(event.data["label"]),
            "added": lambda event: self._come.add(event.data["label"]),
            "assumption_unknown": self._unknown,
            "assumption_failure": lambda event: self._note("25 assumptions that failed"),
            "adaptation_repeated": lambda event: self._note("21 repeats that changed nothing"),
            "limit": lambda event: self._note("15 deeds that outlived their limit"),
            "zeno": lambda event: self._note("16 livelocks"),
            "crowded": lambda event: self._note("29 instances beyond the budget turned away"),
            "storm": lambda event: self._note("32 situations that failed too often"),
            "watchdog": lambda event: self._note("watchdog: the machine was stopped"),
            "planner_began": lambda event: self._note("1 planners that resumed on what stood"),
        }  # fmt: skip

    def event(self, event: Event) -> None:
        if (count := self._kinds.get(event.kind)) is not None:
            count(event)

    def begins(self) -> None:
        """A reactor begins: nothing is under way."""
        self._gone.clear()
        self._come.clear()

    @property
    def half(self) -> bool:
        """Has a committed adaptation removed something, and not brought in all that it adds?"""
        side = self._stage.side
        under_way = side.reactor.transactions.under_way if side is not None else ()
        return any(
            t.state == "committed" and self._gone.intersection(t.adaptation.kills)
            and not self._come.issuperset(t.adaptation.adds) for t in under_way
        )  # fmt: skip

    def sum_up(self) -> None:
        """What was counted by others."""
        wire, counts, rows = self._stage.wire.counts, self._stage.shop.counts, self._rows
        rows.update({f"4 frames {what.replace('_', '-')}": n for what, n in wire.items()})
        rows["6 moves resumed after the drive was gone"] += counts["resumed"]
        rows["7 frames of a planner whose time is over"] += wire["over"]
        rows["13 commands abandoned by the reactor"] += self._stage.watch.totals["commands abandoned by itself"]
        rows["12 deeds of a version whose successor is there"] += self._stage.watch.late_versions
        rows["14 deeds that raised"] += counts["raised"]
        rows["what only a process noticed, and fails still"] += self._stage.watch.totals["failures to be known"]
        rows["25 readings that slipped"] += counts["slips"]

    def _note(self, row: str) -> None:
        self._rows[row] += 1

    def _received(self, event: Event) -> None:
        if not self._stage.under_way:
            self.begins()

    def _applied(self, event: Event) -> None:
        side = self._stage.side
        assert side is not None
        transaction = side.reactor.last_applied
        assert transaction is not None
        self._stage.watch.applied(transaction.adaptation)
        self._note(f"applied by {transaction.adaptation.mode}")

    def _timed_out(self, event: Event) -> None:
        """Row 8: what it waited for is still on."""
        side = self._stage.side
        assert side is not None
        found = [p.adaptation for (_, n), p in self._stage.book.pending.items() if n == event.data["id"]]
        named = {change.situation for a in found for change in a.changes} | {s for a in found for s in a.removed}
        if any(side.reactor.situations.named(situation).instances for situation in named):
            self._note("8 situations that did not end in time")

    def _refused(self, event: Event) -> None:
        reason, side = event.data["reason"], self._stage.side
        if (row := BY_REASON.get(reason)) is not None:
            self._note(row)
        found = [p for (_, n), p in self._stage.book.pending.items() if n == event.data["id"]]
        if side is not None and found and reason != "halted" and (row := BY_WRONG.get(found[0].wrong)) is not None:
            self._note(row)

    def _draining(self, event: Event) -> None:
        side = self._stage.side
        if side is not None:
            on = [i for i in side.reactor.situations.named(event.data["situation"]).instances.values() if i.bodies]
            self._rows["9 drained while instances overlapped"] += len(on) > 1

    def _unknown(self, event: Event) -> None:
        if (row := BY_DOUBT.get(event.data.get("cause", ""))) is not None:
            self._note(row)
