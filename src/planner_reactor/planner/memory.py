"""Refinements that were worked out before, for use under beliefs that say the same about them.

What a refinement depends on is the situation, its context, and the assumptions that it rests on or looked
for in vain: it serves again wherever those that it uses hold and those that it missed do not. Situations
that differ only in constants that the domain does not tell apart share one refinement, with the constants
exchanged. What is still being worked out is remembered, too, and goes on for whichever of them asks next.
"""

from __future__ import annotations

from typing import TypeAlias

import msgspec

from planner_reactor.logic.formulas import Atom, Term
from planner_reactor.planner.beliefs import Beliefs, told_apart
from planner_reactor.planner.model import Segment
from planner_reactor.planner.situations import Context, Refinement, Situation
from planner_reactor.planner.theory import Theory
from planner_reactor.planner.thinking import Work

Key: TypeAlias = "tuple[str, tuple[object, ...], tuple[int, ...], Context, frozenset[tuple[Atom, bool]]]"
MOST = 20_000
"""So many refinements are kept; then all are forgotten."""


class Thought(msgspec.Struct, eq=False):
    """A refinement that is being worked out under these beliefs; `units` since it was taken up."""

    key: Key
    beliefs: Beliefs
    work: Work[Refinement]
    units: int = 0


class Memory(msgspec.Struct, eq=False):
    """Remembers refinements for one theory; `worked_out` counts those that were not remembered."""

    theory: Theory
    worked_out: int = 0
    _known: dict[Key, list[Refinement]] = msgspec.field(default_factory=dict)
    _half_done: dict[Key, Thought] = msgspec.field(default_factory=dict)
    _count: int = 0

    def key(self, situation: Situation, context: Context, beliefs: Beliefs) -> Key:
        """What situations have in common whose refinements are alike."""
        apart = told_apart(beliefs.relaxed)
        kinds = tuple([a if a in apart else self._kind(a) for a in situation.arguments])
        same = tuple([situation.arguments.index(a) for a in situation.arguments])
        return situation.schema, kinds, same, context, beliefs.told

    def recall(self, key: Key, situation: Situation, beliefs: Beliefs) -> Refinement | None:
        """The refinement, if it was worked out before."""
        for known in self._known.get(key, ()):
            if known.serves(beliefs.relaxed):
                return self._moved(known, situation)
        return None

    def keep(self, key: Key, found: Refinement) -> None:
        """Remember what was worked out."""
        self.worked_out += 1
        self._count += 1
        if self._count > MOST:
            self._known.clear()
            self._count = 1
        self._known.setdefault(key, []).append(found)

    def lay_aside(self, thought: Thought) -> None:
        """Others come first."""
        thought.units = 0
        relaxed = thought.beliefs.relaxed
        self._half_done = {k: t for k, t in self._half_done.items() if t.beliefs.relaxed == relaxed}
        self._half_done[thought.key] = thought

    def laid_aside(self, segment: Segment, beliefs: Beliefs) -> bool:
        """Was it begun, for this situation or for one that is alike, and laid aside?"""
        if not self._half_done:
            return False
        key = self.key(segment.situation, segment.context, beliefs)
        return key in self._half_done and self._half_done[key].beliefs.relaxed == beliefs.relaxed

    def take_up(self, key: Key, beliefs: Beliefs) -> Thought | None:
        """What was laid aside, to go on with it."""
        thought = self._half_done.get(key)
        if thought is None or thought.beliefs.relaxed != beliefs.relaxed:
            return None
        return self._half_done.pop(key)

    def _kind(self, argument: Term | None) -> object:
        return self.theory.alike.get(argument, argument) if isinstance(argument, str) else argument

    def _moved(self, known: Refinement, situation: Situation) -> Refinement:
        """The refinement with the constants of this situation and its own exchanged."""
        if known.situation == situation:
            return known
        exchange: dict[Term, Term] = {}
        for old, new in zip(known.situation.arguments, situation.arguments, strict=True):
            if old is not None and old != new:
                exchange[old] = new
        for old, new in list(exchange.items()):
            exchange.setdefault(new, old)
        return known.renamed(exchange)
