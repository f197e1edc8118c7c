"""Situations, what they may count on, and how they are made concrete: plain data (R §7.2).

A `Situation` is an abstract action with its constants; a `Refinement` is one way to make it concrete, with
everything that follows for others: its sub-situations, what it rests on, what has to be cleaned up.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache

import msgspec

from planner_reactor.logic.formulas import Atom, Numeral, Term
from planner_reactor.planner.beliefs import all_in_doubt, some_in_doubt
from planner_reactor.planner.structure import Action, Tree, first_action, renamed


class Situation(msgspec.Struct, frozen=True, cache_hash=True):
    """An abstract action as a situation: constants are part of it, None stands for what it is asserted
    with.
    """

    schema: str
    arguments: tuple[Term | None, ...] = ()

    def renamed(self, constants: Mapping[Term, Term]) -> Situation:
        """The same situation of other constants."""
        return Situation(self.schema, tuple([a if a is None else constants.get(a, a) for a in self.arguments]))


class Context(msgspec.Struct, frozen=True, cache_hash=True):
    """What a situation may count on, whoever asserts it.

    `granted` tells for each executability condition whether it lasts while the situation does. `replayed`
    is None if the situation is never asserted again after it succeeded, else the inputs that are then the
    same. `forbidden` are the abstract actions above it.
    """

    granted: tuple[bool, ...] = ()
    replayed: frozenset[int] | None = None
    forbidden: frozenset[str] = frozenset()


class Child(msgspec.Struct, frozen=True):
    """A sub-situation as one call uses it."""

    situation: Situation
    arguments: tuple[Term, ...]
    granted: tuple[bool, ...]
    replayed: frozenset[int] | None

    def renamed(self, constants: Mapping[Term, Term]) -> Child:
        arguments = tuple([constants.get(a, a) for a in self.arguments])
        return Child(self.situation.renamed(constants), arguments, self.granted, self.replayed)


class Composition(msgspec.Struct, frozen=True):
    """What a situation does. `outputs` are its results in each branch; `cleanup` has to be done if it fails after
    one of the actions `upsets`.
    """

    tree: Tree
    outputs: tuple[tuple[Term, ...], ...] = ()
    cleanup: tuple[Action, ...] = ()
    upsets: frozenset[Action] = frozenset()


class Refinement(msgspec.Struct, frozen=True):
    """How a situation is made concrete; `composition` is None if no plan was found.

    `required` are the assumptions that it rests on, `presumed` those that it only brings in, `missing` relaxed
    ones that were looked for, `asked` conditions that nobody knows, `blocked` actions that stand too high to be
    used. A refinement may be that of another situation with constants `exchanged`: its composition is shared,
    and speaks of the first one's.
    """

    situation: Situation
    composition: Composition | None
    children: tuple[Child, ...] = ()
    required: frozenset[str] = frozenset()
    presumed: frozenset[str] = frozenset()
    missing: frozenset[str] = frozenset()
    asked: tuple[Atom, ...] = ()
    blocked: frozenset[str] = frozenset()
    warnings: tuple[str, ...] = ()
    gave_up: bool = False
    in_use: frozenset[str] = frozenset()  # what it rests on or brings in
    exchanged: dict[Term, Term] = {}
    unreachable: tuple[str, ...] = ()  # predicates that nothing brings about, where that is why there is no plan

    @property
    def situation_first(self) -> Situation:
        """The situation of which the composition speaks."""
        back = {new: old for old, new in self.exchanged.items()}
        return self.situation.renamed(back) if back else self.situation

    @property
    def tree(self) -> Tree | None:
        """The composition of this situation's own actions."""
        tree = None if self.composition is None else self.composition.tree
        return renamed(tree, self.exchanged) if tree is not None and self.exchanged else tree

    @property
    def begins_with(self) -> Action | None:
        """Its first action, in the order of the text."""
        first = None if self.composition is None else first_action(self.composition.tree)
        return first.renamed(self.exchanged) if first is not None and self.exchanged else first

    def serves(self, relaxed: frozenset[str]) -> bool:
        """Would it be the same with these assumptions relaxed?"""
        return (
            not some_in_doubt(self.required, relaxed)
            and not some_in_doubt(self.presumed, relaxed)
            and all_in_doubt(self.missing, relaxed)
        )

    def why_impossible(self, name: str) -> str:
        """Where no plan was found: what would have been needed."""
        reasons = []
        if self.unreachable:
            reasons.append("nothing brings about " + " or ".join(self.unreachable))
        if self.gave_up:
            reasons.append("the search was given up")
        if self.asked:
            reasons.append("not known: " + ", ".join(map(str, self.asked)))
        if self.missing:
            reasons.append("not without " + " or ".join(sorted(self.missing)))
        return f"no plan achieves {name}" + (f" ({'; '.join(reasons)})" if reasons else "")

    def renamed(self, constants: dict[Term, Term]) -> Refinement:
        """The same refinement for constants that the domain does not tell apart."""
        assert not self.exchanged
        names: tuple[frozenset[str], ...] = (self.required, self.presumed, self.missing, self.in_use)
        if any(map(_speak_of_constants, names)):
            names = tuple([_renamed_names(some, constants) for some in names])
        required, presumed, missing, in_use = names
        return Refinement(
            self.situation.renamed(constants),
            self.composition,
            tuple([child.renamed(constants) for child in self.children]),
            required,
            presumed,
            missing,
            tuple([Atom(a.predicate, tuple([constants.get(t, t) for t in a.arguments])) for a in self.asked]),
            self.blocked,
            self.warnings,
            self.gave_up,
            in_use,
            constants,
            self.unreachable,
        )


def _renamed_names(names: frozenset[str], constants: Mapping[Term, Term]) -> frozenset[str]:
    """Names of assumptions, those with arguments for other constants."""
    found = set()
    for name in names:
        whole, bracket, arguments = name.partition("(")
        if bracket:
            name = f"{whole}({','.join(str(constants.get(a, a)) for a in arguments[:-1].split(','))})"
        found.add(name)
    return frozenset(found)


@lru_cache(4096)
def _speak_of_constants(names: frozenset[str]) -> bool:
    return any("(" in name for name in names)


def situation_of(action: Action, *, fold: bool) -> Situation:
    """The situation that an abstract action asserts; with `fold` constants become part of it."""
    constants = tuple(a if fold and isinstance(a, str | Numeral) else None for a in action.arguments)
    return Situation(action.name, constants)
