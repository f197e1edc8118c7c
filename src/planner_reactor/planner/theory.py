"""What can be said of a domain once and for all, to make chaining fast (nothing here depends on a state).

`ends` are the predicates that an action may put an end to, by the exclusions of the causal theory; `groups`
the parts of a rule's body that share no variable; `contributors` the actions that can help to bring a
predicate about; `alike` the constants that a domain treats all in the same way, so that what is planned for
one serves for another.
"""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Callable, Iterable, Iterator

import msgspec

from planner_reactor.logic.domain import ActionSchema, Condition, Domain, Rule
from planner_reactor.logic.formulas import Atom, variables

DEEPEST = 40
"""How many rules may support each other in a chain."""


class Kind(msgspec.Struct, frozen=True):
    """What interchangeable constants have in common."""

    number: int


def is_ground(atom: Atom) -> bool:
    """Does it speak of constants only?"""
    return not list(variables((atom,)))


class Theory:
    """The static side of one domain."""

    def __init__(self, domain: Domain) -> None:
        self.domain = domain
        self.effects = {s.name: frozenset(e.atom.predicate for e in s.effects) for s in domain.schemas.values()}
        self.needs = {s.name: frozenset(c.atom.predicate for c in s.executability) for s in domain.schemas.values()}
        self.ends = {s.name: self._ended_by(s) for s in domain.schemas.values()}
        self.kept = frozenset(goal.name for goal in domain.goals.values() if goal.kept)
        """The goals that are never achieved once and for all."""
        self.achievable = frozenset().union(*self.effects.values())
        self.changing = frozenset().union(*self.ends.values())
        self.lasting_facts = frozenset(domain.facts) - self.changing
        """The predicates of facts that no action can end, so that they hold everywhere."""
        self.alternatives = {s.name: self._alternatives(s) for s in domain.schemas.values()}
        """For each abstract action the others that do all that it does: they stand beside it, never below."""
        self.contributors = _contributors(domain)
        self.achievers = {
            (predicate, abstract): tuple(
                [(schema, e) for schema, e in found if schema.abstract == abstract and not schema.cleanup]
            )
            for predicate, found in domain.producers.items()
            for abstract in (False, True)
        }
        """What brings a predicate about, by whether it is abstract; what cleans up is for that alone."""
        self.bounds: dict[object, dict[str, int]] = {}
        self._alike_groups: dict[int, tuple[tuple[frozenset[str], int], ...]] = {}
        self._bodies = {id(r): frozenset(c.atom.predicate for c in r.body) for r in domain.rules}
        self.alike = _alike(domain, self.groups)
        self.missing: dict[tuple[str, frozenset[str]], frozenset[str]] = {}
        self._behind: dict[str, frozenset[str]] = {}
        self._assumed = {
            s.name: tuple(a for a in s.applicability if a.predicate in domain.assumptions)
            for s in domain.schemas.values()
        }

    def upheld_beside(self, goal: str) -> tuple[Atom, ...]:
        """What the goals that are kept hold at all times, for every other goal."""
        goals = self.domain.goals.values() if goal in self.domain.goals else ()
        return tuple(atom for g in goals if g.kept and g.name != goal for atom in g.consequent if is_ground(atom))

    def _alternatives(self, schema: ActionSchema) -> frozenset[str]:
        own = self.effects[schema.name]
        return frozenset(
            other.name
            for other in self.domain.schemas.values()
            if other is not schema and other.abstract and own and own <= self.effects[other.name]
        )

    def _ended_by(self, schema: ActionSchema) -> frozenset[str]:
        return frozenset(
            other.predicate
            for predicate in self.effects[schema.name]
            for _, _, other in self.domain.excluding.get(predicate, ())
        )

    def may_end(self, schema: ActionSchema, predicate: str) -> bool:
        """Could the action end something with this predicate?"""
        return predicate in self.ends.get(schema.name, ())

    def assumed(self, schema: ActionSchema) -> tuple[Atom, ...]:
        """The assumptions without which the action may not be selected."""
        return self._assumed[schema.name]

    def assumptions_behind(self, predicate: str) -> frozenset[str]:
        """All assumptions that some way to the predicate rests on."""
        found = self._behind.get(predicate)
        if found is None:
            found = self._behind[predicate] = self._collect(predicate)
        return found

    def _collect(self, predicate: str) -> frozenset[str]:
        assumed: set[str] = set()
        seen = {predicate}
        waiting = [predicate]
        while waiting:
            goal = waiting.pop()
            ways = [(r.assumptions, r.body) for r in self.domain.rules_for.get(goal, ())]
            ways += [(self.assumed(s), s.executability) for s, _ in self.domain.producers.get(goal, ())]
            for assumptions, body in ways:
                assumed.update(a.predicate for a in assumptions)
                waiting.extend({c.atom.predicate for c in body} - seen)
                seen.update(c.atom.predicate for c in body)
        return frozenset(assumed)

    def body(self, rule: Rule) -> frozenset[str]:
        """The predicates of a rule's conditions."""
        return self._bodies[id(rule)]

    def alike_groups(self, rule: Rule) -> tuple[tuple[frozenset[str], int], ...]:
        """The predicates of each group of a rule's conditions, and how many groups have the same."""
        found = self._alike_groups.get(id(rule))
        if found is None:
            count = Counter(frozenset(c.atom.predicate for c in group) for group in self.groups(rule))
            found = self._alike_groups[id(rule)] = tuple(count.items())
        return found

    def groups(self, rule: Rule) -> tuple[tuple[Condition, ...], ...]:
        """The conditions of a rule in groups that share no variable but those of its head, in order."""
        return _grouped(rule.body, frozenset(variables((rule.head,))))


def _grouped(body: tuple[Condition, ...], bound: frozenset[int]) -> tuple[tuple[Condition, ...], ...]:
    leader: dict[int, int] = {}  # variable → number of its group
    groups: dict[int, list[Condition]] = {}
    for n, condition in enumerate(body):
        own = [v for v in variables((condition.atom,)) if v not in bound]
        joined = sorted({leader[v] for v in own if v in leader})
        target = joined[0] if joined else n
        groups.setdefault(target, [])
        for other in joined[1:]:
            groups[target].extend(groups.pop(other))
            leader.update({v: target for v, group in leader.items() if group == other})
        groups[target].append(condition)
        leader.update(dict.fromkeys(own, target))
    return tuple(tuple(groups[n]) for n in sorted(groups))


def _contributors(domain: Domain) -> dict[str, frozenset[str]]:
    """For each predicate, the actions that can help to bring it about, directly or through rules."""
    found = {p: {schema.name for schema, _ in producers} for p, producers in domain.producers.items()}
    changed = True
    while changed:
        changed = False
        for rule in domain.rules:
            helpers = found.setdefault(rule.head.predicate, set())
            before = len(helpers)
            for condition in rule.body:
                helpers |= found.get(condition.atom.predicate, set())
            changed |= len(helpers) > before
    known = {p: frozenset(names) for p, names in found.items()}
    return defaultdict(frozenset, known)


def _alike(domain: Domain, groups: Callable[[Rule], tuple[tuple[Condition, ...], ...]]) -> dict[str, Kind]:
    """Constant → its kind, for the symbols that stand only in bodies of rules, always in the same company.

    Two constants of one kind can change places without changing the domain.
    """
    special = _special_symbols(domain)
    company: dict[str, list[tuple[object, ...]]] = {}
    for number, rule in enumerate(domain.rules):
        for group in groups(rule):
            for symbol in dict.fromkeys(_symbols(c.atom for c in group)):
                if symbol not in special:
                    company.setdefault(symbol, []).append((number, *_in_place_of(symbol, group)))
    kinds: dict[object, Kind] = {}
    return {
        symbol: kinds.setdefault(tuple(sorted(places, key=str)), Kind(len(kinds)))
        for symbol, places in company.items()
    }


def _in_place_of(symbol: str, group: tuple[Condition, ...]) -> Iterator[object]:
    numbers = {v: n for n, v in enumerate(variables(tuple(c.atom for c in group)))}
    for condition in group:
        arguments = (
            numbers[a] if type(a) is int else (None if a == symbol else str(a)) for a in condition.atom.arguments
        )
        yield (condition.atom.predicate, condition.relation, *arguments)


def _special_symbols(domain: Domain) -> set[str]:
    """The symbols that a schema, fact, head or exclusion tells apart from others."""
    special: set[str] = set()
    for schema in domain.schemas.values():
        special.update(_symbols((*schema.presumes, *schema.applicability, *schema.expansions)))
        special.update(_symbols(c.atom for c in schema.executability))
        special.update(_symbols(e.atom for e in (*schema.effects, *schema.otherwise)))
    for rule in domain.rules:
        special.update(_symbols((rule.head, *rule.assumptions)))
        special.update(t for pair in rule.distinct for t in pair if isinstance(t, str))
    for exclusion in domain.exclusions:
        special.update(_symbols((exclusion.first, exclusion.second, *exclusion.given)))
        special.update(t for pair in exclusion.distinct for t in pair if isinstance(t, str))
    for persistences in domain.persistences.values():
        special.update(_symbols(a for p in persistences for a in (p.atom, *p.assumptions)))
    special.update(_symbols(fact for facts in domain.facts.values() for fact in facts))
    special.update(_symbols(a for goal in domain.goals.values() for a in (*goal.antecedent, *goal.consequent)))
    return special


def _symbols(atoms: Iterable[Atom]) -> Iterable[str]:
    return (a for atom in atoms for a in atom.arguments if isinstance(a, str))
