"""Guards: the only two ways in which a running reactor's structure changes (R §5.3, equations (3) and (4)).

`KILL[n]` meets `E[n]` when nothing of n's reaction is in service: it never cuts, it waits. `POST[n]` meets `ADD<m>`.
A guard is known from the moment its `#` comes to life, so that KILL sees it at once.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field

from planner_reactor.reactor.controls import ERROR, STOPPED, BuiltIn
from planner_reactor.reactor.situations import Situations
from planner_reactor.reactor.wakers import Waker
from planner_reactor.rs.terms import Value
from planner_reactor.rs.vocabulary import BUILT_IN
from planner_reactor.runtime import Outcome, Strand


@dataclass(slots=True, eq=False)
class Guarded:
    """One guarded reaction that is alive."""

    label: Value
    strand: Strand
    siblings: tuple[Strand, ...]
    waiting: bool = False  # its E has begun to wait, and can be killed
    killers: list[Strand] = field(default_factory=list)


class Guard:
    """E[n]: waits until it is killed."""

    name = "E"
    signature = BUILT_IN["E"]
    opens_body = False
    guards = True
    resting = True
    announces = False

    def __init__(self, guards: Guards) -> None:
        self._guards = guards

    def guard_set(self, label: Value, strand: Strand, siblings: tuple[Strand, ...]) -> None:
        self._guards.set_up(Guarded(label, strand, siblings))

    def start(self, strand: Strand, arguments: tuple[Value, ...]) -> Outcome | None:
        return self._guards.waits(strand)

    def cancel(self, strand: Strand) -> None:
        self._guards.over(strand)


class Guards:
    """The guarded reactions by label, who wants to kill them, and who wants labels added."""

    def __init__(
        self,
        situations: Situations,
        waker: Waker,
        notice: Callable[..., None],
        by_itself: Callable[[Value], None],
    ) -> None:
        self._situations = situations
        self._waker = waker
        self._notice = notice
        self._by_itself = by_itself
        self._by_label: dict[Value, Guarded] = {}
        self._by_strand: dict[Strand, Guarded] = {}
        self._refused: dict[Strand, Guarded] = {}  # their label was in use when they came to life
        self._killing: dict[Strand, Guarded] = {}
        self._adders: deque[Strand] = deque()
        self._posters: dict[Strand, Value] = {}

    def __iter__(self) -> Iterator[BuiltIn | Guard]:
        yield Guard(self)
        yield BuiltIn("KILL", self._kill, self._left_kill)
        yield BuiltIn("RETIRE", self._retire)
        yield BuiltIn("ADD", self._add, self._adders.remove, resting=True)
        yield BuiltIn("POST", self._post, self._left_post)

    @property
    def labels(self) -> tuple[Value, ...]:
        return tuple(self._by_label)

    def set_up(self, guarded: Guarded) -> None:
        if guarded.label in self._by_label:
            self._refused[guarded.strand] = guarded
            return
        self._by_label[guarded.label] = guarded
        self._by_strand[guarded.strand] = guarded
        self._notice("added", label=guarded.label)
        for poster in [p for p, label in self._posters.items() if label == guarded.label]:
            self._waker.wake(poster)  # to be refused: the label is in use now

    def waits(self, strand: Strand) -> Outcome | None:
        if (late := self._refused.pop(strand, None)) is not None and late.label not in self._by_label:
            self.set_up(late)
        guarded = self._by_strand.get(strand)
        if guarded is None:  # its label is in use, or it stands in no `#`: it guards nothing
            return ERROR
        guarded.waiting = True
        self._retry(guarded)
        return None

    def over(self, strand: Strand, *, killed: bool = False) -> None:
        """What it guards was killed; or it has ended by itself, or the whole was aborted."""
        self._refused.pop(strand, None)
        guarded = self._by_strand.pop(strand, None)
        if guarded is not None:
            del self._by_label[guarded.label]
            self._situations.serving.forget_guard(guarded.label)
            if not killed:
                self._by_itself(guarded.label)
            self._notice("removed", label=guarded.label)
            self._retry(guarded)

    def at_rest(self, label: Value) -> bool:
        """Is nothing of this reaction in service?"""
        guarded = self._by_label[label]
        return all(self._waker.resting(sibling) for sibling in guarded.siblings)

    def _kill(self, strand: Strand, arguments: tuple[Value, ...]) -> Outcome | None:
        guarded = self._by_label.get(arguments[0])
        self._killing.pop(strand, None)
        if guarded is None:
            self._notice("absent_guard", label=arguments[0])
            return ERROR
        if not guarded.waiting or not self.at_rest(guarded.label):
            guarded.killers.append(strand)
            self._killing[strand] = guarded
            self._waker.watch(guarded.label, lambda: self._retry(guarded))
            return None
        self._waker.ended(guarded.strand, True, (), "")
        self.over(guarded.strand, killed=True)
        return STOPPED

    def _retire(self, strand: Strand, arguments: tuple[Value, ...]) -> Outcome:
        if arguments[0] not in self._by_label:
            self._notice("absent_guard", label=arguments[0])
            return ERROR
        self._situations.serving.retire(arguments[0])
        self._notice("retired", label=arguments[0])
        return STOPPED

    def _left_kill(self, strand: Strand) -> None:
        guarded = self._killing.pop(strand)
        if strand in guarded.killers:
            guarded.killers.remove(strand)

    def _retry(self, guarded: Guarded) -> None:
        """It may have come to rest: who wants to kill it tries again."""
        self._waker.watch(guarded.label, None)
        killers, guarded.killers = guarded.killers, []
        for killer in killers:
            self._waker.wake(killer)

    def _add(self, strand: Strand, arguments: tuple[Value, ...]) -> Outcome | None:
        self._adders.append(strand)
        self._wake_a_poster()
        return None

    def _post(self, strand: Strand, arguments: tuple[Value, ...]) -> Outcome | None:
        label = arguments[0]
        self._posters.pop(strand, None)
        if label in self._by_label:
            self._wake_a_poster()
            return ERROR
        if not self._adders:
            self._posters[strand] = label
            return None
        self._situations.versions.born(label)
        self._waker.ended(self._adders.popleft(), True, (label,), "")
        return STOPPED

    def _left_post(self, strand: Strand) -> None:
        """N9: it is aborted while it waits."""
        del self._posters[strand]
        self._wake_a_poster()

    def _wake_a_poster(self) -> None:
        """An ADD that no poster has met is for the first that waits, also if one that was woken did not use it."""
        if self._adders and self._posters:
            self._waker.wake(next(iter(self._posters)))
