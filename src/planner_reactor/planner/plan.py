"""A partial plan: steps, what supports their conditions, and how they lie in time (R §7.2, §7.4).

The steps are intervals of an Allen network; the intervals of conditions and effects are eliminated by
composition: a step that `meets` its effect, which must `[m o si e di fi]` its user, is `[b m]` that user.
`Link` records that an effect is used, so that it can be protected. Everything can be undone to a mark,
because search backtracks.

Legend: START stands for what holds when the situation is asserted, END for the moment when it succeeds,
WHOLE for all the time that it lasts.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import TypeAlias

import msgspec

from planner_reactor.logic.allen import relations
from planner_reactor.logic.domain import ActionSchema, Effect
from planner_reactor.logic.formulas import Atom, Bindings, Term
from planner_reactor.logic.network import Network

START, END, WHOLE = -1, -2, -3
"""Where a link begins or ends when it is not a step."""
BEFORE = relations(["b", "m"])
NOT_LATER = relations(["b", "m", "o", "s", "si", "e", "di", "fi"])
"""The first starts before the second, or with it."""
CONTAINS = relations(["si", "e", "di", "fi"])

Turn: TypeAlias = tuple[int, int]
"""Of two steps that share a resource: which one goes before which."""


class Parameter(msgspec.Struct, frozen=True):
    """A constant of plans: what the situation was asserted with."""

    number: int


class Result(msgspec.Struct, frozen=True):
    """A constant of plans: what a step returns. It differs from everything that is known before."""

    step: int
    number: int


class Unnamed(msgspec.Struct, frozen=True):
    """A constant of plans: something that exists as an effect, and that nothing can name."""

    step: int
    number: int


class Step(msgspec.Struct, frozen=True):
    """One action of a plan; `offset` is added to the variables of its schema."""

    number: int
    schema: ActionSchema
    offset: int

    @property
    def inputs(self) -> tuple[int, ...]:
        return tuple(self.offset + variable for variable in self.schema.inputs)

    def effects(self) -> Iterator[Effect]:
        """Its effects with its own variables."""
        for effect in self.schema.effects:
            yield Effect(effect.atom.shifted(self.offset), effect.relation)


class Link(msgspec.Struct, frozen=True):
    """`atom`, from `producer`, supports condition number `condition` of `consumer`.

    `throughout`: it is needed until the consumer has ended, else only when it starts. `maintained`: it
    holds only while the producer runs. `derived`: a rule says so on assumptions. `lost`: the consumer is
    abstract and cannot count on it for as long as it runs, because nothing makes it last.
    """

    atom: Atom
    producer: int
    consumer: int
    condition: int = 0
    throughout: bool = False
    maintained: bool = False
    derived: bool = False
    lost: bool = False


class Use(msgspec.Struct, frozen=True):
    """An assumption that the plan rests on, or (not `required`) only brings in; `about`: what it is needed for."""

    assumption: str
    required: bool
    about: Atom | None = None


class Plan(msgspec.Struct, eq=False):
    """The mutable state of a search. Its steps count from `first`, so that plans that follow each
    other differ. A finished plan has the `turns` of steps that share resources (`sharing`).
    """

    bindings: Bindings = msgspec.field(default_factory=Bindings)
    network: Network = msgspec.field(default_factory=Network)
    steps: list[Step] = msgspec.field(default_factory=list)
    links: list[Link] = msgspec.field(default_factory=list)
    uses: list[Use] = msgspec.field(default_factory=list)
    distinct: list[tuple[Term, Term]] = msgspec.field(default_factory=list)
    turns: list[Turn] = msgspec.field(default_factory=list)
    assumed: list[Atom] = msgspec.field(default_factory=list)  # assumptions whose arguments were still open
    variables: int = 0
    first: int = 0

    def fresh(self, count: int) -> int:
        """An offset for `count` new variables (numbers are never used again, also after undoing)."""
        self.variables += count
        return self.variables - count

    def add(self, schema: ActionSchema) -> Step:
        """A new step: its outputs are results, what exists as its effect is unnamed, its inputs are open."""
        step = Step(self.first + len(self.steps), schema, self.fresh(schema.size))
        for n, variable in enumerate(schema.outputs):
            self.bindings.bind(step.offset + variable, Result(step.number, n))
        for n, variable in enumerate(schema.unnamed):
            self.bindings.bind(step.offset + variable, Unnamed(step.number, n))
        self.steps.append(step)
        self.network.add(step.number)
        return step

    def step(self, number: int) -> Step:
        return self.steps[number - self.first]

    def order(self, first: int, second: int, relation: int) -> bool:
        return self.network.constrain(first, second, relation)

    def is_before(self, first: int, second: int) -> bool:
        """Has the first certainly ended when the second starts?"""
        return self.network.relation(first, second) & ~BEFORE == 0

    def arguments(self, step: Step) -> tuple[Term, ...]:
        return tuple(self.bindings.walk(variable) for variable in step.inputs)

    def mark(self) -> tuple[int, ...]:
        return (
            len(self.bindings.trail),
            len(self.network.trail),
            len(self.steps),
            len(self.links),
            len(self.uses),
            len(self.distinct),
            len(self.assumed),
        )

    def undo(self, mark: tuple[int, ...]) -> None:
        bindings, network, steps, links, uses, distinct, assumed = mark
        if len(self.bindings.trail) > bindings:
            self.bindings.undo(bindings)
        if len(self.network.trail) > network or not self.network.consistent:
            self.network.undo(network)
        del self.steps[steps:], self.links[links:], self.uses[uses:]
        del self.distinct[distinct:], self.assumed[assumed:]
