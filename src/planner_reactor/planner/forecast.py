"""What the reactor as it is planned will take: how long each situation lasts, and where resources are short.

Durations are those of the domain (milliseconds, at least and at most), added up over compositions and through
sub-situations: the time until everything has succeeded at the first attempt. Who has a resource within one plan is
ordered (`sharing`); what the plans of two situations take at the same time is not, and is told here.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from math import inf

import msgspec

from planner_reactor.errors import InputError, nearest
from planner_reactor.logic.domain import ActionSchema, Domain, Duration
from planner_reactor.logic.formulas import Atom, Numeral, filled
from planner_reactor.planner.model import Model, Segment
from planner_reactor.planner.situations import Situation, situation_of
from planner_reactor.planner.structure import Action, Choice, During, InOrder, Meanwhile, Run, Together, Tree

UNKNOWN = Duration(0.0, inf)
NO_TIME = Duration(0.0, 0.0)


class Forecast(msgspec.Struct, eq=False):
    """Of the reactor in `model`. `fold`: are constants part of a situation's name?"""

    domain: Domain
    model: Model
    fold: bool
    _lasts: dict[Situation, Duration] = msgspec.field(default_factory=dict)
    _takes: dict[Situation, Counter[Atom]] = msgspec.field(default_factory=dict)

    def of(self, name: str) -> Duration:
        """How long the situation of this name lasts (milliseconds); InputError if there is none."""
        segment = self.model.named(name)
        if segment is None:
            raise InputError(f"no situation {name}, {nearest(name, [segment.name for segment in self.model])}")
        return self.lasts(segment.situation)

    def lasts(self, situation: Situation) -> Duration:
        """How long a situation lasts (milliseconds); a stub is unknown, unless the domain says it of the action."""
        if situation not in self._lasts:
            tree = _tree_of(self.model.segments.get(situation))
            schema = self.domain.schemas.get(situation.schema)
            self._lasts[situation] = self._span(tree) if tree is not None else _declared(schema)
        return self._lasts[situation]

    def warnings(self) -> Iterator[str]:
        """What looks wrong about the situations as they are planned."""
        for segment in self.model:
            yield from segment.refinement.warnings if segment.refinement is not None else ()
        yield from self.contentions()

    def contentions(self) -> Iterator[str]:
        """Where situations may take more of a resource than there is, at the same time."""
        trees = {segment.name: tree for segment in self.model if (tree := _tree_of(segment)) is not None}
        roots = [self.model.names[root] for root in self.model.roots if self.model.names[root] in trees]
        if len(roots) > 1:
            yield from self._short(" and ".join(roots), tuple(trees[name] for name in roots))
        for name, tree in trees.items():
            for parts in _side_by_side(tree):
                yield from self._short(name, parts)

    def _short(self, where: str, parts: tuple[Tree, ...]) -> Iterator[str]:
        for resource, amount in self._sum(parts).items():
            capacity = self.domain.resources[resource.predicate].capacity
            if amount > capacity:
                name = str(resource) if resource.arguments else resource.predicate
                yield (
                    f"what goes on side by side in {where} may take {amount} of {name}, and there is {capacity}: "
                    f"the host must serve one after the other, or the actions say that they use it"
                )

    def _span(self, tree: Tree) -> Duration:
        match tree:
            case Run(action):
                return self._action(action)
            case InOrder(parts):
                spans = [self._span(part) for part in parts]
                return Duration(sum(s.least for s in spans), sum(s.most for s in spans))
            case Together(parts):
                spans = [self._span(part) for part in parts]
                return Duration(max(s.least for s in spans), max(s.most for s in spans))
            case During(_, inner) | Meanwhile(_, inner):
                return self._span(inner)
            case Choice(test, then, otherwise):
                first, one, other = self._action(test), self._span(then), self._span(otherwise)
                return Duration(first.least + min(one.least, other.least), first.most + max(one.most, other.most))

    def _action(self, action: Action) -> Duration:
        if action.abstract:
            return self.lasts(situation_of(action, fold=self.fold))
        return _declared(self.domain.schemas[action.name])

    def _take(self, tree: Tree) -> Counter[Atom]:
        """The most of each resource that is taken at one time."""
        match tree:
            case Run(action):
                return self._taken(action)
            case InOrder(parts):
                return _most(self._take(part) for part in parts)
            case Together(parts):
                return self._sum(parts)
            case During(action, inner):
                return self._taken(action) + self._take(inner)
            case Meanwhile(actions, inner):
                return self._sum((*map(Run, actions), inner))
            case Choice(test, then, otherwise):
                return _most((self._taken(test), self._take(then), self._take(otherwise)))

    def _sum(self, parts: tuple[Tree, ...]) -> Counter[Atom]:
        found: Counter[Atom] = Counter()
        for part in parts:
            found += self._take(part)
        return found

    def _taken(self, action: Action) -> Counter[Atom]:
        own: Counter[Atom] = Counter()
        schema = self.domain.schemas[action.name]
        given = dict(zip(schema.inputs, action.arguments, strict=True))
        for demand in schema.uses:
            resource = filled(demand.resource, given)
            if all(isinstance(argument, str | Numeral) for argument in resource.arguments):
                own[resource] += demand.amount
        if not action.abstract:
            return own
        situation = situation_of(action, fold=self.fold)
        if situation not in self._takes:
            tree = _tree_of(self.model.segments.get(situation))
            self._takes[situation] = Counter() if tree is None else self._take(tree)
        return own | self._takes[situation]


def _tree_of(segment: Segment | None) -> Tree | None:
    return segment.refinement.tree if segment is not None and segment.refinement is not None else None


def _declared(schema: ActionSchema | None) -> Duration:
    if schema is None or schema.duration is None:
        return NO_TIME if schema is not None and schema.senses else UNKNOWN
    return schema.duration


def _most(several: Iterator[Counter[Atom]] | tuple[Counter[Atom], ...]) -> Counter[Atom]:
    found: Counter[Atom] = Counter()
    for one in several:
        found |= one
    return found


def _side_by_side(tree: Tree | None) -> Iterator[tuple[Tree, ...]]:
    """The parts of each parallel composition in it."""
    waiting = [tree] if tree is not None else []
    while waiting:
        match waiting.pop():
            case InOrder(parts):
                waiting.extend(parts)
            case Together(parts):
                yield parts
                waiting.extend(parts)
            case During(action, inner):
                yield (Run(action), inner)
                waiting.append(inner)
            case Meanwhile(actions, inner):
                yield (*map(Run, actions), inner)
                waiting.append(inner)
            case Choice(_, then, otherwise):
                waiting.extend((then, otherwise))
            case Run():
                pass
