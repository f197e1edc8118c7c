"""Every move of a program, with what can be seen of it: what properties are asked of.

A `System` is built by `rs.evolves` as `transitions` is, and keeps of each move besides its label whether it is urgent
and which of the asked-for atoms (`observing`) are true at it. Runs that end go on for ever doing nothing (`IDLE`), so
that every maximal run is infinite.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import msgspec

from planner_reactor.analysis.discovery import Discovery, Origins, path
from planner_reactor.analysis.explore import canonical, successors
from planner_reactor.analysis.observing import Atom, seen, seen_at_rest
from planner_reactor.rs.configurations import Config, Label, World
from planner_reactor.rs.states import Ended

LIMIT = 100_000
"""States that are built unless a caller says otherwise."""

IDLE: Label = ("", (), "idle", ())
"""The label of the step that leads from a state that nothing leaves to itself."""


class Move(msgspec.Struct, frozen=True):
    """One step: where it leads, is time kept from passing by it, and a bit for each atom that is true at it."""

    label: Label
    after: int
    urgent: bool
    seen: int


class System(msgspec.Struct, frozen=True):
    """States 0, 1, … in the order of a shortest way to them; `moves[i]` leave state i.

    Without `complete` the limit was reached: states from `len(moves)` on are known, but not what leaves them.
    """

    atoms: tuple[Atom, ...]
    states: Sequence[Config]
    moves: Sequence[tuple[Move, ...]]
    idle: Sequence[int]  # what is seen where nothing happens
    origins: Origins
    complete: bool

    def path(self, state: int) -> tuple[Label, ...]:
        """The labels of a shortest way from the first state."""
        return path(self.origins, state)

    def leaving(self, state: int) -> Iterable[Move]:
        """The moves of a state; where nothing is left to do, the idle one."""
        if state >= len(self.moves):
            return ()
        return self.moves[state] or (Move(IDLE, state, False, self.idle[state]),)

    @property
    def deadlocks(self) -> tuple[int, ...]:
        """The states that nothing leaves though a root has not ended."""
        return tuple(n for n, moves in enumerate(self.moves) if not moves and not over(self.states[n]))


def over(state: Config) -> bool:
    """Has every root ended?"""
    return all(isinstance(term, Ended) for _, term in state.roots)


def build(start: Config, world: World, atoms: Sequence[Atom] = (), *, limit: int = LIMIT) -> System:
    """The system of a configuration, up to `limit` states."""
    met = Discovery(canonical(start))
    moves: list[tuple[Move, ...]] = []
    idle: list[int] = []
    for here, state in enumerate(met.states):  # grows while it is read
        found = []
        for step in successors(state, world):
            number = met.number(canonical(step.after), here, step.label)
            urgent = step.urgent and step.label[0] != "TIME"
            found.append(Move(step.label, number, urgent, seen(atoms, state, step)))
        moves.append(tuple(found))
        idle.append(0 if found else seen_at_rest(atoms, state))
        if len(met) > limit:
            return System(tuple(atoms), met.states, moves, idle, met.origins, False)
    return System(tuple(atoms), met.states, moves, idle, met.origins, True)
