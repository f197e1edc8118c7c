"""Does every fair run of a program have a property? And: can it get stuck, can it go round for ever at one instant?

`check` searches the runs of the program that the automaton of the negated property accepts; what it finds is a lasso,
the shortest. A verdict is None if the program has more states than were built and none of those says no.
"""

from __future__ import annotations

import msgspec
from msgspec.structs import replace

from planner_reactor.analysis.lassos import Lasso, accepted
from planner_reactor.analysis.notation import Fairness, Property
from planner_reactor.analysis.products import Justice
from planner_reactor.analysis.systems import System
from planner_reactor.analysis.tableau import Automaton, Edge, automaton
from planner_reactor.analysis.temporal import Negation
from planner_reactor.rs.configurations import Label
from planner_reactor.rs.states import InstanceNumber

NO_FAIRNESS = Justice(lambda label: -1)


class Verdict(msgspec.Struct, frozen=True):
    """`holds`, or a lasso along which it does not; None: not decided within the limit on states."""

    holds: bool | None
    counterexample: Lasso | None = None


def check(system: System, property: Property) -> Verdict:
    """Does every fair run have the property? The system must have been built with the property's atoms."""
    refuting = automaton(Negation(property.formula), system.atoms)
    return _verdict(system, accepted(system, refuting, justice(system, property.fairness)))


def deadlock_free(system: System) -> Verdict:
    """Can something always happen until all has ended? The lasso is the shortest way to where nothing can."""
    stuck = next(iter(system.deadlocks), None)
    return _verdict(system, None if stuck is None else Lasso(system.path(stuck), ()))


def zeno_free(system: System) -> Verdict:
    """Does time always get its turn? A cycle along which some step is urgent at every state keeps it from passing."""
    hasty = [any(m.urgent for m in moves) for moves in system.moves]
    moves = [tuple(replace(m, seen=int(hasty[n])) for m in found) for n, found in enumerate(system.moves)]
    marked = replace(system, moves=moves, idle=[0] * len(moves))
    round_and_round = Edge(1, 0, 1, 1)
    refuting = Automaton(((Edge(0, 0, 0, 0), round_and_round), (round_and_round,)), 1)
    return _verdict(system, accepted(marked, refuting, NO_FAIRNESS))


def _verdict(system: System, found: Lasso | None) -> Verdict:
    if found is not None:
        return Verdict(False, found)
    return Verdict(True if system.complete else None)


# ------------------------------------------------------------------------------------------------------- fairness


def justice(system: System, fairness: Fairness) -> Justice:
    """What fairness asks of the steps of a system, as bits.

    For weak fairness a kind of step is a process with its arguments, for strong fairness outcome and values besides;
    numbers of situation instances are left out.
    """
    if fairness.strength == "none":
        return NO_FAIRNESS
    strong = fairness.strength == "strong"
    kinds: dict[object, int] = {}
    of: dict[Label, int] = {}
    weak_bits = strong_bits = 0
    for moves in system.moves:
        for move in moves:
            if move.label in of:
                continue
            named = not fairness.of or move.label[0] in fairness.of
            if not named and not strong:
                of[move.label] = -1
                continue
            exact = strong and named
            number = of[move.label] = kinds.setdefault((exact, _kind(move.label, exact)), len(kinds))
            if exact:
                strong_bits |= 1 << number
            else:
                weak_bits |= 1 << number
    return Justice(lambda label: of.get(label, -1), weak_bits, strong_bits)


def _kind(label: Label, exact: bool) -> object:
    name, arguments, status, values = label
    if name == "TIME":
        return name
    return (name, _plain(arguments), status, _plain(values)) if exact else (name, _plain(arguments))


def _plain(values: tuple[object, ...]) -> tuple[object, ...]:
    return tuple(None if isinstance(v, InstanceNumber) else v for v in values)
