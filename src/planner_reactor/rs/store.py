"""The store S = (I, H, D, Q, run): situation instances and what holds them back (docs/language.md).

An immutable value with one method per change; `settled` draws the consequences that belong to the same step:
what is withdrawn or disabled and not in service ends as failed, what has ended cancels its descendants, a
queued ASSERT whose owner is gone fails. The reactor keeps the same store in a faster form and is held against
this one.

Owners of an inhibition are roots of the configuration (`int`), or a failed assumption (`("assumption",
name)`).
"""

from __future__ import annotations

from collections.abc import Callable, Collection
from typing import Literal, TypeAlias

import msgspec
from msgspec.structs import replace

from planner_reactor.rs.states import InstanceNumber, Reaction
from planner_reactor.rs.terms import Value

Status: TypeAlias = Literal["on", "ok", "ab"]
Owner: TypeAlias = int | tuple[str, str]
Kind: TypeAlias = Literal["inhibit", "drain", "assumption"]


class Instance(msgspec.Struct, frozen=True, cache_hash=True):
    """(s, k, args, status, values, owner): one assertion of a situation."""

    number: InstanceNumber
    situation: str
    arguments: tuple[Value, ...] = ()
    owner: InstanceNumber | None = None
    status: Status = "on"
    values: tuple[Value, ...] = ()
    withdrawn: bool = False
    stub: bool = False
    awaited: bool = True
    cause: str = ""
    version: int = 0


class Inhibition(msgspec.Struct, frozen=True, cache_hash=True):
    """Nothing of the situation is served; `drain` and `assumption` also hold its ASSERTs back."""

    situation: str
    owner: Owner
    kind: Kind


class QueuedAssert(msgspec.Struct, frozen=True, cache_hash=True):
    """An ASSERT held back; `fate` is set once it is released (its instance) or has failed (the cause).

    One that was migrated is `kept` if the process that asserted it is removed: it is not `awaited` then.
    """

    ticket: InstanceNumber
    situation: str
    arguments: tuple[Value, ...]
    owner: InstanceNumber | None
    fate: InstanceNumber | str | None = None
    kept: bool = False
    awaited: bool = True


Versions: TypeAlias = tuple[tuple[str, int], ...]
"""The newest version of each situation that was renewed; 0 for the others."""


class Store(msgspec.Struct, frozen=True, cache_hash=True):
    instances: tuple[Instance, ...] = ()  # I, oldest first
    inhibitions: tuple[Inhibition, ...] = ()  # H
    drains: tuple[tuple[str, int], ...] = ()  # D: situation, root
    queue: tuple[QueuedAssert, ...] = ()  # Q, in order
    run: tuple[tuple[InstanceNumber, Reaction], ...] = ()  # bodies in service
    served: tuple[tuple[Reaction, InstanceNumber], ...] = ()  # last served last
    versions: Versions = ()
    born: tuple[tuple[Value, Versions], ...] = ()  # label of a reaction, the versions with which it was posted
    retired: tuple[tuple[Value, Versions], ...] = ()  # and the last that it serves
    next_number: int = 1
    cut: int = 0  # bodies aborted from outside: a safe adaptation leaves it at 0 (law 2)

    # -- questions

    def get(self, number: int) -> Instance | None:
        return next((i for i in self.instances if i.number == number), None)

    def in_service(self, number: int) -> bool:
        return any(k == number for k, _ in self.run)

    def holds_back(self, situation: str) -> bool:
        """Do ASSERTs of this situation queue?"""
        return any(s == situation for s, _ in self.drains) or any(
            h.situation == situation and h.kind != "inhibit" for h in self.inhibitions
        )

    def inhibited(self, situation: str) -> bool:
        return any(h.situation == situation for h in self.inhibitions)

    def disabled(self, situation: str) -> bool:
        return any(h.situation == situation and h.kind == "assumption" for h in self.inhibitions)

    def disabled_by(self, situation: str) -> str | None:
        """The failed assumption that disabled the situation first, of those that do."""
        owners = [h.owner for h in self.inhibitions if h.situation == situation and h.kind == "assumption"]
        return str(owners[0][1]) if owners else None  # type: ignore[index]  # ("assumption", name)

    def gone(self, owner: InstanceNumber | None) -> bool:
        """Has this owner ended, or is it being withdrawn?"""
        if owner is None:
            return False
        instance = self.get(owner)
        return instance is None or instance.status != "on" or instance.withdrawn

    def complete(self, number: int) -> bool:
        """Ended, and so have its bodies in service and its descendants."""
        instance = self.get(number)
        return (
            instance is not None
            and instance.status != "on"
            and not self.in_service(number)
            and not any(i.owner == number for i in self.instances)
        )

    def quiescent(self, situation: str) -> bool:
        """No instance on or in service, descendants included (complete ones have left the store)."""
        return not any(i.situation == situation for i in self.instances)

    def available(self, situation: str, reaction: Reaction) -> Instance | None:
        """The instance that a SIT of this reaction delivers now: least recently served first (rule SIT)."""
        if self.inhibited(situation) or any(s == situation for s, _ in self.drains):
            return None
        order = {k: n for n, (g, k) in enumerate(self.served) if g == reaction}
        free = [
            i
            for i in self.instances
            if i.situation == situation
            and i.status == "on"
            and not i.withdrawn
            and (i.number, reaction) not in self.run
            and self.serves(reaction, i)
        ]
        return min(free, key=lambda i: (order.get(i.number, -1), i.number), default=None)

    def version(self, situation: str) -> int:
        """The version that an instance takes when it is asserted now."""
        return dict(self.versions).get(situation, 0)

    def serves(self, reaction: Reaction, instance: Instance) -> bool:
        """Does the reaction serve instances of this version? From the one it was posted with to its last."""
        posted, last = dict(self.born).get(reaction.guard), dict(self.retired).get(reaction.guard)
        return (posted is None or dict(posted).get(instance.situation, 0) <= instance.version) and (
            last is None or instance.version <= dict(last).get(instance.situation, 0)
        )

    def older(self, situation: str, version: int) -> bool:
        """Is any instance of an older version left?"""
        return any(i.situation == situation and i.version < version for i in self.instances)

    def above(self, owner: InstanceNumber | None, situation: str) -> bool:
        """Is an instance of this situation the owner, or above it?"""
        while owner is not None:
            instance = self.get(owner)
            if instance is None:
                return False
            if instance.situation == situation:
                return True
            owner = instance.owner
        return False

    # -- changes

    def changed(self, number: int, **fields: object) -> Store:
        return replace(
            self,
            instances=tuple(
                replace(i, **fields) if i.number == number else i for i in self.instances
            ),
        )

    def asserted(
        self, situation: str, arguments: tuple[Value, ...], owner: InstanceNumber | None
    ) -> tuple[Store, InstanceNumber]:
        number = InstanceNumber(self.next_number)
        new = Instance(number, situation, arguments, owner, version=self.version(situation))
        return replace(self, instances=(*self.instances, new), next_number=self.next_number + 1), number

    def queued(
        self, situation: str, arguments: tuple[Value, ...], owner: InstanceNumber | None
    ) -> tuple[Store, InstanceNumber]:
        ticket = InstanceNumber(-1 - max((-q.ticket for q in self.queue), default=0))
        entry = QueuedAssert(ticket, situation, arguments, owner)
        return replace(self, queue=(*self.queue, entry)), ticket

    def left_queue(self, ticket: int) -> Store:
        return replace(self, queue=tuple(q for q in self.queue if q.ticket != ticket))

    def abandoned_in_queue(self, ticket: int) -> Store:
        """N9: a queued ASSERT was aborted; it leaves the queue, unless it was migrated."""
        if any(q.ticket == ticket and q.kept and q.fate is None for q in self.queue):
            queue = tuple(replace(q, awaited=False) if q.ticket == ticket else q for q in self.queue)
            return replace(self, queue=queue)
        return self.left_queue(ticket)

    def migrated(self, situation: str, change: Callable[[tuple[Value, ...]], tuple[Value, ...] | None]) -> Store:
        """MIGRATE: what is held back takes other arguments; what has none fails."""
        store = self
        for entry in self.queue:
            if entry.situation == situation and entry.fate is None:
                if (arguments := change(entry.arguments)) is None:
                    store = store._fated(entry, "error")
                else:
                    new = replace(entry, arguments=arguments, kept=True)
                    store = replace(store, queue=tuple(new if q.ticket == new.ticket else q for q in store.queue))
        return store

    def ended(self, number: int, *, ok: bool, cause: str = "failed") -> Store:
        """SUCCEED or FAIL (first wins; on an instance that is being withdrawn SUCCEED acts as FAIL)."""
        instance = self.get(number)
        if instance is None or instance.status != "on":
            return self
        if instance.withdrawn:
            ok, cause = False, "withdrawn"
        elif not ok and cause == "failed" and instance.stub:
            cause = "stub"
        return self.changed(number, status="ok" if ok else "ab", cause="" if ok else cause)

    def abandoned(self, number: int) -> Store:
        """N9: the await of this instance was aborted; it ends as failed and nobody collects it."""
        return self.ended(number, ok=False, cause="cancelled").changed(number, awaited=False)

    def entered(self, number: InstanceNumber, reaction: Reaction) -> Store:
        return replace(self, run=(*self.run, (number, reaction)))

    def left(self, number: InstanceNumber, reaction: Reaction) -> Store:
        return replace(self, run=tuple(r for r in self.run if r != (number, reaction)))

    def stamped(self, number: InstanceNumber, reaction: Reaction) -> Store:
        kept = tuple(s for s in self.served if s != (reaction, number))
        return replace(self, served=(*kept, (reaction, number)))

    def without(self, number: int) -> Store:
        return replace(
            self,
            instances=tuple(i for i in self.instances if i.number != number),
            served=tuple(s for s in self.served if s[1] != number),
        )

    def inhibit(self, situation: str, owner: Owner, kind: Kind) -> Store:
        return replace(self, inhibitions=(*self.inhibitions, Inhibition(situation, owner, kind)))

    def uninhibit(self, situation: str, owner: Owner, kind: Kind | None = None) -> Store:
        """Take away this owner's latest inhibition of the situation, if it has one (else no effect)."""
        for index in reversed(range(len(self.inhibitions))):
            held = self.inhibitions[index]
            if held.situation == situation and held.owner == owner and kind in (None, held.kind):
                kept = (*self.inhibitions[:index], *self.inhibitions[index + 1 :])
                return replace(self, inhibitions=kept).released(situation)
        return self

    def drain(self, situation: str, root: int) -> Store:
        """DRAIN begins: new ASSERTs queue; every on instance and all its descendants are withdrawn."""
        return replace(self, drains=(*self.drains, (situation, root))).withdrawing(situation)

    def withdrawing(self, situation: str) -> Store:
        """Every on instance of the situation and all its descendants are withdrawn."""
        store = self
        doomed = [i.number for i in store.instances if i.situation == situation and i.status == "on"]
        while doomed:
            number = doomed.pop()
            store = store.changed(number, withdrawn=True)
            doomed += [i.number for i in store.instances if i.owner == number and i.status == "on"]
        return store

    def drain_ended(self, situation: str, root: int) -> Store:
        index = self.drains.index((situation, root))
        return replace(self, drains=(*self.drains[:index], *self.drains[index + 1 :]))

    def renewed(self, situation: str) -> Store:
        """RENEW: the next version begins. Of a disabled situation, what is on is given up: it rests on the old."""
        versions = {**dict(self.versions), situation: self.version(situation) + 1}
        store = replace(self, versions=tuple(sorted(versions.items())))
        return store.withdrawing(situation) if store.disabled(situation) else store

    def posted(self, label: Value) -> Store:
        """A reaction is added: it serves what is asserted from its versions on."""
        if not self.versions:
            return self
        others = tuple(entry for entry in self.born if entry[0] != label)
        return replace(self, born=(*others, (label, self.versions)))

    def retire(self, label: Value) -> Store:
        """A reaction serves nothing that is asserted after the next RENEW."""
        if any(entry[0] == label for entry in self.retired):
            return self
        return replace(self, retired=(*self.retired, (label, self.versions)))

    def guarded_by(self, labels: Collection[Value]) -> Store:
        """What is known of reactions whose guards are gone is forgotten."""
        return replace(
            self,
            born=tuple(entry for entry in self.born if entry[0] in labels),
            retired=tuple(entry for entry in self.retired if entry[0] in labels),
        )

    def released(self, situation: str) -> Store:
        """The queue of this situation becomes instances, in order, unless something still holds it back."""
        if self.holds_back(situation):
            return self
        store = self
        for entry in self.queue:
            if entry.situation == situation and entry.fate is None:
                store, number = store.asserted(situation, entry.arguments, entry.owner)
                store = store._fated(entry, number)
                store = store if entry.awaited else store.changed(number, awaited=False)
        return store

    def root_ended(self, root: int) -> Store:
        """What an owner still holds when it ends is released (law 5)."""
        store = self
        for held in self.inhibitions:
            if held.owner == root:
                store = store.uninhibit(held.situation, root)
        return store

    def _fated(self, entry: QueuedAssert, fate: InstanceNumber | str) -> Store:
        if not entry.awaited:
            return self.left_queue(entry.ticket)
        queue = tuple(replace(q, fate=fate) if q.ticket == entry.ticket else q for q in self.queue)
        return replace(self, queue=queue)

    def settled(self) -> Store:
        """The consequences that belong to the same step, to the end."""
        if not self.instances and not self.queue:
            return self
        store = self
        while (after := store._once_settled()) is not store:
            store = after
        return store

    def _once_settled(self) -> Store:
        store = self
        for i in self.instances:
            if i.status == "on":
                if (i.withdrawn or self.disabled(i.situation)) and not self.in_service(i.number):
                    store = store.ended(i.number, ok=False, cause="withdrawn" if i.withdrawn else "assumption")
            else:
                for child in self.instances:
                    if child.owner == i.number and child.status == "on":
                        store = store.ended(child.number, ok=False, cause="cancelled")
                if not i.awaited and store.complete(i.number):
                    store = store.without(i.number)
        for entry in self.queue:
            if entry.fate is None and store.gone(entry.owner):
                store = store._fated(entry, "withdrawn")
        return store
