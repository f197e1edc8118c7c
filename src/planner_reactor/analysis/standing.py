"""The reactor as a planner keeps it, so that what an adaptation touches is found without looking at the rest.

Reactions are found by their label, by the situation that they serve, and by those that they assert. `around` gives the
few of them that a slice is made of: those that serve what is kept, and those that ask for it from outside. `shape` says
what the slice would be, without making it: two adaptations of one shape have the same slice.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Iterator, Mapping, Sequence
from math import inf
from typing import Protocol

import msgspec

from planner_reactor.analysis.forms import Known
from planner_reactor.analysis.slicing import AT_ONCE, unknown_names
from planner_reactor.rs.bounds import Bounds
from planner_reactor.rs.reactions import Surgery
from planner_reactor.rs.terms import Program, operands
from planner_reactor.rs.vocabulary import Signature


class Around(msgspec.Struct, frozen=True):
    """The reactions of a reactor that matter to an adaptation, in the order of the reactor; `idle` monitors go."""

    kept: frozenset[str]
    inside: tuple[Known, ...]
    outside: tuple[Known, ...]
    idle: tuple[Known, ...]


class Windows(Protocol):
    """What bounds are worked out from."""

    @property
    def signatures(self) -> Mapping[str, Signature]: ...
    @property
    def limits(self) -> Mapping[str, float]: ...


class Standing:
    """Reactions that come and go. What has a situation above it is above it by a reaction that asserts it."""

    def __init__(self) -> None:
        self.changes = 0  # so often something has come or gone
        self._reactions: dict[int, Known] = {}
        self._came: dict[int, int] = {}
        self._next = 0
        self._serving: dict[str, dict[int, Known]] = {}
        self._asking: dict[str, dict[int, Known]] = {}
        self._vague: dict[int, Known] = {}
        self._environment: Windows | None = None
        self._bounds: dict[str, float] = {}
        self._alike: dict[Hashable, float] = {}

    def __len__(self) -> int:
        return len(self._reactions)

    def __contains__(self, label: int) -> bool:
        return label in self._reactions

    def add(self, reaction: Known) -> None:
        """It comes; what had its label goes."""
        label = reaction.label
        if label in self._reactions:
            self.remove(label)
        self.changes += 1
        self._reactions[label] = reaction
        self._came[label] = self._next
        self._next += 1
        if reaction.situation is not None:
            self._serving.setdefault(reaction.situation, {})[label] = reaction
        for name in reaction.asserts:
            self._asking.setdefault(name, {})[label] = reaction
        if reaction.form.unknown is not None:
            self._vague[label] = reaction
        self._changed(reaction.situation)

    def remove(self, label: int) -> Known | None:
        """It goes, if it is there."""
        reaction = self._reactions.pop(label, None)
        if reaction is not None:
            self.changes += 1
            if reaction.situation is not None:
                del self._serving[reaction.situation][label]
            for name in reaction.asserts:
                del self._asking[name][label]
            self._vague.pop(label, None)
            self._changed(reaction.situation)
        return reaction

    def serving(self, situation: str) -> tuple[Known, ...]:
        """What serves it, in the order of coming."""
        return tuple(self._serving.get(situation, {}).values())

    def above(self, situation: str) -> Iterator[str]:
        """The situations from which it is asserted."""
        return (r.situation for r in self._asking.get(situation, {}).values() if r.situation is not None)

    def vague(self, new: Iterable[Known]) -> tuple[int, str] | None:
        """A reaction, there or new, that asserts what is worked out at run time: its label, and what it asserts."""
        for reaction in (*self._vague.values(), *new):
            if reaction.form.unknown is not None:
                return reaction.label, next(unknown_names(reaction.reaction.schema.body))
        return None

    def came(self, reaction: Known) -> int:
        """Its turn in the order of coming."""
        return self._came[reaction.label]

    def drains(self, situations: Iterable[str], environment: Windows) -> float:
        """Seconds in which these situations have been drained, one after the other (`rs.bounds`)."""
        if environment is not self._environment:
            self._environment = environment
            self._bounds.clear()
            self._alike.clear()
        return sum(self._drain(name) for name in situations)

    def _drain(self, situation: str) -> float:
        """Worked out once, until something changes in it or below it; once for all that are alike."""
        if (known := self._bounds.get(situation)) is not None:
            return known
        self._bounds[situation] = inf  # asserted from below itself: no bound
        serving = self.serving(situation)
        below = {name: self._drain(name) for reaction in serving for name in reaction.asserts}
        alike = tuple([(r.form.number, tuple([below[name] for name in r.asserts])) for r in serving])
        seconds = self._alike.get(alike)
        if seconds is None:
            schemas = [r.reaction.schema for r in serving]
            bodies = tuple(operands(schema.body)[1] for schema in schemas)
            assert self._environment is not None
            signatures, limits = self._environment.signatures, self._environment.limits
            seconds = Bounds(Program(schemas), signatures, limits, lambda _: bodies, below).situation(situation)
            self._alike[alike] = seconds
        self._bounds[situation] = seconds
        return seconds

    def _changed(self, situation: str | None) -> None:
        """What is known of its drain, and of those above it, holds no more."""
        waiting = [] if situation is None else [situation]
        while waiting:
            name = waiting.pop()
            if self._bounds.pop(name, None) is not None:
                waiting += self.above(name)

    # ------------------------------------------------------------------------------------------ what is around it

    def around(self, new: Sequence[Known], surgery: Surgery) -> Around:
        """What matters to this surgery."""
        killed = [self._reactions[n] for n in surgery.kills if n in self._reactions]
        adds = frozenset(surgery.adds)
        moved = [*killed, *(r for r in new if r.label in adds)]
        touched = {*surgery.held, *surgery.named, *(r.situation for r in moved if r.situation is not None)}
        kept = frozenset(touched | self._between(touched, new))
        inside = {r.label: r for name in kept for r in self._serving.get(name, {}).values()}
        inside |= {r.label: r for r in killed}
        outside = {r.label: r for name in kept for r in self._asking.get(name, {}).values() if r.label not in inside}
        idle = tuple([r for r in killed if r.form.monitors])
        return Around(kept, self._in_order(inside), self._in_order(outside), idle)

    def _in_order(self, reactions: dict[int, Known]) -> tuple[Known, ...]:
        labels = sorted(reactions, key=self._came.__getitem__)
        return tuple([reactions[n] for n in labels if not reactions[n].form.monitors])

    def _between(self, touched: set[str], new: Sequence[Known]) -> set[str]:
        """What lies below something touched and above something touched: few are above, so upwards first."""
        asking: dict[str, list[str]] = {}
        for reaction in new:
            if reaction.situation is not None:
                for name in reaction.asserts:
                    asking.setdefault(name, []).append(reaction.situation)
        edges: dict[str, list[str]] = {}  # from above, among what is above
        seen: set[str] = set()
        waiting = list(touched)
        above: set[str] = set()
        while waiting:
            name = waiting.pop()
            if name in seen:
                continue
            seen.add(name)
            for parent in (*self.above(name), *asking.get(name, ())):
                edges.setdefault(parent, []).append(name)
                above.add(parent)
                waiting.append(parent)
        below: set[str] = set()
        waiting = list(touched)
        while waiting:
            for name in edges.get(waiting.pop(), ()):
                if name not in below:
                    below.add(name)
                    waiting.append(name)
        return below & above


def shape(around: Around, new: Sequence[Known], surgery: Surgery) -> Hashable:
    """What the slice depends on: forms, and which names are the same. Equal shapes have equal slices.

    Situations are numbered as they come in the reactions of the slice, as `slicing.sliced` numbers them.
    """
    kept = around.kept
    coming = [r for r in new if not r.form.monitors]
    reactions = [*around.inside, *coming]
    idle = {r.label for r in (*new, *around.idle) if r.form.monitors}
    names: dict[str, int] = {}
    for reaction in reactions:
        for name in (reaction.situation, *reaction.asserts):
            if name in kept and name not in names:
                names[name] = len(names)
    for name in sorted(kept.difference(names)):
        names[name] = len(names)
    labels = {r.label: n for n, r in enumerate(reactions)}
    asked = [0] * len(names)
    for reaction in around.outside:
        for name in reaction.asserts:
            if name in kept:
                asked[names[name]] += AT_ONCE if reaction.form.spawns else 1
    return (
        len(around.inside),
        tuple([(r.form.number, tuple([names.get(name) for name in r.names])) for r in reactions]),
        tuple([min(AT_ONCE, n) for n in asked]),
        tuple([names[s] for s in surgery.held]),
        tuple([labels.get(n, -1) for n in surgery.kills if n not in idle]),
        tuple([labels.get(n, -1) for n in surgery.adds if n not in idle]),
        frozenset([names[s] for s in surgery.named]),
        tuple([names[s] for s in surgery.removed]),
    )
