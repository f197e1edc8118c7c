"""From a formula to an automaton that accepts exactly its runs (generalised Büchi, acceptance on transitions).

A state is the set of formulas that the rest of the run has to make true. Reading a moment, each of them is taken apart
into what must be true now and what must be true from the next moment on; an `until` may be put off, but not for ever: a
run is accepted if each is fulfilled, or not asked, again and again. The tableau is Couvreur's (FM 1999).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeAlias

import msgspec

from planner_reactor.analysis.observing import Atom
from planner_reactor.analysis.temporal import (
    Both,
    Either,
    Formula,
    Here,
    Negation,
    Next,
    Release,
    Truth,
    Until,
    normal,
    parts,
)

Duties: TypeAlias = frozenset[Formula]


class Edge(msgspec.Struct, frozen=True):
    """Taken at a moment at which all atoms of `true` and none of `false` are true; bits as in the automaton's atoms.

    `kept` has a bit for each `until` that this edge does not put off.
    """

    true: int
    false: int
    after: int
    kept: int

    def reads(self, seen: int) -> bool:
        return seen & self.true == self.true and not seen & self.false


class Automaton(msgspec.Struct, frozen=True):
    """States 0, 1, …, from 0; a run is accepted if each bit of `all_kept` comes again and again. In the state `free`,
    if there is one, nothing is asked any more: whatever comes is accepted.
    """

    edges: tuple[tuple[Edge, ...], ...]
    all_kept: int
    free: int | None = None


class _Way(msgspec.Struct, frozen=True):
    """One way to read a moment: what must be true now, what from then on, what is put off."""

    true: int = 0
    false: int = 0
    later: Duties = frozenset()
    put_off: Duties = frozenset()

    def covers(self, other: _Way) -> bool:
        """Does it accept whatever the other accepts?"""
        return (
            self.true & other.true == self.true
            and self.false & other.false == self.false
            and self.later <= other.later
            and self.put_off <= other.put_off
        )


def automaton(formula: Formula, atoms: Sequence[Atom]) -> Automaton:
    """The automaton of a formula; bit n of a moment is the n-th atom."""
    formula = normal(formula)
    bits = {atom: 1 << number for number, atom in enumerate(atoms)}
    untils = {until: 1 << number for number, until in enumerate(dict.fromkeys(_untils(formula)))}
    everything = (1 << len(untils)) - 1
    states: dict[Duties, int] = {frozenset({formula}): 0}
    edges: list[tuple[Edge, ...]] = []
    waiting = list(states)
    for duties in waiting:  # grows while it is read
        found = []
        for way in _ways(duties, bits):
            if way.later not in states:
                states[way.later] = len(states)
                waiting.append(way.later)
            kept = everything & ~sum(untils[until] for until in way.put_off)
            found.append(Edge(way.true, way.false, states[way.later], kept))
        edges.append(tuple(found))
    return Automaton(tuple(edges), everything, states.get(frozenset()))


def _untils(formula: Formula) -> list[Formula]:
    found = [until for part in parts(formula) for until in _untils(part)]
    return [formula, *found] if isinstance(formula, Until) else found


def _ways(duties: Duties, bits: dict[Atom, int]) -> list[_Way]:
    """Every way to read a moment with these duties, without those that another covers."""
    found: list[_Way] = []
    waiting: list[tuple[tuple[Formula, ...], _Way]] = [(_sorted(duties), _Way())]
    while waiting:
        todo, way = waiting.pop()
        if not todo:
            if not way.true & way.false:
                found.append(way)
            continue
        waiting += [((*now, *todo[1:]), new) for now, new in _apart(todo[0], way, bits)]
    found = list(dict.fromkeys(found))
    return [
        way for n, way in enumerate(found)
        if not any(other.covers(way) and (m < n or not way.covers(other)) for m, other in enumerate(found) if m != n)
    ]  # fmt: skip


def _apart(formula: Formula, way: _Way, bits: dict[Atom, int]) -> list[tuple[tuple[Formula, ...], _Way]]:
    """The ways to make a formula true: what else must be true now, and the way so far with what is read or left."""
    match formula:
        case Truth(value):
            return [((), way)] if value else []
        case Here(atom):
            return [((), msgspec.structs.replace(way, true=way.true | bits[atom]))]
        case Negation(Here(atom)):
            return [((), msgspec.structs.replace(way, false=way.false | bits[atom]))]
        case Both(left, right):
            return [((left, right), way)]
        case Either(left, right):
            return [((right,), way), ((left,), way)]
        case Next(body):
            return [((), _later(way, body))]
        case Until(left, right):
            put_off = msgspec.structs.replace(_later(way, formula), put_off=way.put_off | {formula})
            return [((left,), put_off), ((right,), way)]
        case Release(left, right):
            return [((right,), _later(way, formula)), ((left, right), way)]
        case _:
            raise AssertionError(f"not in normal form: {formula}")


def _later(way: _Way, formula: Formula) -> _Way:
    return msgspec.structs.replace(way, later=way.later | {formula})


def _sorted(duties: Duties) -> tuple[Formula, ...]:
    return tuple(sorted(duties, key=repr))
