"""The search for the partial plan with the fewest steps: iterative deepening over the ways to support
conditions.

Conditions of a rule that share no variable are planned apart, each with the fewest steps, so that the cost
of a hundred independent ones is the sum and not the product; what a group was found to cost is remembered.
Ties go to what `supports` tries first. A search that is not done after `NODES` choices gives up.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from typing import TypeAlias

from planner_reactor.logic.allen import NAMED
from planner_reactor.logic.domain import ActionSchema
from planner_reactor.planner.founding import is_founded
from planner_reactor.planner.plan import BEFORE, CONTAINS, END, WHOLE, Plan, Result, Step, Unnamed
from planner_reactor.planner.problem import Consulted, Goal, Problem
from planner_reactor.planner.reach import NEVER, Reach
from planner_reactor.planner.repetition import Part, part_of, pattern, repeat
from planner_reactor.planner.sharing import share_out
from planner_reactor.planner.supports import Supports, Way
from planner_reactor.planner.theory import DEEPEST
from planner_reactor.planner.thinking import Work
from planner_reactor.planner.threats import Threats

NODES = 4_000
"""How many choices may be tried for one group of conditions; plans of a few steps need some hundred at
most.
"""

Agenda: TypeAlias = "tuple[Goal, Agenda] | None"
_Choice: TypeAlias = tuple[tuple[int, ...], Agenda, Iterator[Way]]


class Search:
    """One search. `solve` once; `consulted` then tells what it would have needed beside what the plan
    uses.
    """

    def __init__(self, problem: Problem, plan: Plan, consulted: Consulted) -> None:
        self.problem = problem
        self.plan = plan
        self.consulted = consulted
        self.nodes = 0
        plan.variables = max(plan.variables, problem.variables)
        self._supports = Supports(problem, plan, consulted)
        self._threats = Threats(problem, plan)
        self._reach = Reach(problem, consulted)
        self._cheapest = NEVER  # of what was found too dear
        self._there: tuple[int, Step | None, frozenset[str]] = 0, None, frozenset()

    def solve(self) -> Work[Plan | None]:
        """The plan, or None if there is none (or none was found within `NODES` choices)."""
        goals = self._goals()
        found = (yield from self._one_by_one(goals)) or (yield from self._deepen(goals))
        found = found and self._threats.resolve() and is_founded(self.plan, self.problem)
        found = found and (yield from share_out(self.problem.theory.domain, self.plan))
        return self.plan if found else None

    def _goals(self) -> list[Goal]:
        if not self.problem.maintained:
            return [Goal(atom, NAMED["equal"], END, n) for n, atom in enumerate(self.problem.goals)]
        self.plan.network.add(WHOLE)
        return [Goal(atom, NAMED["encompasses"], WHOLE, n) for n, atom in enumerate(self.problem.goals)]

    # ------------------------------------------------------------------------------- control of the search

    def _one_by_one(self, goals: list[Goal]) -> Work[bool]:
        """Goals that share no variable one after the other, if several need actions; False (and nothing done) if that
        comes to nothing, since what one does may be in another's way.
        """
        groups, ground = self._groups(goals)
        groups = sorted([*groups, *([goal] for goal in ground)], key=lambda group: group[0].condition)
        wanted = [group for group in groups if self._least(group)]
        if len(wanted) < 2 or self.problem.maintained:
            return False
        mark = self.plan.mark()
        rest = [goal for group in groups if group not in wanted for goal in group]
        if (yield from self._solve_groups(wanted)) and (yield from self._deepen(rest)) and self._threats.resolve():
            return True
        self.plan.undo(mark)
        self.nodes, self.consulted.gave_up = 0, False
        return False

    def _deepen(self, goals: list[Goal]) -> Work[bool]:
        """Extend the plan so that the goals hold, trying with ever more steps."""
        agenda = _chained(goals, None)
        steps = self._least(goals)
        outer = self._cheapest
        while steps < NEVER and self.nodes < NODES:
            self._cheapest = NEVER
            if (yield from self._depth_first(agenda, steps)):
                self._cheapest = outer
                return True
            steps = self._cheapest
        self._cheapest = outer
        return False

    def _depth_first(self, agenda: Agenda, allowed: int) -> Work[bool]:
        plan = self.plan
        links, steps = len(plan.links), len(plan.steps)
        stack: list[_Choice] = []
        while True:
            if agenda is not None:
                goal, rest = agenda
                afford = self._affords(rest, steps, allowed)
                stack.append((plan.mark(), rest, self._supports.ways(goal, afford)))
            elif self._is_complete(steps) and self._threats.resolve(links, steps):
                return True
            while stack:
                mark, rest, ways = stack[-1]
                plan.undo(mark)
                found, agenda = yield from self._next(mark, rest, ways, steps, allowed)
                if found:
                    break
                stack.pop()
            else:
                return False

    def _affords(self, rest: Agenda, steps: int, allowed: int) -> Callable[[ActionSchema], bool]:
        """Can what remains be done within the limit if this action is added? (Asked before it is.)"""
        count = len(self.plan.steps) - steps + 1
        wanted = self._not_there(_goals(rest))
        effects = self.problem.theory.effects

        def affords(schema: ActionSchema) -> bool:
            given = effects[schema.name]
            needed = count + self._reach.least_together(tuple([p for p in wanted if p not in given]))
            if needed > allowed and allowed < DEEPEST:
                self._cheapest = min(self._cheapest, needed)
            return needed <= allowed

        return affords

    def _next(
        self, mark: tuple[int, ...], rest: Agenda, ways: Iterator[Way], steps: int, allowed: int
    ) -> Work[tuple[bool, Agenda]]:
        """What is to be done after the next way that is possible and not too dear; `mark`: the plan as it is."""
        plan = self.plan
        for way in ways:
            yield
            self.nodes += 1
            if self.nodes > NODES:
                self.consulted.gave_up = True
                break
            added = way()
            if added is not None:
                least, agenda = yield from self._apart(added, rest, steps + allowed)
                needed = len(plan.steps) - steps + max(least, self._least(_goals(agenda)))
                if needed <= allowed:
                    return True, agenda
                self._cheapest = min(self._cheapest, needed)
            plan.undo(mark)
        return False, None

    def _apart(self, added: list[Goal], rest: Agenda, most: int) -> Work[tuple[int, Agenda]]:
        """Solve groups of new goals that share no variable at once, if they can be afforded.

        The least number of steps that they cost beyond those in the plan, and what remains to be done.
        """
        if len(added) < 2 or not added[0].depth:  # only rules bring conditions in such numbers
            return 0, _chained(added, rest)
        groups, others = self._groups(added)
        if len(groups) < 2:
            return 0, _chained(added, rest)
        least = sum(self._least(group) for group in groups)
        if len(self.plan.steps) + least <= most:
            if not (yield from self._solve_groups(groups)):
                return NEVER, rest
            least = 0
        return least, _chained(others, rest)

    def _solve_groups(self, groups: list[list[Goal]]) -> Work[bool]:
        """Solve one group after the other; groups that are alike are solved once and repeated."""
        plan = self.plan
        solved: dict[object, Part] = {}
        for group in groups:
            yield
            key = pattern(self.problem.theory, self.problem.beliefs, plan, group)
            mark = plan.mark()
            if key in solved:
                if repeat(plan, solved[key], group):
                    continue
                plan.undo(mark)
            goals = tuple(plan.bindings.ground(goal.atom) for goal in group)
            first, start = len(plan.steps), len(plan.links)
            nodes, self.nodes = self.nodes, 0  # each group has a budget of its own
            if not (yield from self._deepen(group)):
                return False
            self.nodes = nodes
            solved.setdefault(key, part_of(self.problem.theory, plan, goals, first, start))
        return True

    def _is_complete(self, steps: int) -> bool:
        """Is everything named that must be, and does every result come before its use?"""
        plan, problem = self.plan, self.problem
        walk = plan.bindings.walk
        if any(_is_nameless(walk(term)) for term in problem.outputs) or not self._supports.settle_assumed():
            return False
        if any(walk(one) == walk(other) for one, other in plan.distinct) or self._threats.spoils_itself():
            return False
        for step in plan.steps[steps:]:
            arguments = plan.arguments(step)
            if (step.schema.name, arguments) in problem.barred:
                return False
            for argument in arguments:
                if _is_nameless(argument):
                    return False
                if isinstance(argument, Result) and argument.step >= plan.first:
                    made = plan.step(argument.step).schema
                    order = CONTAINS if made.process else BEFORE  # a port, or what is returned
                    known = plan.network.relation(argument.step, step.number)
                    if known & ~order and not plan.order(argument.step, step.number, order):
                        return False
        return True

    def _least(self, goals: Iterable[Goal]) -> int:
        """At least so many more steps are needed for all of these goals."""
        return self._reach.least_together(self._not_there(goals))

    def _not_there(self, goals: Iterable[Goal]) -> tuple[str, ...]:
        """The predicates of the goals, each once, that are no effect of a step in the plan."""
        there = self._brought_about()
        wanted: dict[str, None] = {}
        for goal in goals:
            predicate = goal.atom.predicate
            if predicate not in there:
                wanted[predicate] = None
        return tuple(wanted)

    def _brought_about(self) -> frozenset[str]:
        """The predicates of the effects of the steps in the plan; only what is new since the last time is looked at."""
        steps, (count, last, there) = self.plan.steps, self._there
        if len(steps) == count and (not count or steps[-1] is last):
            return there
        if len(steps) < count or (count and steps[count - 1] is not last):  # a step is there once: all before it, too
            count, there = 0, frozenset()
        effects = self.problem.theory.effects
        there = there.union(*[effects[step.schema.name] for step in steps[count:]])
        self._there = len(steps), steps[-1] if steps else None, there
        return there

    def _groups(self, goals: list[Goal]) -> tuple[list[list[Goal]], list[Goal]]:
        """The goals with open variables in groups that share none, and those without open variables."""
        groups: dict[int, list[Goal]] = {}  # by the number of the first goal, in order
        owner: dict[int, int] = {}  # variable → its group
        others = []
        walk = self.plan.bindings.walk
        for n, goal in enumerate(goals):
            own = [term for argument in goal.atom.arguments if type(term := walk(argument)) is int]
            if not own:
                others.append(goal)
                continue
            first, *joined = sorted({owner.get(variable, n) for variable in own})
            group = groups.setdefault(first, [])
            for other in joined:
                group.extend(groups.pop(other, ()))
                owner.update({variable: first for variable, old in owner.items() if old == other})
            group.append(goal)
            owner.update(dict.fromkeys(own, first))
        return list(groups.values()), others


def _is_nameless(term: object) -> bool:
    return type(term) is int or isinstance(term, Unnamed)


def _chained(goals: list[Goal], rest: Agenda) -> Agenda:
    for goal in reversed(goals):
        rest = (goal, rest)
    return rest


def _goals(agenda: Agenda) -> list[Goal]:
    goals = []
    while agenda is not None:
        goal, agenda = agenda
        goals.append(goal)
    return goals
