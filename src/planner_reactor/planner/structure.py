"""From a partial order of steps to a composition of processes (R §7.2).

What must end before the other starts is composed in sequence, what nothing orders side by side, what must
last through another goes beside it and ends with it. A test whose failure is planned for comes as early as
it can, and all that is not needed before it stands in its branch. An order that no nesting of these
expresses is made stricter, so that it takes the least time.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import TypeAlias

import msgspec
from msgspec.structs import replace

from planner_reactor.logic.allen import inverse
from planner_reactor.logic.domain import ActionSchema
from planner_reactor.logic.formulas import Term
from planner_reactor.planner.plan import BEFORE, CONTAINS, Plan, Result, Turn

UNKNOWN = 1000.0
"""Milliseconds that an action is taken to last of which the domain does not say it."""
MOST_CUT = 8
"""An order of more parts, if it is not series-parallel, is cut in the simplest way."""


class Action(msgspec.Struct, frozen=True):
    """A step of a finished plan: `arguments` are constants, `results` what it returns.

    With a `process` it is that definition in RS (`inlining`); `most`: milliseconds after which it has failed.
    """

    name: str
    abstract: bool
    arguments: tuple[Term, ...] = ()
    results: tuple[Result, ...] = ()
    process: str = ""
    most: float | None = None

    def renamed(self, constants: Mapping[Term, Term]) -> Action:
        """The same action on other constants."""
        return replace(self, arguments=tuple(constants.get(a, a) for a in self.arguments))


class Run(msgspec.Struct, frozen=True):
    """One action."""

    action: Action


class InOrder(msgspec.Struct, frozen=True):
    parts: tuple[Tree, ...]


class Together(msgspec.Struct, frozen=True):
    """All of them are needed, in any order."""

    parts: tuple[Tree, ...]


class During(msgspec.Struct, frozen=True):
    """The action goes on for as long as the rest takes."""

    action: Action
    inner: Tree


class Meanwhile(msgspec.Struct, frozen=True):
    """The actions go on side by side until the rest is done; without a rest, for as long as it is asked for."""

    actions: tuple[Action, ...]
    inner: Tree


class Choice(msgspec.Struct, frozen=True):
    """If the test stops, `then`, else `otherwise`."""

    test: Action
    then: Tree
    otherwise: Tree


Tree: TypeAlias = Run | InOrder | Together | During | Meanwhile | Choice
NOTHING = InOrder(())


def arrange(plan: Plan, otherwise: Mapping[int, Tree]) -> Tree:
    """The steps of a plan as a composition; `otherwise` holds what to do if a test (by its number) fails."""
    return _Order(plan).arrange(tuple(step.number for step in plan.steps), otherwise)


def action_of(plan: Plan, number: int) -> Action:
    """A step of a finished plan as an action."""
    step = plan.step(number)
    results = tuple(Result(number, n) for n in range(len(step.schema.outputs)))
    schema = step.schema
    most = schema.duration.most if schema.process and schema.duration else None
    return Action(schema.name, schema.abstract, plan.arguments(step), results, schema.process, most)


def actions_of(tree: Tree) -> Iterator[Action]:
    """The actions of a composition in the order of its text."""
    waiting: list[Tree] = [tree]
    while waiting:
        match waiting.pop():
            case Run(action):
                yield action
            case InOrder(parts) | Together(parts):
                waiting.extend(reversed(parts))
            case During(action, inner):
                yield action
                waiting.append(inner)
            case Meanwhile(actions, inner):
                yield from actions
                waiting.append(inner)
            case Choice(test, then, otherwise):
                yield test
                waiting.extend((otherwise, then))


def renamed(tree: Tree, constants: Mapping[Term, Term]) -> Tree:
    """The same composition with other constants in its actions."""
    match tree:
        case Run(action):
            return Run(action.renamed(constants))
        case InOrder(parts):
            return InOrder(tuple(renamed(part, constants) for part in parts))
        case Together(parts):
            return Together(tuple(renamed(part, constants) for part in parts))
        case During(action, inner):
            return During(action.renamed(constants), renamed(inner, constants))
        case Meanwhile(actions, inner):
            return Meanwhile(tuple(a.renamed(constants) for a in actions), renamed(inner, constants))
        case Choice(test, then, otherwise):
            return Choice(test.renamed(constants), renamed(then, constants), renamed(otherwise, constants))


def as_long_as_asked(tree: Tree) -> Tree:
    """Actions of which none ends by itself, as what is done for as long as somebody wants it."""
    return Meanwhile(tuple(actions_of(tree)), NOTHING)


def first_action(tree: Tree) -> Action | None:
    """With what a composition begins; of several actions that begin together, the first in the text."""
    return next(actions_of(tree), None)


def needed_before(plan: Plan, number: int) -> tuple[int, ...]:
    """The steps that have ended when this one starts, in every order of the plan."""
    return tuple(step.number for step in plan.steps if step.number != number and plan.is_before(step.number, number))


class _Order:
    """The order of a plan's steps as sets of bits."""

    def __init__(self, plan: Plan) -> None:
        self._steps = {step.number: action_of(plan, step.number) for step in plan.steps}
        self.after = dict.fromkeys(self._steps, 0)  # before which others it must have ended
        self._inside = dict.fromkeys(self._steps, 0)
        self._lasts = {self._steps[step.number]: lasting(step.schema) for step in plan.steps}
        self._levelled: dict[int, Tree] = {}
        for first, second, relation in plan.network.edges():
            if isinstance(first, int) and isinstance(second, int) and {first, second} <= self._steps.keys():
                self._note(first, second, relation)
                self._note(second, first, inverse(relation))
        self._needed = self.after if not plan.turns else dict(self.after)
        self._take_turns(plan.turns)

    def _take_turns(self, turns: Sequence[Turn]) -> None:
        """Who has a resource first goes before who has it next, and before all that wait for that."""
        following: dict[int, int] = {}
        for first, second in turns:
            following[first] = following.get(first, 0) | 1 << second
        if following:
            closed: dict[int, int] = {}
            for number in self.after:
                self._close(number, following, closed)
            self.after = closed

    def _close(self, number: int, following: Mapping[int, int], closed: dict[int, int]) -> None:
        """`closed[number]`: all that comes after it, turn by turn; without recursion, chains may be long."""
        waiting = [number]
        while waiting:
            n = waiting[-1]
            direct = self.after[n] | following.get(n, 0)
            missing = [m for m in _numbers(direct) if m not in closed]
            if missing:
                waiting.extend(missing)
                continue
            waiting.pop()
            for m in _numbers(direct):
                direct |= closed[m]
            closed[n] = direct

    def _note(self, first: int, second: int, relation: int) -> None:
        if relation & ~BEFORE == 0:
            self.after[first] |= 1 << second
        elif relation & ~CONTAINS == 0:
            self._inside[first] |= 1 << second

    def arrange(self, numbers: Sequence[int], otherwise: Mapping[int, Tree]) -> Tree:
        """A composition of these steps (at least once each)."""
        tests = [n for n in numbers if n in otherwise]
        if not tests:
            return self._composed(self._blocks(numbers))
        test = min(tests, key=lambda n: (len(self._before(n, numbers)), n))
        first = self._before(test, numbers)
        rest = [n for n in numbers if n != test and n not in first]
        choice = Choice(self._steps[test], self.arrange(rest, otherwise), otherwise[test])
        return _in_order([self.arrange(first, {}), choice])

    def _before(self, number: int, numbers: Sequence[int]) -> list[int]:
        return [n for n in numbers if self._needed[n] >> number & 1]

    def _lasts_as_long(self, one: int, other: int) -> bool:
        """Must each last through the other, or are they the same?"""
        return one == other or bool(self._inside[one] >> other & 1 and self._inside[other] >> one & 1)

    # ------------------------------------------------------------------------------- series and parallel

    def _blocks(self, numbers: Sequence[int]) -> list[_Block]:
        """The steps, each with those that must happen while it lasts."""
        present = _bits(numbers)
        inner = 0
        for n in numbers:
            inner |= self._inside[n]
        blocks = []
        for n in numbers:
            beside, outside = [n], 0
            if inner >> n & 1:
                beside = [m for m in numbers if self._lasts_as_long(n, m)]
                outside = _bits([m for m in numbers if self._inside[m] >> n & 1])
            if beside[0] == n and outside & ~_bits(beside) == 0:
                inside = [m for m in _numbers(self._inside[n] & present) if m not in beside]
                tree: Tree = Run(self._steps[n])
                if inside or len(beside) > 1:
                    tree = _meanwhile([self._steps[m] for m in beside], self._composed(self._blocks(inside)))
                members = _bits([*beside, *inside])
                after = 0
                for m in (*beside, *inside):
                    after |= self.after[m] & present & ~members
                blocks.append(_Block(tree, members, after))
        return blocks

    def _composed(self, blocks: list[_Block]) -> Tree:
        parts: list[Tree] = []
        while len(blocks) > 1:
            parallel = _components(blocks)
            if len(parallel) > 1:
                return _in_order([*parts, Together(tuple(self._composed(part) for part in parallel))])
            early, late = _in_series(blocks)
            if not early and len(blocks) <= MOST_CUT:
                return _in_order([*parts, self._by_levels(blocks)])
            if not early:
                early, late = _cut(blocks, next(_cuts(blocks, _members(blocks))))
            parts.append(self._composed(early))
            blocks = late
        return _in_order([*parts, *(block.tree for block in blocks)]) if parts or blocks else NOTHING

    def _by_levels(self, blocks: list[_Block]) -> Tree:
        """Not series-parallel: made stricter by a cut, all before it first; of several cuts the one that takes the
        least time, for all that is known of durations.
        """
        whole = _members(blocks)
        if whole in self._levelled:
            return self._levelled[whole]
        trees = []
        for cut in dict.fromkeys(_cuts(blocks, whole)):
            early, late = _cut(blocks, cut)
            if early and late and len(early) + len(late) == len(blocks):
                trees.append(_in_order([self._composed(early), self._composed(late)]))
        tree = min(trees, key=self.span, default=Together(tuple(block.tree for block in blocks)))
        self._levelled[whole] = tree
        return tree

    def span(self, tree: Tree) -> float:
        """Milliseconds that a composition takes, if nothing has to be waited for; a second where nothing is known."""
        match tree:
            case Run(action):
                return self._lasts.get(action, UNKNOWN)
            case InOrder(parts):
                return sum(map(self.span, parts))
            case Together(parts):
                return max(map(self.span, parts))
            case During(_, inner) | Meanwhile(_, inner):
                return self.span(inner)
            case Choice(test, then, otherwise):
                return self._lasts.get(test, UNKNOWN) + max(self.span(then), self.span(otherwise))


def lasting(schema: ActionSchema) -> float:
    """What an action is taken to last where orders are compared, in milliseconds."""
    if schema.duration is not None:
        return (schema.duration.least + schema.duration.most) / 2
    return 0.0 if schema.senses else UNKNOWN


def _cuts(blocks: list[_Block], whole: int) -> Iterator[int]:
    """Sets of steps that can all come before all others: what waits for nothing; and, if there are few, for each
    block what it waits for, that and itself, all but what waits for it, and that without itself.
    """
    waiting = 0
    for block in blocks:
        waiting |= block.after
    yield whole & ~waiting
    for block in blocks if len(blocks) <= MOST_CUT else ():
        before = _members([other for other in blocks if other.after & block.members])
        yield before
        yield before | block.members
        yield whole & ~block.after
        yield whole & ~block.after & ~block.members


def _meanwhile(actions: list[Action], inner: Tree) -> Tree:
    """The actions go on while the rest is done, side by side with those that the rest already goes on beside."""
    match inner:
        case During(action, rest):
            return Meanwhile((*actions, action), rest)
        case Meanwhile(others, rest):
            return Meanwhile((*actions, *others), rest)
        case _ if len(actions) == 1:
            return During(actions[0], inner)
        case _:
            return Meanwhile(tuple(sorted(actions, key=lambda action: not action.results)), inner)


class _Block(msgspec.Struct, frozen=True):
    """A composition that is ordered as one; sets of steps are bits."""

    tree: Tree
    members: int
    after: int


def _cut(blocks: list[_Block], early: int) -> tuple[list[_Block], list[_Block]]:
    """The blocks that lie in a set of steps, and those that lie outside it."""
    return [b for b in blocks if b.members & ~early == 0], [b for b in blocks if b.members & early == 0]


def _in_series(blocks: list[_Block]) -> tuple[list[_Block], list[_Block]]:
    """The fewest blocks that all others wait for, and these; none if there are none such."""
    ranked = sorted(blocks, key=lambda block: -block.after.bit_count())
    common, rest = -1, _members(ranked)
    for block in ranked[:-1]:
        common &= block.after
        rest &= ~block.members
        if rest & ~common == 0:
            return _cut(blocks, ~rest)
    return [], blocks


def _components(blocks: list[_Block]) -> list[list[_Block]]:
    """The blocks in groups between which nothing is ordered, each in the order given."""
    present = _members(blocks)
    groups: list[tuple[int, list[int]]] = []
    for n, block in enumerate(blocks):
        reach, numbers, others = block.members | block.after & present, [n], []
        for group in groups:
            if group[0] & reach:
                reach, numbers = reach | group[0], group[1] + numbers
            else:
                others.append(group)
        groups = [*others, (reach, numbers)]
    return [[blocks[n] for n in sorted(numbers)] for _, numbers in sorted(groups, key=lambda group: min(group[1]))]


def _numbers(bits: int) -> Iterator[int]:
    while bits:
        lowest = bits & -bits
        yield lowest.bit_length() - 1
        bits ^= lowest


def _in_order(parts: list[Tree]) -> Tree:
    flat: list[Tree] = []
    for part in parts:
        flat.extend(part.parts if isinstance(part, InOrder) else [part])
    return flat[0] if len(flat) == 1 else InOrder(tuple(flat))


def _members(blocks: list[_Block]) -> int:
    found = 0
    for block in blocks:
        found |= block.members
    return found


def _bits(numbers: Sequence[int]) -> int:
    found = 0
    for n in numbers:
        found |= 1 << n
    return found
