"""Refinements that were worked out before, for use under beliefs that say the same about them.

What a refinement depends on is the situation, its context, and the assumptions that it rests on or looked
for in vain: it serves again wherever those that it uses hold and those that it missed do not. Situations
that differ only in constants that the domain does not tell apart share one refinement, with the constants
exchanged.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

from planner_reactor.logic.formulas import Term
from planner_reactor.planner.beliefs import Beliefs, told_apart
from planner_reactor.planner.situations import Context, Refinement, Situation
from planner_reactor.planner.theory import Theory

MOST = 20_000
"""So many refinements are kept; then all are forgotten."""


@dataclass(slots=True)
class Memory:
    """Remembers refinements for one theory; `worked_out` counts those that were not remembered."""

    theory: Theory
    worked_out: int = 0
    _known: dict[object, list[Refinement]] = field(default_factory=dict)
    _count: int = 0

    def recall(
        self, situation: Situation, context: Context, beliefs: Beliefs, work_out: Callable[[], Refinement]
    ) -> Refinement:
        """The refinement, from memory or worked out now."""
        apart = told_apart(beliefs.relaxed)
        kinds = tuple(a if a in apart else self._kind(a) for a in situation.arguments)
        same = tuple(situation.arguments.index(a) for a in situation.arguments)
        key = (situation.schema, kinds, same, context, beliefs.told)
        for known in self._known.get(key, ()):
            if known.serves(beliefs.relaxed):
                return self._moved(known, situation)
        self.worked_out += 1
        found = work_out()
        self._count += 1
        if self._count > MOST:
            self._known.clear()
            self._count = 1
        self._known.setdefault(key, []).append(found)
        return found

    def _kind(self, argument: Term | None) -> object:
        kind = self.theory.alike.get(argument) if isinstance(argument, str) else None
        return ("kind", kind) if kind is not None else argument

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
