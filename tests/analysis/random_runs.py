"""Random formulas, runs that go round, and small systems, for comparing one reading of a property with another."""

from __future__ import annotations

import random

from planner_reactor.analysis.observing import Atom
from planner_reactor.analysis.systems import Move, System
from planner_reactor.analysis.temporal import (
    FALSE,
    TRUE,
    Both,
    Either,
    Formula,
    Here,
    Negation,
    Next,
    Release,
    Until,
)
from planner_reactor.rs.configurations import Config, Label

ATOMS = (Atom("sent", "p"), Atom("sent", "q"), Atom("on", "s"))


def formula(dice: random.Random, depth: int) -> Formula:
    if depth == 0 or dice.random() < 0.15:
        return dice.choice((TRUE, FALSE, *map(Here, ATOMS), *map(Here, ATOMS)))
    match dice.choice((Negation, Next, Both, Either, Until, Release, Until, Release)):
        case made if made in (Negation, Next):
            return made(formula(dice, depth - 1))
        case made:
            return made(formula(dice, depth - 1), formula(dice, depth - 1))


def run(dice: random.Random, most: int = 6) -> tuple[list[frozenset[Atom]], int]:
    """Moments, and where the run goes back to after the last."""
    moments = [frozenset(a for a in ATOMS if dice.random() < 0.4) for _ in range(dice.randint(1, most))]
    return moments, dice.randrange(len(moments))


def bits(moment: frozenset[Atom]) -> int:
    return sum(1 << n for n, atom in enumerate(ATOMS) if atom in moment)


def label(name: str) -> Label:
    return name, (), "ok", ()


def system(moves: list[list[tuple[str, int, int]]]) -> System:
    """States with (label, next, bits) triples."""
    made = [tuple(Move(label(name), after, True, seen) for name, after, seen in found) for found in moves]
    return System(ATOMS, [Config()] * len(made), made, [0] * len(made), [None] * len(made), True)


def round_trip(moments: list[frozenset[Atom]], loop: int) -> System:
    """The system with exactly this run."""
    last = len(moments) - 1
    return system([[(f"step{n}", n + 1 if n < last else loop, bits(m))] for n, m in enumerate(moments)])


def any_system(dice: random.Random, states: int, labels: str = "abc") -> System:
    """A few states, each with some moves."""
    return system([
        [(dice.choice(labels), dice.randrange(states), dice.randrange(8)) for _ in range(dice.randint(1, 3))]
        for _ in range(states)
    ])  # fmt: skip
