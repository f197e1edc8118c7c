"""The situation store of a running reactor: what `rs.store` says, fast and in place (R §5.1, §5.2, §5.5).

Instances with their owners, bodies in service and values; per situation its reactions, inhibitions, drains and queued
ASSERTs. Each change draws its consequences at once, without recursion, and tells the executer which waiting strands
end (`end`) or may try again (`wake`). What the processes of Tables 1 and 2 do with it is in `controls`.

Legend: s situation, k instance number, g reaction = (label of its guard or None, place of its SIT).
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterator
from math import inf
from typing import Any, TypeAlias

from planner_reactor.reactor.instances import (
    Inhibition,
    Instance,
    Kind,
    QueuedAssert,
    Reaction,
    Situation,
    Strand,
)
from planner_reactor.reactor.serving import Serving
from planner_reactor.reactor.versions import Versions
from planner_reactor.reactor.wakers import Waker

Notice: TypeAlias = Callable[..., None]


def named(owner: Hashable) -> str:
    """An owner of inhibitions, for people: an assumption, or the root that runs a script."""
    return str(owner[1]) if isinstance(owner, tuple) else str(getattr(owner, "name", owner))


class Situations:
    """I, H, D, Q and run. `notice(kind, **fields)` is told of every change; it must not change the store."""

    def __init__(self, waker: Waker, notice: Notice) -> None:
        self._waker = waker
        self.notice = self._notice = notice
        self.flipped: Callable[[str], None] = lambda name: None  # told when a situation is disabled, or enabled again
        self.awaited: Callable[[str], bool] = lambda name: False  # does anybody wait for it to be disabled?
        self._by_name: dict[str, Situation] = {}
        self.instances: dict[int, Instance] = {}
        self._awaited: dict[Strand, Instance] = {}
        self._queued: dict[Strand, QueuedAssert] = {}
        self.held_by: dict[Hashable, list[Situation]] = {}  # what an owner inhibits, in the order in which it did
        self.asserted = 0  # how many instances there ever were
        self._tickets = 0
        self.versions = Versions()
        self.serving = Serving(self.versions, waker, notice)
        self.spawned: set[str] = set()  # served by `::`: may be asserted from below themselves

    def named(self, name: str) -> Situation:
        if (situation := self._by_name.get(name)) is None:
            situation = self._by_name[name] = Situation(name)
        return situation

    def __iter__(self) -> Iterator[Situation]:
        return iter(self._by_name.values())

    @property
    def held(self) -> list[Situation]:
        """The situations that something inhibits."""
        return list(dict.fromkeys([s for held in self.held_by.values() for s in held])) if self.held_by else []

    def is_disabled(self, name: str, assumption: str) -> bool:
        return any(held.owner == ("assumption", assumption) for held in self.named(name).inhibitions)

    def disabled_by(self, name: str) -> str | None:
        """The failed assumption that disabled the situation first, of those that do."""
        owners = [held.owner for held in self.named(name).inhibitions if held.kind == "assumption"]
        return str(owners[0][1]) if owners else None  # type: ignore[index]  # ("assumption", name)

    def get(self, situation: str, number: object) -> Instance | None:
        instance = self.instances.get(number) if isinstance(number, int) else None
        return instance if instance is not None and instance.situation.name == situation else None

    # -- ASSERT, REASSERT

    def begin(
        self, name: str, arguments: tuple[object, ...], owner: Instance | None, strand: Strand, *, again: bool
    ) -> str:
        """Begin an instance, or queue. Returns "" if the strand waits, else the cause for which it fails at once."""
        if owner is not None and owner.gone:
            return "withdrawn"
        if name not in self.spawned and self._above(owner, name):
            return "error"
        situation = self.named(name)
        if situation.held_back:
            self._queue(situation, arguments, owner, strand, again)
        else:
            self._begin(situation, arguments, owner, strand, again)
        return ""

    @staticmethod
    def _above(owner: Instance | None, name: str) -> bool:
        while owner is not None:
            if owner.situation.name == name:
                return True
            owner = owner.owner
        return False

    def _begin(
        self, situation: Situation, arguments: tuple[object, ...], owner: Instance | None, strand: Strand | None,
        again: bool,
    ) -> None:  # fmt: skip
        self.asserted += 1
        version = self.versions.newest(situation.name)
        instance = Instance(self.asserted, situation, arguments, owner, strand, again, version)
        situation.instances[instance.number] = self.instances[instance.number] = instance
        if strand is not None:
            self._awaited[strand] = instance
        if owner is not None:
            owner.children[instance.number] = instance
        self._notice("asserted", situation=situation.name, instance=instance.number, arguments=arguments,
                     owner=owner.number if owner else None)  # fmt: skip
        self.serving.came(instance)

    def _queue(
        self, situation: Situation, arguments: tuple[object, ...], owner: Instance | None, strand: Strand, again: bool
    ) -> None:
        self._tickets += 1
        entry = QueuedAssert(self._tickets, situation, arguments, owner, strand, again)
        situation.queue[entry.ticket] = self._queued[strand] = entry
        if owner is not None:
            owner.queued[entry.ticket] = entry
        self._notice("queued", situation=situation.name, owner=owner.number if owner else None)

    def is_queued(self, strand: Strand) -> bool:
        return strand in self._queued

    def cancel(self, strand: Strand) -> None:
        """N9: an ASSERT is aborted. Its instance ends as failed; if it is still queued it leaves the queue."""
        if (entry := self._queued.pop(strand, None)) is not None:
            if entry.kept:
                entry.strand = None
                return
            self._unlink(entry)
            self._notice("unqueued", situation=entry.situation.name, cause="cancelled")
        elif (instance := self._awaited.pop(strand, None)) is not None:
            instance.awaiter = None
            self._end([(instance, False, "cancelled")])
            self._complete(instance)

    def migrate(self, name: str, change: Callable[[tuple[Any, ...]], tuple[object, ...] | None]) -> None:
        """MIGRATE[s, …]: what is held back takes other arguments and stays if its process goes; what has none fails."""
        for entry in list(self.named(name).queue.values()):
            if (arguments := change(entry.arguments)) is None:
                self._fail(entry, "error")
            else:
                entry.arguments, entry.kept = arguments, True
                self._notice("migrated", situation=name, arguments=arguments)

    @staticmethod
    def _unlink(entry: QueuedAssert) -> None:
        del entry.situation.queue[entry.ticket]
        if entry.owner is not None:
            del entry.owner.queued[entry.ticket]

    # -- bodies in service

    def enter(self, instance: Instance, reaction: Reaction) -> None:
        """{B}: a body of this instance is in service."""
        instance.bodies += 1
        self._notice("entered", situation=instance.situation.name, instance=instance.number, guard=reaction[0])

    def leave(self, instance: Instance, reaction: Reaction, *, cut: bool = False) -> None:
        """A body ended, or was `cut` from outside: the instance may be served again, or be complete."""
        instance.bodies -= 1
        situation = instance.situation
        self._notice("left", situation=situation.name, instance=instance.number, guard=reaction[0], cut=cut)
        if not instance.bodies and instance.status == "on" and (instance.withdrawn or situation.disabled):
            self._end([(instance, False, "withdrawn" if instance.withdrawn else "assumption")])
        self.serving.came_back(instance, reaction)
        self._complete(instance)

    # -- how instances end

    def finish(self, name: str, number: object, *, ok: bool) -> bool:
        """SUCCEED or FAIL[s,k]: the first wins; False (and no effect) on a dead instance."""
        instance = self.get(name, number)
        if instance is None or instance.status != "on":
            self._notice("late_verdict", situation=name, ok=ok)
            return False
        if instance.withdrawn and ok:
            self._notice("success_withdrawn", situation=name, instance=instance.number)
        ok = ok and not instance.withdrawn
        cause = "withdrawn" if instance.withdrawn else "stub" if instance.stub else "failed"
        self._end([(instance, ok, cause)])
        self._complete(instance)
        return True

    def _end(self, ending: list[tuple[Instance, bool, str]]) -> None:
        """Statuses are set, descendants cancelled, queued ASSERTs of the ended fail; who is complete returns."""
        done: list[Instance] = []
        while ending:
            instance, ok, cause = ending.pop()
            if instance.status != "on":
                continue
            instance.status = "ok" if ok else "ab"
            instance.cause = "" if ok else cause
            self._notice("ended", situation=instance.situation.name, instance=instance.number, ok=ok,
                         cause=instance.cause)  # fmt: skip
            self._fail_queued(instance)
            ending += [(child, False, "cancelled") for child in instance.children.values()]
            done.append(instance)
        for instance in reversed(done[1:]):
            self._complete(instance)

    def _fail_queued(self, owner: Instance) -> None:
        for entry in list(owner.queued.values()):
            self._fail(entry, "withdrawn")

    def _fail(self, entry: QueuedAssert, cause: str) -> None:
        self._unlink(entry)
        self._notice("unqueued", situation=entry.situation.name, cause=cause)
        if entry.strand is not None:
            del self._queued[entry.strand]
            self._waker.ended(entry.strand, False, (), cause)

    def _complete(self, instance: Instance | None) -> None:
        """Ended, with its bodies and descendants: the await returns; then the same for its owner."""
        while instance is not None and instance.status != "on" and not instance.bodies and not instance.children:
            if self.instances.pop(instance.number, None) is None:
                return
            situation, owner = instance.situation, instance.owner
            del situation.instances[instance.number]
            if owner is not None:
                del owner.children[instance.number]
            self._return(instance)
            if not situation.instances:
                self._quiescent(situation)
            if situation.waiting_old:
                self._older_gone(situation)
            instance = owner

    def _return(self, instance: Instance) -> None:
        strand = instance.awaiter
        self._notice("completed", situation=instance.situation.name, instance=instance.number)
        if strand is None:
            return
        del self._awaited[strand]
        owner = instance.owner
        if instance.status == "ok" or not instance.again:
            self._waker.ended(strand, instance.status == "ok", instance.values, instance.cause)
        elif owner is not None and owner.gone:
            self._waker.ended(strand, False, (), "withdrawn")
        else:
            self._waker.wake(strand)

    # -- WAIT, INHIBIT, DRAIN and their like

    def wait(self, kind: str, name: str, strand: Strand, owner: Hashable) -> None:
        """WAIT, WAITINHIBIT or DRAIN begins; it is granted inside the step that makes s quiescent."""
        situation = self.named(name)
        situation.waiters.append((kind, strand, owner))
        if kind == "DRAIN":
            situation.drains.append(owner)
            situation.held_back += 1
            self._notice("draining", situation=name)
            self._withdraw(situation)
        if not situation.instances:
            self._quiescent(situation)

    def renew(self, name: str) -> None:
        """RENEW[s]: the next version begins. Of a disabled situation, what is on is given up: it rests on the old."""
        self.versions.renew(name)
        self._notice("renewed", situation=name, version=self.versions.newest(name))
        if self.named(name).disabled:
            self._withdraw(self.named(name))

    def wait_old(self, name: str, strand: Strand) -> None:
        """WAITOLD[s]: until no instance of an older version is left, descendants included."""
        situation = self.named(name)
        situation.waiting_old.append((self.versions.newest(name), strand))
        self._older_gone(situation)

    def _older_gone(self, situation: Situation) -> None:
        oldest = next(iter(situation.instances.values()), None)
        granted = [w for w in situation.waiting_old if oldest is None or oldest.version >= w[0]]
        situation.waiting_old = [w for w in situation.waiting_old if w not in granted]
        for _, strand in granted:
            self._waker.ended(strand, True, (), "")

    def has_older(self, name: str, version: int) -> bool:
        """Is any instance of this version left, or of an older one?"""
        oldest = next(iter(self.named(name).instances.values()), None)
        return oldest is not None and oldest.version <= version

    def give_up(self, name: str, version: int) -> None:
        """What is of this version, or of an older one, is withdrawn, as by a RENEW while the situation is disabled."""
        self._withdraw(self.named(name), version)

    def _withdraw(self, situation: Situation, last: float = inf) -> None:
        withdrawn = [i for i in situation.instances.values() if i.status == "on" and i.version <= last]
        for instance in withdrawn:  # grows while it is read: descendants follow their owners
            instance.withdrawn = True
            withdrawn += [c for c in instance.children.values() if c.status == "on" and not c.withdrawn]
        for instance in withdrawn:
            self._fail_queued(instance)
        for instance in withdrawn:
            if instance.status == "on" and not instance.bodies:
                self._end([(instance, False, "withdrawn")])
                self._complete(instance)

    def _quiescent(self, situation: Situation) -> None:
        waiters, situation.waiters = situation.waiters, []
        for kind, strand, owner in waiters:
            if kind == "DRAIN":
                situation.drains.remove(owner)
                situation.held_back -= 1
                self._inhibit(situation, owner, "drain")
            elif kind == "WAITINHIBIT":
                self._inhibit(situation, owner, "inhibit")
            self._waker.ended(strand, True, (), "")

    def left_wait(self, name: str, strand: Strand, owner: Hashable) -> None:
        """N9: a WAIT, WAITINHIBIT or DRAIN is aborted; a DRAIN lets its queue go."""
        situation = self.named(name)
        if any(waiting is strand for _, waiting in situation.waiting_old):
            situation.waiting_old = [w for w in situation.waiting_old if w[1] is not strand]
            return
        kind = next(kind for kind, waiting, _ in situation.waiters if waiting is strand)
        situation.waiters = [w for w in situation.waiters if w[1] is not strand]
        if kind == "DRAIN":
            situation.drains.remove(owner)
            situation.held_back -= 1
            self._release(situation)

    def inhibit(self, name: str, owner: Hashable, kind: Kind = "inhibit") -> None:
        self._inhibit(self.named(name), owner, kind)

    def _inhibit(self, situation: Situation, owner: Hashable, kind: Kind) -> None:
        situation.inhibitions.append(Inhibition(owner, kind))
        self.held_by.setdefault(owner, []).append(situation)
        situation.held_back += kind != "inhibit"
        situation.disabled += kind == "assumption"
        self._notice("inhibited", situation=situation.name, owner=named(owner), because=kind)
        if kind == "assumption":
            self.flipped(situation.name)

    def uninhibit(self, name: str, owner: Hashable) -> bool:
        """Take away this owner's latest inhibition of s; False (and no effect) if it has none."""
        situation = self.named(name)
        for index in reversed(range(len(situation.inhibitions))):
            held = situation.inhibitions[index]
            if held.owner == owner:
                del situation.inhibitions[index]
                self.held_by[owner].remove(situation)
                situation.held_back -= held.kind != "inhibit"
                situation.disabled -= held.kind == "assumption"
                self._notice("uninhibited", situation=name, owner=named(owner))
                if held.kind == "assumption":
                    self.flipped(name)
                self._release(situation)
                return True
        self._notice("foreign_uninhibit", situation=name, owner=named(owner))
        return False

    def disable(self, name: str, assumption: str) -> None:
        """A failed assumption: what is not in service ends as failed, new ASSERTs queue, nothing is delivered."""
        situation = self.named(name)
        if any(held.owner == ("assumption", assumption) for held in situation.inhibitions):
            return
        self._inhibit(situation, ("assumption", assumption), "assumption")
        for instance in list(situation.instances.values()):
            if instance.status == "on" and not instance.bodies:
                self._end([(instance, False, "assumption")])
                self._complete(instance)

    def enable(self, name: str, assumption: str) -> bool:
        return self.uninhibit(name, ("assumption", assumption))

    def root_ended(self, owner: Hashable) -> None:
        """What an owner still holds when it ends is released (law 5)."""
        for situation in list(self.held_by.get(owner, ())):
            self.uninhibit(situation.name, owner)
        self.held_by.pop(owner, None)

    def _release(self, situation: Situation) -> None:
        if not situation.held_back:
            for entry in list(situation.queue.values()):
                self._unlink(entry)
                self._queued.pop(entry.strand, None)
                self._begin(situation, entry.arguments, entry.owner, entry.strand, entry.again)
        self.serving.offer(situation)
