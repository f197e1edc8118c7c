"""What a planning domain is made of: assumptions, goals, a causal theory, facts, action schemas (R §7.4,
Figs 5, 6).

A `Domain` is what `reader` makes of a text `*.itl`. Everything is immutable; variables are numbers that
count from 0 in each rule, goal and schema, so that a fresh copy is made by adding an offset. Intervals are
gone: what is left of `p(x) @ i and ITL(i, R, Action)` is a `Condition` with the relation R from its
interval to that of the action, and of `ITL(Action, R, j) and q(x) @ j` an `Effect` with the relation R from
the action's interval to its own.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from types import MappingProxyType
from typing import Literal, TypeVar

import msgspec
from msgspec.structs import astuple

from planner_reactor.errors import Place
from planner_reactor.logic.allen import NAMED, relations
from planner_reactor.logic.formulas import Atom, Term

AT_START = relations(["m", "o", "si", "e", "di", "fi"])
"""A condition without a relation of its own: it holds when the action starts."""
MEETS = NAMED["meets"]
"""An effect without a relation of its own: it holds from the end of the action."""

_T = TypeVar("_T")


class _Placed(msgspec.Struct, frozen=True, eq=False):
    """Something with its place in the text as the last field, which makes no difference to what it is."""

    def __eq__(self, other: object) -> bool:
        return type(other) is type(self) and astuple(self)[:-1] == astuple(other)[:-1]

    def __ne__(self, other: object) -> bool:  # a struct's own would compare identities
        return not self == other

    def __hash__(self) -> int:
        return hash(astuple(self)[:-1])


class Assumption(_Placed, frozen=True):
    """A temporal predicate that is taken to hold until there is evidence against it (R §7.4, §8.2).

    `likelihood` of holding gives the order of relaxation. `monitor` is `flag` (checked every `period_ms`)
    or `reaction` (the process that runs into its failure reports it). A `reinstatable` one may come back (R
    §9.2.3).
    """

    name: str
    parameters: int = 0
    likelihood: float = 0.5
    monitor: Literal["flag", "reaction"] = "flag"
    period_ms: int = 2000
    reinstatable: bool = False
    place: Place | None = None


class Condition(msgspec.Struct, frozen=True):
    """An atom that must hold over an interval; `relation` leads from that interval to the one it is
    stated for.
    """

    atom: Atom
    relation: int = AT_START


class Effect(msgspec.Struct, frozen=True):
    """An atom that an action brings about; `relation` leads from the action's interval to the atom's."""

    atom: Atom
    relation: int = MEETS


class Rule(_Placed, frozen=True):
    """`body and assumptions => head`; each condition's relation leads from its interval to the head's.

    `distinct` are pairs of terms that must differ.
    """

    head: Atom
    body: tuple[Condition, ...]
    assumptions: tuple[Atom, ...]
    distinct: tuple[tuple[Term, Term], ...]
    size: int
    place: Place | None = None


class Exclusion(_Placed, frozen=True):
    """`first @ i and second @ j and … => ITL(i, disjunct, j)`: the two never hold together (R Fig. 6).

    `given` are further atoms that must hold beside one of the two, `distinct` pairs of terms that must
    differ.
    """

    first: Atom
    second: Atom
    given: tuple[Atom, ...]
    distinct: tuple[tuple[Term, Term], ...]
    size: int
    place: Place | None = None


class Persistence(_Placed, frozen=True):
    """An atom that lasts only as long as the assumptions hold; what is not named lasts until something
    excludes it.
    """

    atom: Atom
    assumptions: tuple[Atom, ...]
    size: int
    place: Place | None = None


class Duration(msgspec.Struct, frozen=True):
    """How long an action may last, in milliseconds."""

    least: float
    most: float


class Resource(_Placed, frozen=True):
    """What only so many can use at one time: a crane, a tap, the places of a shelf (then with parameters:
    each shelf has places of its own).
    """

    name: str
    parameters: int = 0
    capacity: int = 1
    place: Place | None = None


class Demand(msgspec.Struct, frozen=True):
    """What an action takes of a resource, from its start to its end."""

    resource: Atom
    amount: int = 1


class ActionSchema(_Placed, frozen=True):
    """An action: basic if `expansions` is empty (a process that the reactor can run), abstract
    otherwise (Fig. 5).

    `inputs`, `outputs` and `unnamed` are variables; `variables` holds their names. `presumes` are
    assumptions that the action brings in without needing them, `applicability` must hold when it is
    selected, `executability` is chained on. A schema that `senses` takes no time worth ordering;
    `otherwise` is what its abort tells. A `cleanup` may be run at any time, does nothing where its
    conditions do not hold, and serves the fail branch of a reaction. `duration` and `uses` say how long it
    lasts and what it takes meanwhile, where the domain knows. `process` is the text of a definition in RS that stands
    for a basic action which is no process of the host; its inputs and outputs are then ports.
    """

    name: str
    variables: tuple[str, ...] = ()
    inputs: tuple[int, ...] = ()
    outputs: tuple[int, ...] = ()
    unnamed: tuple[int, ...] = ()
    presumes: tuple[Atom, ...] = ()
    applicability: tuple[Atom, ...] = ()
    executability: tuple[Condition, ...] = ()
    effects: tuple[Effect, ...] = ()
    otherwise: tuple[Effect, ...] = ()
    expansions: tuple[Atom, ...] = ()
    senses: bool = False
    cleanup: bool = False
    duration: Duration | None = None
    uses: tuple[Demand, ...] = ()
    process: str = ""
    place: Place | None = None

    @property
    def abstract(self) -> bool:
        return bool(self.expansions)

    @property
    def size(self) -> int:
        """How many variables it has."""
        return len(self.variables)


class Goal(_Placed, frozen=True):
    """`forall …: antecedent => Exists …: consequent`, R (13). `lasting` atoms must hold to the end of
    time. A goal that is `kept` is never achieved once and for all: its consequent must hold at all times. One that
    acts `instead` of abstract actions is pursued while a failed assumption disables one of them (R §10, flaw 2).
    """

    name: str
    antecedent: tuple[Atom, ...]
    consequent: tuple[Atom, ...]
    lasting: tuple[bool, ...]
    size: int
    kept: bool = False
    instead: tuple[Atom, ...] = ()
    place: Place | None = None


class Domain:
    """A planning domain, with the indexes that chaining needs. All mappings keep the order of the text."""

    __slots__ = (
        "assumptions",
        "excluding",
        "exclusions",
        "facts",
        "file",
        "goals",
        "persistences",
        "producers",
        "resources",
        "rules",
        "rules_for",
        "schemas",
    )  # fmt: skip

    def __init__(
        self,
        *,
        assumptions: Iterable[Assumption] = (),
        goals: Iterable[Goal] = (),
        rules: Iterable[Rule] = (),
        exclusions: Iterable[Exclusion] = (),
        persistences: Iterable[Persistence] = (),
        facts: Iterable[Atom] = (),
        schemas: Iterable[ActionSchema] = (),
        resources: Iterable[Resource] = (),
        file: str = "<text>",
    ) -> None:
        self.file = file
        self.assumptions: Mapping[str, Assumption] = MappingProxyType({a.name: a for a in assumptions})
        self.goals: Mapping[str, Goal] = MappingProxyType({g.name: g for g in goals})
        self.rules = tuple(rules)
        self.exclusions = tuple(exclusions)
        self.persistences: Mapping[str, tuple[Persistence, ...]] = _grouped((p.atom.predicate, p) for p in persistences)
        self.facts: Mapping[str, tuple[Atom, ...]] = _grouped((f.predicate, f) for f in facts)
        self.resources: Mapping[str, Resource] = MappingProxyType({r.name: r for r in resources})
        self.schemas: Mapping[str, ActionSchema] = MappingProxyType({s.name: s for s in schemas})
        self.rules_for: Mapping[str, tuple[Rule, ...]] = _grouped((r.head.predicate, r) for r in self.rules)
        self.producers: Mapping[str, tuple[tuple[ActionSchema, Effect], ...]] = _grouped(
            (effect.atom.predicate, (schema, effect)) for schema in self.schemas.values() for effect in schema.effects
        )
        self.excluding: Mapping[str, tuple[tuple[Exclusion, Atom, Atom], ...]] = _grouped(
            (one.predicate, (rule, one, other))
            for rule in self.exclusions
            for one, other in ((rule.first, rule.second), (rule.second, rule.first))
        )


def _grouped(pairs: Iterable[tuple[str, _T]]) -> Mapping[str, tuple[_T, ...]]:
    groups: dict[str, list[_T]] = {}
    for key, value in pairs:
        groups.setdefault(key, []).append(value)
    return MappingProxyType({key: tuple(values) for key, values in groups.items()})
