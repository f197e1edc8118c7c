"""Who serves which instance next: what stands behind SIT (R §5.2, rule SIT in docs/language.md).

Each reaction of a situation has a queue of the instances that it may serve, least recently served first, and the
strands that wait at its SIT. Nothing is delivered while the situation is inhibited or drained, or of a version that the
reaction does not serve.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Hashable

from planner_reactor.reactor.instances import Instance, Reaction, Served, Situation, Strand
from planner_reactor.reactor.versions import Versions
from planner_reactor.reactor.wakers import Waker


class Serving:
    """The reactions of all situations, by situation."""

    def __init__(self, versions: Versions, waker: Waker, notice: Callable[..., None]) -> None:
        self._versions = versions
        self._waker = waker
        self._notice = notice
        self._services = 0
        self._below: dict[Hashable, list[tuple[Situation, Reaction]]] = {}  # guard → whom its SITs serve

    def deliver(self, situation: Situation, reaction: Reaction, *, opens: bool) -> Instance | None:
        """The least recently served instance that this reaction may serve now (rule SIT).

        If the delivery `opens` a body, the instance is in service until it `came_back`.
        """
        if (served := situation.reactions.get(reaction)) is None:
            served = situation.reactions[reaction] = self._begun(situation, reaction[0])
            self._below.setdefault(reaction[0], []).append((situation, reaction))
        if situation.blocked:
            return None
        self._services += 1
        instance = served.take(self._services)
        if instance is not None:
            self._notice("delivered", situation=situation.name, instance=instance.number, guard=reaction[0])
            if not opens:
                served.give_back(instance)
            self._offer_to(situation, served)  # another strand may wait at the same SIT, and there may be more
        return instance

    def _begun(self, situation: Situation, label: Hashable) -> Served:
        first, last = self._versions.served(label, situation.name)
        return Served(deque(i for i in situation.instances.values() if first <= i.version <= last), first, last)

    def waits(self, situation: Situation, reaction: Reaction, strand: Strand) -> None:
        situation.reactions[reaction].waiting.append(strand)

    def left_waiting(self, situation: Situation, reaction: Reaction, strand: Strand) -> None:
        """N9: a SIT is aborted while it waits; a wake-up that it will not use goes to the next."""
        if (served := situation.reactions.get(reaction)) is None:
            return
        if strand in served.waiting:
            served.waiting.remove(strand)
        else:
            self._offer_to(situation, served)

    def came(self, instance: Instance) -> None:
        """A new instance: who serves its version may have it."""
        for served in instance.situation.reactions.values():
            if served.first <= instance.version <= served.last:
                served.fresh.append(instance)
        self.offer(instance.situation)

    def came_back(self, instance: Instance, reaction: Reaction) -> None:
        """No body of it is in service by this reaction any more: it may be served again, in its turn."""
        if (served := instance.situation.reactions.get(reaction)) is not None:
            served.give_back(instance)
            self._offer_to(instance.situation, served)

    def offer(self, situation: Situation) -> None:
        """Something may have become available: the first waiting strand of each reaction tries again."""
        for served in situation.reactions.values():
            self._offer_to(situation, served)

    def _offer_to(self, situation: Situation, served: Served) -> None:
        if served.waiting and (served.fresh or served.again) and not situation.blocked:
            self._waker.wake(served.waiting.popleft())

    def retire(self, label: Hashable) -> None:
        """RETIRE[n]: the reaction serves nothing that is asserted after the next RENEW."""
        self._versions.retire(label)
        for situation, reaction in self._below.get(label, ()):
            situation.reactions[reaction].last = self._versions.served(label, situation.name)[1]

    def forget_guard(self, label: Hashable) -> None:
        """The reaction with this guard is gone: nobody waits at its SIT any more."""
        self._versions.forget(label)
        for situation, reaction in self._below.pop(label, ()):
            del situation.reactions[reaction]
