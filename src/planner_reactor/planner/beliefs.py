"""The problem-solving context: what the planner takes to be so while it plans (R §7.2).

`Beliefs` hold every assumption that there is no evidence against, the domain's facts, and what the reactor
has told on request. They answer what a plan may rest on, and say which assumptions an answer used or
missed. Immutable: the planner makes new ones when it relaxes, reinstates or learns something.
"""

from __future__ import annotations

from collections.abc import Iterable
from functools import lru_cache

import msgspec
from msgspec.structs import replace

from planner_reactor.logic.domain import Assumption, Domain
from planner_reactor.logic.formulas import Atom, Bindings, Numeral


class Answer(msgspec.Struct, frozen=True):
    """Does something hold? `used` are the assumptions that it rests on, `missing` those without which
    it fails.
    """

    holds: bool
    used: frozenset[str] = frozenset()
    missing: frozenset[str] = frozenset()


_CERTAIN = Answer(True)


class Beliefs(msgspec.Struct, frozen=True):
    """Assumptions in doubt (`relaxed`), and ground atoms known beyond the domain's facts (`told`: true
    or false).
    """

    domain: Domain
    relaxed: frozenset[str] = frozenset()
    told: frozenset[tuple[Atom, bool]] = frozenset()

    def without(self, assumption: str) -> Beliefs:
        return replace(self, relaxed=self.relaxed | {assumption})

    def reinstated(self, assumption: str) -> Beliefs:
        return replace(self, relaxed=self.relaxed - {assumption})

    def learning(self, atom: Atom, *, holds: bool) -> Beliefs:
        """With an answer to a perception request; it replaces an earlier one."""
        return replace(self, told=self.told - {(atom, not holds)} | {(atom, holds)})

    def assume(self, atoms: Iterable[Atom], bindings: Bindings | None = None) -> Answer:
        """Do all of these assumptions hold? An assumption with arguments fails as a whole, or for
        them alone.
        """
        used: list[str] = []
        missing: list[str] = []
        for atom in atoms:
            name = atom.predicate
            if atom.arguments:
                name = assumption_name(bindings.ground(atom) if bindings else atom)
            (missing if in_doubt(name, self.relaxed) else used).append(name)
        return Answer(not missing, frozenset(used), frozenset(missing)) if used or missing else _CERTAIN

    def known(self, atom: Atom) -> bool | None:
        """What has been told of a ground atom; None if nothing."""
        if (atom, True) in self.told:
            return True
        return False if (atom, False) in self.told else None

    def lasting(self, atom: Atom) -> Answer:
        """Does it last until something excludes it? If its persistence rests on assumptions, only
        with them.
        """
        for persistence in self.domain.persistences.get(atom.predicate, ()):
            bindings = Bindings()
            offset = 1 + max((a for a in atom.arguments if type(a) is int), default=-1)
            pattern = persistence.atom.shifted(offset)
            if bindings.unify(pattern.arguments, atom.arguments):
                return self.assume((a.shifted(offset) for a in persistence.assumptions), bindings)
        return _CERTAIN

    def assumption(self, name: str) -> Assumption:
        """The declaration behind a name such as `A` or `A(x)`."""
        return self.domain.assumptions[name.partition("(")[0]]


def in_doubt(name: str, relaxed: frozenset[str]) -> bool:
    """Is the assumption relaxed, it or the whole that it belongs to? The whole is, too, if it is
    relaxed in part.
    """
    if not relaxed:
        return False
    whole, bracket, _ = name.partition("(")
    if name in relaxed or whole in relaxed:
        return True
    return not bracket and any(other.startswith(f"{name}(") for other in relaxed)


@lru_cache(4096)
def some_in_doubt(names: frozenset[str], relaxed: frozenset[str]) -> bool:
    """Is any of them relaxed? (Remembered: the same few sets are asked about for every situation.)"""
    return any(in_doubt(name, relaxed) for name in names)


@lru_cache(4096)
def all_in_doubt(names: frozenset[str], relaxed: frozenset[str]) -> bool:
    """Are all of them relaxed?"""
    return all(in_doubt(name, relaxed) for name in names)


@lru_cache
def told_apart(relaxed: frozenset[str]) -> frozenset[str]:
    """The constants for which alone some assumption is relaxed."""
    return frozenset(c for name in relaxed if "(" in name for c in name.partition("(")[2][:-1].split(","))


def assumption_name(atom: Atom) -> str:
    """`A`, or `A(x)` where its arguments are constants of the domain."""
    if not atom.arguments or not all(isinstance(a, str | Numeral) for a in atom.arguments):
        return atom.predicate
    return f"{atom.predicate}({','.join(map(str, atom.arguments))})"
