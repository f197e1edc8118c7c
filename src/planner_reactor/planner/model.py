"""What the planner knows of the reactor: its own record of what it issued and what was applied (R §7.1, R_t).

One `Segment` for each situation: its reaction, the version of it that the reactor has, how it was refined
and on which assumptions it rests. The situations form an acyclic digraph; what a situation may count on
(its `Context`) is what all that assert it grant. `impossible` segments are those for which no plan was
found, with the reason.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping

import msgspec
from msgspec.structs import replace

from planner_reactor.logic.formulas import Atom
from planner_reactor.planner.because import Because
from planner_reactor.planner.reactions import Names
from planner_reactor.planner.situations import Child, Context, Refinement, Situation


class Segment(msgspec.Struct):
    """One situation in the reactor, as far as is known.

    `path` leads to it from the root, by the places of calls; what comes earlier in the text is planned
    earlier. `refinement` is None for a stub. `pending` is the adaptation under way that changes it.
    `stale`: it has to be planned again, because an assumption, a caller or the knowledge changed.
    """

    situation: Situation
    name: str
    path: tuple[int, ...]
    context: Context
    refinement: Refinement | None = None
    text: str = ""  # of its reaction, as it was issued last
    label: int | None = None
    version: int = 0
    pending: int | None = None
    stale: bool = False
    urgency: int = 3  # see agenda
    turn: int = 0  # so often others came first, because it takes long and a failure is to be answered
    impossible: str = ""
    refusals: int = 0
    avoided: frozenset[str] = frozenset()
    settled: bool = False
    asked: tuple[Atom, ...] = ()
    because: tuple[Because, ...] = ()  # why it is open
    stood_below: frozenset[str] = frozenset()  # what stood above it since assumptions changed, and does not any more

    @property
    def above(self) -> frozenset[str]:
        """The abstract actions that stand above it, or did since assumptions changed."""
        return self.context.forbidden | self.stood_below

    @property
    def is_stub(self) -> bool:
        return self.refinement is None

    @property
    def required(self) -> frozenset[str]:
        """The assumptions on which its reaction rests."""
        return self.refinement.required if self.refinement else frozenset()

    @property
    def in_use(self) -> frozenset[str]:
        """The assumptions that it rests on or brings in."""
        return self.refinement.in_use if self.refinement else frozenset()

    @property
    def children(self) -> tuple[Child, ...]:
        return self.refinement.children if self.refinement else ()

    @property
    def is_open(self) -> bool:
        """Is something to be done about it, now or as soon as the adaptation under way is applied?"""
        return (self.refinement is None or self.stale) and not self.impossible


class Drafted(msgspec.Struct, eq=False):
    """Refinements that are not in the model yet, and who calls what in them."""

    refinements: dict[Situation, Refinement] = msgspec.field(default_factory=dict)
    calls: dict[Situation, dict[Situation, list[Child]]] = msgspec.field(default_factory=dict)

    def add(self, refinement: Refinement) -> None:
        self.refinements[refinement.situation] = refinement
        for child in refinement.children:
            self.calls.setdefault(child.situation, {}).setdefault(refinement.situation, []).append(child)


class Model(msgspec.Struct, eq=False):
    """All segments, in the order in which they came up. `roots` are the goals, with the labels of what asserts them."""

    roots: dict[Situation, int | None] = msgspec.field(default_factory=dict)
    instead: dict[Situation, tuple[Situation, ...]] = msgspec.field(default_factory=dict)  # goals that stand in
    names: Names = msgspec.field(default_factory=Names)
    segments: dict[Situation, Segment] = msgspec.field(default_factory=dict)
    uses: dict[str, int] = msgspec.field(default_factory=dict)  # assumption → segments that rest on it or bring it in
    former: Mapping[str, int] = msgspec.field(default_factory=dict)  # versions of what stood before this model, by name
    _calls: dict[Situation, dict[Situation, tuple[Child, ...]]] = msgspec.field(default_factory=dict)
    _versions: dict[Situation, int] = msgspec.field(default_factory=dict)

    def __iter__(self) -> Iterator[Segment]:
        return iter(self.segments.values())

    def named(self, name: str) -> Segment | None:
        """The segment of the situation with this name."""
        situation = self.names.named(name)
        return None if situation is None else self.segments.get(situation)

    def new(self, situation: Situation, context: Context, path: tuple[int, ...] = ()) -> Segment:
        """A segment that is not in the model yet; its version goes on from where a removed one ended."""
        name = self.names[situation]
        version = self._versions.get(situation, self.former.get(name, 0))
        return Segment(situation, name, path, context, version=version)

    def put(self, segment: Segment, refinement: Refinement | None) -> None:
        """Record a segment with this refinement, replacing what was recorded before."""
        self._forget(segment)
        segment.refinement = refinement
        self.segments[segment.situation] = segment
        for assumption in segment.in_use:
            self.uses[assumption] = self.uses.get(assumption, 0) + 1
        calls: dict[Situation, list[Child]] = {}
        for child in segment.children:
            calls.setdefault(child.situation, []).append(child)
        for situation, children in calls.items():
            self._calls.setdefault(situation, {})[segment.situation] = tuple(children)

    def remove(self, segment: Segment) -> None:
        self._forget(segment)
        self._versions[segment.situation] = segment.version
        self.segments.pop(segment.situation, None)

    def is_removed(self, situation: Situation) -> None:
        """The reactor has removed it, which counts as a version."""
        before = self._versions.get(situation, self.former.get(self.names[situation], 0))
        self._versions[situation] = before + 1

    def _forget(self, segment: Segment) -> None:
        if segment.situation in self.segments:
            if segment.refinement is None:
                return
            for assumption in segment.refinement.in_use:
                self.uses[assumption] -= 1
                if not self.uses[assumption]:
                    del self.uses[assumption]
            for child in segment.refinement.children:
                self._calls[child.situation].pop(segment.situation, None)

    def callers(self, situation: Situation) -> tuple[Situation, ...]:
        return tuple(self._calls.get(situation, ()))

    def context(self, situation: Situation, drafted: Drafted | None = None) -> Context:
        """What the situation may count on: what every call of it grants, also those of a draft."""
        calls: list[Child] = []
        forbidden = {situation.schema}
        new = drafted.calls.get(situation, {}) if drafted else {}
        for caller, children in self._calls.get(situation, {}).items():
            if drafted is None or caller not in drafted.refinements:
                calls.extend(children)
                forbidden |= self.segments[caller].context.forbidden
        for caller, own in new.items():
            calls.extend(own)
            forbidden |= self._forbidden(caller, drafted)
        return Context(_granted(calls), _replayed(calls), frozenset(forbidden))

    def _forbidden(self, situation: Situation, drafted: Drafted | None) -> frozenset[str]:
        if situation in self.segments:
            return self.segments[situation].context.forbidden
        return self.context(situation, drafted).forbidden

    def renew_contexts(self, situations: Iterable[Situation]) -> list[Segment]:
        """Work out anew what these may count on, and those below them; the segments for which it matters."""
        changed: list[Segment] = []
        waiting = list(dict.fromkeys(situations))
        while waiting:
            segment = self.segments.get(waiting.pop(0))
            if segment is None or segment.situation in self.roots:
                continue
            context = self.context(segment.situation)
            if context == segment.context:
                continue
            if _matters(segment, context):
                changed.append(segment)
            segment.stood_below = segment.above
            segment.context = context
            waiting.extend(child.situation for child in segment.children)
        return changed

    def begin_anew(self) -> Iterator[Segment]:
        """All segments: assumptions change, and what stood above them before counts no more."""
        for segment in self:
            segment.stood_below = frozenset()
            yield segment

    def why(self, situation: Situation, drafted: Drafted) -> tuple[Because, ...]:
        """Why a situation is new: a draft has a situation assert it."""
        return tuple(Because("caller", self.names[caller]) for caller in drafted.calls.get(situation, ()))

    def orphans(self, segment: Segment, children: Iterable[Child]) -> list[Segment]:
        """What nothing asserts any more once the segment has these children instead of its own; top-down."""
        kept = {child.situation for child in children}
        gone: list[Segment] = []
        leaving = {segment.situation}
        waiting = [c.situation for c in segment.children if c.situation not in kept]
        while waiting:
            situation = waiting.pop(0)
            own = self.segments.get(situation)
            if own is None or own in gone or situation in kept:
                continue
            if set(self.callers(situation)) <= leaving:
                gone.append(own)
                leaving.add(situation)
                waiting.extend(child.situation for child in own.children)
        return gone

    def left_by(self, root: Situation) -> list[Segment]:
        """What nothing asserts any more once this goal is gone; top-down."""
        kept: set[Situation] = set()
        waiting = [r for r in self.roots if r != root]
        while waiting:
            segment = self.segments.get(waiting.pop())
            if segment is not None and segment.situation not in kept:
                kept.add(segment.situation)
                waiting.extend(child.situation for child in segment.children)
        return sorted((s for s in self if s.situation not in kept), key=lambda s: s.path)

    def used(self) -> list[str]:
        """The assumptions in use."""
        return list(self.uses)

    def snapshot(self, situations: Iterable[Situation]) -> list[tuple[Situation, Segment | None]]:
        """What is recorded of these, to be `restored` if an adaptation is not applied."""
        return [(s, replace(self.segments[s]) if s in self.segments else None) for s in situations]

    def restore(self, snapshot: Iterable[tuple[Situation, Segment | None]]) -> None:
        for situation, segment in snapshot:
            if situation in self.segments:
                self.remove(self.segments[situation])
            if segment is not None:
                self.put(segment, segment.refinement)


def _granted(calls: list[Child]) -> tuple[bool, ...]:
    if len(calls) == 1:
        return calls[0].granted
    return tuple(all(granted) for granted in zip(*(call.granted for call in calls), strict=True))


def _replayed(calls: list[Child]) -> frozenset[int] | None:
    """Is it asserted again after it succeeded, and which inputs are then the same?"""
    if len(calls) == 1:
        return calls[0].replayed
    found: frozenset[int] | None = None
    for n, call in enumerate(calls):
        if call.replayed is not None:
            found = (found or frozenset()) | call.replayed
        for other in calls[:n]:
            if _may_be_same(call, other):
                found = (found or frozenset()) | frozenset(range(len(call.arguments)))
    return found


def _may_be_same(one: Child, other: Child) -> bool:
    return not any(
        isinstance(a, str) and isinstance(b, str) and a != b
        for a, b in zip(one.arguments, other.arguments, strict=True)
    )


def _matters(segment: Segment, context: Context) -> bool:
    """Could the segment look different with this context?"""
    before = segment.context
    if context.granted != before.granted or context.replayed != before.replayed:
        return True
    refinement = segment.refinement
    return refinement is not None and bool(refinement.blocked & (before.forbidden - context.forbidden))
