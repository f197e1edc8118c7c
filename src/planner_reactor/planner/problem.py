"""What one search has to solve: from what holds at the start of a situation to what must hold at its end."""

from __future__ import annotations

import msgspec

from planner_reactor.logic.formulas import Atom, Term
from planner_reactor.planner.beliefs import Beliefs
from planner_reactor.planner.plan import END
from planner_reactor.planner.theory import Theory


class Truth(msgspec.Struct, frozen=True):
    """What holds at the start; `lost` if it may have ceased meanwhile, for all that is known."""

    atom: Atom
    lost: bool = False


class Goal(msgspec.Struct, frozen=True):
    """An atom that must hold for `consumer`; `relation` leads from its interval to the consumer's."""

    atom: Atom
    relation: int
    consumer: int
    condition: int = 0
    depth: int = 0


class Problem(msgspec.Struct, frozen=True):
    """From `truths` to `goals`, whose variables count from 0 up to `variables`.

    `forbidden` abstract schemas may not be used (they stand higher in the hierarchy), nor may `barred`
    calls (schema and arguments). `outputs` are terms that must end up as something that can be named.
    `replayed` is None if what is planned is never done again after it succeeded, else it holds the
    parameters that are then the same again. The last `kept` goals are things that held at the start and
    need only not be ended. With `enduring` the goals are those of the whole: what was achieved counts,
    whether or not assumptions make it last. With `maintained` the goals must hold for as long as the situation lasts.
    `upheld` is what other goals keep at all times.
    """

    theory: Theory
    beliefs: Beliefs
    truths: tuple[Truth, ...]
    goals: tuple[Atom, ...]
    forbidden: frozenset[str] = frozenset()
    barred: frozenset[tuple[str, tuple[Term, ...]]] = frozenset()
    outputs: tuple[Term, ...] = ()
    replayed: frozenset[int] | None = None
    variables: int = 0
    kept: int = 0
    enduring: bool = False
    maintained: bool = False
    upheld: tuple[Atom, ...] = ()

    def is_kept(self, goal: Goal) -> bool:
        return goal.consumer == END and goal.condition >= len(self.goals) - self.kept


class Consulted(msgspec.Struct, eq=False):
    """What a search would have needed: relaxed assumptions, unknown conditions, schemas that stand too high.

    `gave_up`: it ended before everything was tried.
    """

    missing: set[str] = msgspec.field(default_factory=set)
    asked: dict[Atom, None] = msgspec.field(default_factory=dict)
    blocked: set[str] = msgspec.field(default_factory=set)
    gave_up: bool = False
