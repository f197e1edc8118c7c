"""Is a law so? Its two sides on many random instances, and the smallest instance on which a non-law fails."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping
from functools import lru_cache

import msgspec

from planner_reactor.rs.configurations import Label
from planner_reactor.rs.parser import parse_process
from planner_reactor.rs.printer import show
from planner_reactor.rs.terms import ABORT, NIL, STOP, All, Call, Disable, Not, Par, Process, cond, seq
from tests.laws.table import BINDINGS, BRANCHING, CONDITIONS, STRONG, TIMED, TRACES, Law, filled
from tests.laws.terms import WORLD, Draw
from tests.laws.universe import TooLarge, Universe

TRIES = 20
"""Instances that are drawn at most for each that is wanted: beyond, a law's condition is fulfilled too seldom."""


class Checked(msgspec.Struct):
    """On how many distinct instances a law was checked under each equivalence, and where it failed."""

    counts: dict[str, int]
    failures: list[tuple[str, str, str]]


def checked(law: Law, terms: int, *, timed: bool, independent: int) -> Checked:
    """Check a law on so many distinct instances.

    The finest equivalence that the law claims is decided on all of them: who is equal under it is equal under the
    coarser ones (bindings visible < outcomes < branching, traces). The first `independent` instances, and those of
    a law that claims no fine one, are decided under each equivalence by its own procedure.
    """
    universe = Universe(WORLD)
    pairs = _instances(law, terms, universe, timed)
    claimed = [e for e in law.equivalences if (e == TIMED) == timed or e == BINDINGS]
    if timed:
        claimed = [e for e in claimed if e == TIMED or BINDINGS in law.equivalences]
    finest = next((e for e in (BINDINGS, STRONG, TIMED, BRANCHING) if e in claimed), BRANCHING)
    result = Checked(dict.fromkeys(claimed, len(pairs)), [])
    for equivalence in claimed:
        decided = pairs if equivalence == finest else pairs[:independent]
        result.failures += _failing(universe, law, equivalence, decided)
    return result


Pair = tuple[int, int, Process, Process]


def _instances(law: Law, terms: int, universe: Universe, timed: bool) -> list[Pair]:
    left, right = parse_process(law.left), parse_process(law.right)
    draw = Draw(law.name, timed=timed)
    pairs: dict[tuple[Process, Process], Pair] = {}
    for _ in range(TRIES * terms):
        instance, around = draw.instance(law.names, context=law.context, guarded=law.guarded)
        if law.condition and not CONDITIONS[law.condition](instance, WORLD):
            continue
        sides = around(filled(left, instance)), around(filled(right, instance))
        if sides[0] == sides[1] or sides in pairs:
            continue
        try:
            pairs[sides] = (universe.first(sides[0]), universe.first(sides[1]), *sides)
        except TooLarge:
            continue
        if len(pairs) == terms:
            break
    return list(pairs.values())


def _failing(universe: Universe, law: Law, equivalence: str, pairs: list[Pair]) -> Iterator[tuple[str, str, str]]:
    if equivalence == TRACES:
        ends = universe.ends(bindings=False)
        unequal = [p for p in pairs if not universe.included(*p[:2], ends) or not universe.included(p[1], p[0], ends)]
    else:
        hidden = "p" if law.context != "stable" else "ph"
        classes = universe.classes(
            [s for p in pairs for s in p[:2]],
            bindings=equivalence == BINDINGS,
            hidden=hidden if equivalence == BRANCHING else "",
        )
        unequal = [p for p in pairs if classes[p[0]] != classes[p[1]]]
    return ((equivalence, show(p[2]), show(p[3])) for p in unequal)


# -------------------------------------------------------------------------------------------------- counterexamples


class Counterexample(msgspec.Struct, frozen=True):
    """Terms on which the sides of a non-law differ, and a shortest run that only one side has."""

    terms: Mapping[str, Process]
    run: tuple[Label, ...]
    left: str
    right: str

    @property
    def size(self) -> int:
        return sum(size(t) for t in self.terms.values())


def size(process: Process) -> int:
    """Leaves and operators."""
    match process:
        case Call():
            return 1
        case Not(body):
            return 1 + size(body)
        case _:
            return sum(size(p) for p in process.parts) + len(process.parts) - 1


@lru_cache
def terms_of(wanted: int) -> tuple[Process, ...]:
    """All closed terms of this size over STOP, ABORT, NIL, a, b and `~ ; : # | &`."""
    if wanted == 1:
        return (STOP, ABORT, NIL, Call("a"), Call("b"))
    found: list[Process] = [Not(p) for p in terms_of(wanted - 1)]
    for left in range(1, wanted - 1):
        for p, q in itertools.product(terms_of(left), terms_of(wanted - 1 - left)):
            found += [seq(p, q), cond(p, q), Disable((p, q)), Par((p, q)), All((p, q))]
    return tuple(found)


def instances_of(law: Law, wanted: int) -> Iterator[dict[str, Process]]:
    """All instances of a law whose terms have this size together."""
    parts = len(law.names)
    for sizes in itertools.product(range(1, wanted - parts + 2), repeat=parts):
        if sum(sizes) == wanted:
            for terms in itertools.product(*(terms_of(s) for s in sizes)):
                yield dict(zip(law.names, terms, strict=True))


def differing(law: Law, wanted: int) -> Iterator[Counterexample]:
    """The instances of this size on which the two sides are not strongly bisimilar, outcomes included."""
    left, right = parse_process(law.left), parse_process(law.right)
    universe = Universe(WORLD)
    found = []
    for terms in instances_of(law, wanted):
        found.append((terms, universe.first(filled(left, terms)), universe.first(filled(right, terms))))
    classes = universe.classes([s for _, *sides in found for s in sides])
    for terms, first, second in found:
        if classes[first] != classes[second]:
            run, of_left, of_right = universe.apart(first, second)
            yield Counterexample(terms, run, of_left, of_right)


def smallest(law: Law, most: int = 7) -> Counterexample | None:
    """The first counterexample, by size."""
    sizes = range(len(law.names), most + 1)
    return next((found for wanted in sizes for found in differing(law, wanted)), None)
