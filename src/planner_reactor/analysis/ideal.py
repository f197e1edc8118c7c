"""The ω-ideal reactor as something to be checked: equations (8) and (10) to (12) of R §6.2.

    (8)   (R^ω | EM) -ω-> (R^ω | GEM)                 where ω holds, all that can happen leads to the goal
    (10)  (R^ω_j | EM) -ω' and f(e_j)-> (R^ω_j | GEM)   a partial reactor does so where ω' holds, and so does what its
                                                      unfinished parts e_j still rest on
    (11)  ω = ω' and f(e_0),  e_j > e_j+1,  e_k = 0    from ω to ω', less is unfinished with every step, up to nothing
    (12)  (R^ω | EM^γ) -ω⊆γ-> (R^ω | GEM^γ)            in a world in which exactly γ holds: wherever γ has all of ω

A reactor and an environment are texts; which assumptions hold is a choice among environments. That all leads to the
goal is a property of every fair run (`properties`).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from itertools import pairwise

import msgspec

from planner_reactor.analysis.notation import Property
from planner_reactor.analysis.properties import Verdict, check
from planner_reactor.analysis.systems import LIMIT, System, build
from planner_reactor.analysis.temporal import atoms
from planner_reactor.rs.configurations import World, spawned_situations
from planner_reactor.rs.evolves import started
from planner_reactor.rs.parser import parse_process, parse_program

Assumptions = frozenset[str]
Environment = Callable[[Assumptions], str]
"""The text of the environment, which defines `EM`, in which these assumptions fail and all others hold."""


class Reactor(msgspec.Struct, frozen=True):
    """A reactor, whose text defines `REACTOR`, and ω, the assumptions that it rests on."""

    text: str
    rests_on: Assumptions


def side_by_side(reactor: str, environment: str, goal: Property, *, limit: int = LIMIT) -> System:
    """R | EM, seen through what the goal speaks of."""
    program = parse_program(environment + reactor)
    process = parse_process("EM | REACTOR")
    world = World(program, spawned=spawned_situations(program, process))
    return build(started(process, world), world, atoms(goal.formula), limit=limit)


def achieves(reactor: str, environment: str, goal: Property, *, limit: int = LIMIT) -> Verdict:
    """(8): does every fair run of the reactor in this environment reach the goal?"""
    return check(side_by_side(reactor, environment, goal, limit=limit), goal)


def ideal(
    reactor: Reactor, environment: Environment, goal: Property, worlds: Iterable[Assumptions], *, limit: int = LIMIT
) -> dict[Assumptions, Verdict]:
    """(12): the verdict in each of these worlds (each the assumptions that fail there) in which all of ω holds."""
    allowed = [failing for failing in worlds if not failing & reactor.rests_on]
    return {failing: achieves(reactor.text, environment(failing), goal, limit=limit) for failing in allowed}


def idle(
    reactor: Reactor, environment: Environment, goal: Property, *, limit: int = LIMIT
) -> tuple[str, ...]:
    """The assumptions of ω that it does not need: it achieves the goal where they alone fail ("no unused ones")."""
    return tuple(
        name
        for name in sorted(reactor.rests_on)
        if achieves(reactor.text, environment(frozenset({name})), goal, limit=limit).holds
    )


class Partial(msgspec.Struct, frozen=True):
    """R^ω_j on the way from ω to ω': its text, and e_j, what is not finished yet, as the assumptions that these parts
    still rest on (`A(x)`: for x only).
    """

    text: str
    unfinished: Assumptions


def converges(chain: Sequence[Partial], given_up: Assumptions) -> bool:
    """(11): does the chain begin with all that is given up unfinished, strictly lose some of it, and end with none?"""
    sizes = [partial.unfinished for partial in chain]
    return (
        bool(sizes)
        and sizes[0] == given_up
        and not sizes[-1]
        and all(after < before for before, after in pairwise(sizes))
    )


def partially_ideal(
    chain: Sequence[Partial], environment: Environment, goal: Property, given_up: Assumptions, *, limit: int = LIMIT
) -> tuple[Verdict, ...]:
    """(10): for each partial reactor the verdict in the world in which all that is given up fails but f(e_j)."""
    return tuple(
        achieves(partial.text, environment(given_up - partial.unfinished), goal, limit=limit) for partial in chain
    )
