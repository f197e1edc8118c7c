"""What the names of one sentence of a domain mean: variables, intervals, constants.

Identifiers declared by `<…>`, `Exists` or `forall` are variables, unless they stand where an interval
stands; those declared by `intervals` are intervals; all others are constants. Intervals disappear here:
`Scope.relation` answers how an interval lies to the one that matters, from the constraints `ITL(…)` of the
same section.
"""

from __future__ import annotations

from collections.abc import Collection, Container, Iterable
from typing import TypeAlias

from planner_reactor.errors import Diagnostic, nearest
from planner_reactor.logic.allen import ALL, NAMED, inverse
from planner_reactor.logic.formulas import Atom, Numeral, Term
from planner_reactor.logic.itl_nodes import AtomNode, Clause, Name, RelationNode
from planner_reactor.logic.itl_tokens import Source
from planner_reactor.logic.network import Network

TIME = "time"
"""The special interval of R (13): the whole line of time."""


Constants: TypeAlias = dict[str, list[tuple[Name, Collection[str]]]]
"""Where each constant stands, and which variables could have been meant there."""


class Scope:
    """The names of one sentence. Findings go to `wrong`, one for each place."""

    def __init__(self, source: Source, wrong: list[Diagnostic], constants: Constants) -> None:
        self.source = source
        self.variables: dict[str, int] = {}
        self.intervals: dict[str, bool] = {TIME: True}  # name -> used
        self._wrong = wrong
        self._found: set[tuple[int, str, str]] = set()  # one finding for each place
        self._constants = constants

    def finding(self, name: Name, code: str, message: str, hint: str = "", *, severity: str = "error") -> None:
        if (name.offset, code, message) not in self._found:
            self._found.add((name.offset, code, message))
            self._wrong.append(self.source.diagnostic(name.offset, code, message, hint, severity=severity))

    def declare(self, names: Iterable[Name], what: str = "variable") -> tuple[int, ...]:
        """Number some variables; a name declared twice is an error."""
        found = []
        for name in names:
            if name.text in self.variables or name.text in self.intervals:
                self.finding(name, "duplicate-name", f"{name.text} is declared twice", "choose another name")
            found.append(self.variables.setdefault(name.text, len(self.variables)))
        return tuple(found)

    def declare_intervals(self, names: Iterable[Name], *, used: bool = False) -> None:
        for name in names:
            if name.text in self.variables or name.text in self.intervals:
                self.finding(name, "duplicate-name", f"{name.text} is declared twice", "choose another name")
            self.intervals[name.text] = used

    def declare_quantified(self, names: Iterable[Name], standing: Container[str]) -> tuple[int, ...]:
        """Number those of the names that never stand as an interval (`standing`); the others are intervals."""
        names = tuple(names)
        self.declare_intervals((n for n in names if n.text in standing), used=True)
        return self.declare(n for n in names if n.text not in standing)

    def atom(self, node: AtomNode) -> Atom:
        """The atom with its names resolved."""
        return Atom(node.name.text, tuple(self.term(name) for name in node.arguments))

    def term(self, name: Name) -> Term:
        if name.number:
            return Numeral(float(name.text) if "." in name.text else int(name.text))
        if name.text in self.variables:
            return self.variables[name.text]
        if name.text in self.intervals:
            self.finding(name, "misplaced-interval", f"the interval {name.text} stands as an argument",
                         "expected a variable or a constant")  # fmt: skip
        self._constants.setdefault(name.text, []).append((name, self.variables))
        return name.text

    def interval(self, name: Name) -> str:
        """The interval with this name, which must be declared."""
        if name.text in self.intervals:
            self.intervals[name.text] = True
        else:
            hint = nearest(name.text, self.intervals) or f"known here: {', '.join(self.intervals)}"
            self.finding(name, "unknown-interval", f"the interval {name.text} is not declared", hint)
        return name.text

    def relation(self, constraints: Constraints, interval: Name | None, centre: str, default: int) -> int:
        """How the interval lies to `centre` by these constraints; `default` if they say nothing."""
        if interval is None:
            return default
        name = self.interval(interval)
        if name == centre:
            return NAMED["equal"]
        if not (found := constraints.between(name, centre)):
            message = f"nothing can lie to {centre} as {name} should"
            self.finding(interval, "contradiction", message, "its constraints contradict each other")
        return default if found == ALL else found

    def check_relations(self, clauses: Iterable[Clause]) -> None:
        """Every interval that a constraint names must be declared."""
        for clause in clauses:
            for literal in clause.literals:
                if isinstance(literal, RelationNode):
                    self.interval(literal.first)
                    self.interval(literal.second)


class Constraints:
    """What the constraints `ITL(…)` of some clauses say: gathered once, asked for every interval."""

    def __init__(self, clauses: Iterable[Clause]) -> None:
        self._nodes = [literal for c in clauses for literal in c.literals if isinstance(literal, RelationNode)]
        self._said: dict[tuple[str, str], int] = {}
        self._network: Network | None = None
        for node in self._nodes:
            first, second = node.first.text, node.second.text
            self._said[first, second] = self._said.get((first, second), ALL) & node.relation
            if first != second:
                self._said[second, first] = self._said.get((second, first), ALL) & inverse(node.relation)
        self._named = {name for pair in self._said for name in pair}

    def between(self, first: str, second: str) -> int:
        """How the first lies to the second: what is said of the two, or else what follows from all; ALL if nothing."""
        found = self._said.get((first, second), ALL)
        if found != ALL or first not in self._named:
            return found
        if self._network is None:
            self._network = Network()
            for node in self._nodes:
                self._network.constrain(node.first.text, node.second.text, node.relation)
        return self._network.relation(first, second) if self._network.consistent else 0


def standing(clauses: Iterable[Clause]) -> set[str]:
    """The names that stand as intervals in these clauses."""
    return {name.text for clause in clauses for name in _interval_names(clause)}


def _interval_names(clause: Clause) -> Iterable[Name]:
    for literal in clause.literals:
        if isinstance(literal, AtomNode) and literal.at is not None:
            yield literal.at
        elif isinstance(literal, RelationNode):
            yield literal.first
            yield literal.second
