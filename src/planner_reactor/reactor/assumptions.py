"""What the reactor knows of assumptions, and what follows: behaviour that rests on a failed one is disabled (law 14).

Whether a reading is believed is for `readings`; here it is known that an assumption fails, or that a failed one holds
again. What is known survives a crash with the journal.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

import msgspec

from planner_reactor.link.messages import Adaptation, PerceptionKind
from planner_reactor.reactor.committed import Committed
from planner_reactor.reactor.journal import Assumed, Journal
from planner_reactor.reactor.resting import Resting
from planner_reactor.reactor.situations import Situations
from planner_reactor.runtime import Scheduler

CALM = "Calm("


def calm(situation: str) -> str:
    """What is presumed of every situation: that it does not fail again and again (see `storms`)."""
    return f"{CALM}{situation})"


class Older(msgspec.Struct, frozen=True):
    """What one adaptation of mode `versions` put an end to: the last old version of each situation, what it rested on,
    and which situations have no newer one.
    """

    versions: Mapping[str, int]
    rests_on: Mapping[str, tuple[str, ...]]
    removed: tuple[str, ...]


class Assumptions:
    """`failed` holds the assumptions that fail, and since when; `told(kind, assumption)` hears of every report."""

    def __init__(
        self,
        scheduler: Scheduler,
        journal: Journal,
        situations: Situations,
        told: Callable[[PerceptionKind, str], None],
    ) -> None:
        self._scheduler = scheduler
        self._journal = journal
        self._situations = situations
        self._told = told
        self.failed: dict[str, float] = {}
        self._resting = Resting()
        self._older: list[Older] = []  # of which something may be left

    def restored(self) -> None:
        """What the journal knows of: it fails until it is sensed to hold, and what rests on it is disabled."""
        self.failed = dict.fromkeys(self._journal.state.committed.failed, self._scheduler.now)
        self.disable()

    def resting_on(self, assumption: str) -> tuple[str, ...]:
        """The situations that rest on it; every situation rests on its own calm, which nobody has to say."""
        if assumption.startswith(CALM):
            return (assumption[len(CALM) : -1],)
        return self._resting.follow(self._journal.state.committed.rests_on).on(assumption)

    @property
    def in_use(self) -> tuple[str, ...]:
        """The assumptions that the reactions rest on, or that were brought in with them and are watched; sorted."""
        committed = self._journal.state.committed
        return tuple(sorted({*self._resting.follow(committed.rests_on), *committed.adopted}))

    def sensed(self, assumption: str, holds: bool, *, tell: bool = True) -> None:
        """It fails, or a failed one holds again: what rests on it is disabled or enabled; `tell` the planner?"""
        now = self._scheduler.now
        if not holds:
            if assumption not in self.failed:
                self.failed[assumption] = now
                self._journal.note(Assumed(assumption, False, now))
        elif self.failed.pop(assumption, None) is not None:
            self._journal.note(Assumed(assumption, True, now))
        else:
            return
        if tell and holds:
            self._told("assumption_holds", assumption)
        elif tell:
            self._told("assumption_failure", assumption)
        self.enable()
        self.disable()

    def storms(self, situation: str) -> None:
        """It fails too often: its calm has failed."""
        self.sensed(calm(situation), False, tell=False)

    def calms(self, situation: str) -> None:
        """It has new reactions, which have not failed yet."""
        self.sensed(calm(situation), True, tell=False)

    def outlived(self, adaptation: Adaptation, before: Committed) -> None:
        """In mode `versions` what is on goes on as it began: on what it rested on before this was committed."""
        if adaptation.mode != "versions":
            return
        situations = (*(c.situation for c in adaptation.changes), *adaptation.removed)
        self._older.append(
            Older(
                versions={s: self._situations.versions.newest(s) for s in situations},
                rests_on={s: before.rests_on.get(s, ()) for s in situations},
                removed=adaptation.removed,
            )
        )

    def disable(self) -> None:
        """Every situation that rests on a failed assumption is disabled by it; what is left of old versions given up.
        """
        for assumption in self.failed:
            for name in self.resting_on(assumption):
                self._situations.disable(name, assumption)
        if self._older:
            self._give_up()

    def _give_up(self) -> None:
        """A removed situation has no newer version: whoever may still assert it is given up with it."""
        left = self._situations.has_older
        self._older = [old for old in self._older if any(left(s, n) for s, n in old.versions.items())]
        for count, old in enumerate(self._older, 1):
            failed = {s for s, assumptions in old.rests_on.items() if not self.failed.keys().isdisjoint(assumptions)}
            for older in self._older[:count] if not failed.isdisjoint(old.removed) else ():
                for situation, version in older.versions.items():
                    self._situations.give_up(situation, version)
            for situation in sorted(failed):
                self._situations.give_up(situation, old.versions[situation])

    def enable(self) -> None:
        """No situation is disabled by an assumption that holds, or on which it does not rest any more."""
        rests_on = self._journal.state.committed.rests_on
        for situation in self._situations.held:
            for owner in [h.owner for h in situation.inhibitions if h.kind == "assumption"]:
                assumption = str(owner[1])  # type: ignore[index]  # ("assumption", name)
                rests = assumption in rests_on.get(situation.name, ()) or assumption == calm(situation.name)
                if assumption not in self.failed or not rests:
                    self._situations.enable(situation.name, assumption)
