"""The text of a reaction, written once and filled in for every situation that is alike.

A hundred kinds of parts have a hundred reactions that differ in names. A `Sheet` is the text of one of them in
which every name of a situation and every constant is a hole; its holes are filled with those of another. So
what a further reaction costs does not depend on how long it is to write.
"""

from __future__ import annotations

import re
from functools import lru_cache
from typing import TypeAlias

import msgspec

from planner_reactor.logic.formulas import Term
from planner_reactor.planner import reactions
from planner_reactor.planner.reactions import Names
from planner_reactor.planner.situations import Composition, Refinement, Situation
from planner_reactor.rs.printer import show
from planner_reactor.rs.terms import Expression, Process, Symbol

MOST = 20_000
"""So many sheets are kept; then all are forgotten."""
_HOLE = re.compile("\0(\\d+)\0")


class Constant(msgspec.Struct, frozen=True):
    """A hole for a constant of the domain."""

    term: Term


Hole: TypeAlias = Constant | Situation


class Sheet(msgspec.Struct, frozen=True):
    """`text` has `%s` where a hole is; `places` are the numbers of the holes in the order of the text."""

    text: str
    holes: tuple[Hole, ...]
    places: tuple[int, ...]

    def filled(self, refinement: Refinement, names: Names) -> str:
        """The text for this refinement, which is alike."""
        constants = refinement.exchanged
        values = [
            _shown(constants.get(hole.term, hole.term))
            if isinstance(hole, Constant)
            else names[hole.renamed(constants) if constants else hole]
            for hole in self.holes
        ]
        return self.text % tuple([values[place] for place in self.places])


@lru_cache(4096)
def _shown(term: Term) -> str:
    return show(reactions.constant(term))


class _Lettering:
    """Stands where names would, and remembers them. No text of RS has a NUL in it."""

    def __init__(self) -> None:
        self._holes: dict[Hole, Symbol] = {}

    def situation(self, situation: Situation) -> Symbol:
        return self._hole(situation)

    def constant(self, term: Term) -> Expression:
        return self._hole(Constant(term))

    def _hole(self, hole: Hole) -> Symbol:
        return self._holes.setdefault(hole, Symbol(f"\0{len(self._holes)}\0"))

    def sheet(self, process: Process) -> Sheet:
        literals = _HOLE.split(show(process).replace("%", "%%"))
        places = tuple(int(number) for number in literals[1::2])
        return Sheet("%s".join(literals[::2]), tuple(self._holes), places)


class Sheets(msgspec.Struct, eq=False):
    """Writes reactions; the sheets of refinements that came up are kept."""

    names: Names
    fold: bool
    _reactions: dict[int, tuple[Composition, Sheet]] = msgspec.field(default_factory=dict)
    _stubs: dict[tuple[int, int], Sheet] = msgspec.field(default_factory=dict)

    def share(self, other: Sheets) -> None:
        """Use the sheets of another, which may have other names."""
        self._reactions, self._stubs = other._reactions, other._stubs

    def reaction(self, refinement: Refinement) -> str:
        """The reaction of a refined situation."""
        composition = refinement.composition
        assert composition is not None
        known = self._reactions.get(id(composition))
        if known is None:
            lettering = _Lettering()
            process = reactions.reaction(refinement.situation_first, composition, lettering, fold=self.fold)
            known = composition, lettering.sheet(process)
            if len(self._reactions) >= MOST:
                self._reactions.clear()
            self._reactions[id(composition)] = known  # holds the composition, so that its id stays its own
        return known[1].filled(refinement, self.names)

    def stub(self, situation: Situation, period_ms: int) -> str:
        """The reaction of a situation that is not refined yet."""
        key = situation.arguments.count(None), period_ms
        sheet = self._stubs.get(key)
        if sheet is None:
            lettering = _Lettering()
            sheet = self._stubs[key] = lettering.sheet(reactions.stub(situation, lettering, period_ms))
        return sheet.text % ((self.names[situation],) * len(sheet.places))
