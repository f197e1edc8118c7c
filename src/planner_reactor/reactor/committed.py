"""What the adaptations have made of a reactor: all that must survive a crash (docs/reactor.md, law 8).

A value, changed only by the records of a journal: `after(adaptation)` is the one place where it is said what an applied
adaptation comes to. The running reactor holds one, its journal another, and both must be equal. What it is *doing* (its
situations, bodies, drains) is not kept: a crash ends that, and the world is sensed anew.
"""

from __future__ import annotations

from collections.abc import Mapping
from zlib import crc32

import msgspec
from msgspec.structs import replace

from planner_reactor.link.messages import Adaptation
from planner_reactor.reactor.persistent import Persistent
from planner_reactor.rs.parser import parse_program
from planner_reactor.rs.printer import show
from planner_reactor.rs.reactions import REACTION


class Taken(msgspec.Struct, frozen=True):
    """The ids of one epoch's adaptations that were taken: all up to `floor`, and some `above` it (law 6).

    A planner numbers what it issues 1, 2, …, so that `above` stays short however long a reactor lives.
    """

    floor: int = 0
    above: tuple[int, ...] = ()

    def __contains__(self, number: object) -> bool:
        return isinstance(number, int) and (0 < number <= self.floor or number in self.above)

    def with_(self, number: int) -> Taken:
        """These and one more."""
        if number in self:
            return self
        floor, above = self.floor, {*self.above, number}
        while floor + 1 in above:
            floor += 1
            above.remove(floor)
        return Taken(floor, tuple(sorted(above)))


REMEMBERED = 64
"""Of so many applied adaptations it is known what they were, so that they can be acknowledged again."""

_encode = msgspec.msgpack.Encoder(enc_hook=str).encode


def digest(adaptation: Adaptation) -> int:
    """Tells apart adaptations that have the same id."""
    return crc32(_encode(adaptation))


class Committed(msgspec.Struct, frozen=True):
    """The structure of a reactor: clauses by label, and what is known of situations and assumptions."""

    clauses: Mapping[int, str] = msgspec.field(default_factory=dict)  # label → text of `P[label] = …`
    versions: Mapping[str, int] = msgspec.field(default_factory=dict)  # of each situation that ever was
    rests_on: Mapping[str, tuple[str, ...]] = msgspec.field(default_factory=dict)
    adopted: tuple[str, ...] = ()
    failed: tuple[str, ...] = ()
    highest_label: int = -1
    epoch: int = 0
    taken: Taken = Taken()
    halted: bool = False
    applied: tuple[tuple[int, int], ...] = ()  # (id, digest) of the latest of this epoch
    given_up: tuple[str, ...] = ()  # assumptions that the latest planner does without

    def claimed(self, epoch: int) -> Committed:
        """What it is once a planner has been given an epoch of its own."""
        return replace(self, epoch=epoch, taken=Taken(), applied=())

    def was_applied(self, adaptation: Adaptation) -> bool:
        """Is it one of the latest that were applied, unchanged?"""
        if adaptation.epoch != self.epoch or adaptation.id not in self.taken:  # who asks has mostly a new one
            return False
        return (adaptation.id, digest(adaptation)) in self.applied

    def begun(self, adaptation: Adaptation) -> Committed:
        """What it is once this adaptation was admitted: its labels are used, and an older planner's time is over."""
        used = replace(self, highest_label=max([self.highest_label, *adaptation.adds]))
        if adaptation.given_up is not None and adaptation.epoch >= self.epoch:
            used = replace(used, given_up=adaptation.given_up)
        return used if adaptation.epoch <= self.epoch else used.claimed(adaptation.epoch)

    def decided(self, number: int, epoch: int) -> Committed:
        """What it is once an adaptation was applied or came to nothing: its id is spent, if its epoch is not over.

        With the first of a later epoch the earlier one is over.
        """
        if epoch < self.epoch:
            return self
        now = self if epoch == self.epoch else self.claimed(epoch)
        return replace(now, taken=now.taken.with_(number))

    def spent(self, epoch: int, number: int) -> bool:
        """Was an adaptation with this id, of this epoch, applied, or did it come to nothing?"""
        return epoch == self.epoch and number in self.taken

    def after(self, adaptation: Adaptation) -> Committed:
        """What it is once this adaptation, which was admitted, has been applied."""
        versions: dict[str, int] = {}
        for situation in (*(change.situation for change in adaptation.changes), *adaptation.removed):
            versions[situation] = versions.get(situation, self.versions.get(situation, 0)) + 1
        rests_on = {c.situation: c.assumptions for c in adaptation.changes if c.situation not in adaptation.removed}
        mine = adaptation.epoch == self.epoch
        known = (*self.applied[1 - REMEMBERED :], (adaptation.id, digest(adaptation))) if mine else self.applied
        return replace(
            self.decided(adaptation.id, adaptation.epoch),
            clauses=Persistent.of(self.clauses).changed(clauses_of(adaptation), without=adaptation.kills),
            versions=Persistent.of(self.versions).changed(versions),
            rests_on=Persistent.of(self.rests_on).changed(rests_on, without=adaptation.removed),
            adopted=tuple(sorted({*self.adopted, *adaptation.adopts} - {*adaptation.drops})),
            applied=known,
        )

    def without(self, label: int) -> Committed:
        """What it is once this reaction has ended by itself."""
        return replace(self, clauses=Persistent.of(self.clauses).changed({}, without=[label]))

    def told(self, assumption: str, *, holds: bool) -> Committed:
        """What it is once it is known that an assumption fails, or holds again."""
        others = {a for a in self.failed if a != assumption}
        return replace(self, failed=tuple(sorted(others if holds else {*others, assumption})))

    @property
    def assumptions_in_use(self) -> tuple[str, ...]:
        """The assumptions that its reactions rest on, or that were brought in with them and are watched; sorted."""
        return tuple(sorted({a for names in self.rests_on.values() for a in names} | {*self.adopted}))

    def resting_on(self, assumption: str) -> tuple[str, ...]:
        """The situations that rest on an assumption, in the order in which they came."""
        return tuple(s for s, assumptions in self.rests_on.items() if assumption in assumptions)


def clauses_of(adaptation: Adaptation) -> Mapping[int, str]:
    """The clauses that an adaptation adds, by label, each in canonical print."""
    if (found := _printed.get(adaptation.definitions)) is None:
        program = parse_program(adaptation.definitions)
        found = {s.head[0].value: show(s) for s in program.schemas if s.name == REACTION}  # type: ignore[union-attr, misc]
        remember(adaptation.definitions, found)
    return found


def remember(definitions: str, clauses: Mapping[int, str]) -> None:
    """A text that was read before it is committed, or is recovered again and again, need not be read once more."""
    _printed[definitions] = clauses
    if len(_printed) > REMEMBERED:
        del _printed[next(iter(_printed))]


_printed: dict[str, Mapping[int, str]] = {}
