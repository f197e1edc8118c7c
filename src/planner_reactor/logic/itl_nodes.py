"""The sentences of a domain text as its grammar sees them, before names are resolved (see `itl_syntax`)."""

from __future__ import annotations

from typing import TypeAlias

import msgspec


class Name(msgspec.Struct, frozen=True, gc=False):
    """An identifier or a number, and where it stands."""

    text: str
    offset: int
    number: bool = False


class AtomNode(msgspec.Struct, frozen=True):
    name: Name
    arguments: tuple[Name, ...]
    at: Name | None = None


class RelationNode(msgspec.Struct, frozen=True):
    """`ITL(first, relation, second)`."""

    first: Name
    relation: int
    second: Name


class UnequalNode(msgspec.Struct, frozen=True):
    first: Name
    second: Name


LiteralNode: TypeAlias = AtomNode | RelationNode | UnequalNode


class Clause(msgspec.Struct, frozen=True):
    """A conjunction; `exists` are the names that it introduces."""

    exists: tuple[Name, ...]
    literals: tuple[LiteralNode, ...]
    offset: int


class AssumptionNode(msgspec.Struct, frozen=True):
    name: Name
    parameters: tuple[Name, ...]
    likelihood: Name | None
    period: Name | None
    monitor: str
    reinstatable: bool


class GoalNode(msgspec.Struct, frozen=True):
    name: Name
    forall: tuple[Name, ...]
    antecedent: Clause | None
    consequent: Clause
    instead: tuple[AtomNode, ...] = ()


class RuleNode(msgspec.Struct, frozen=True):
    """`left => right`; a definition `left <=> right` has been turned round, for it is used from right
    to left.
    """

    forall: tuple[Name, ...]
    left: Clause
    right: Clause
    offset: int


class PersistenceNode(msgspec.Struct, frozen=True):
    forall: tuple[Name, ...]
    atom: AtomNode
    assumptions: tuple[AtomNode, ...]


class FactNode(msgspec.Struct, frozen=True):
    clause: Clause


class ResourceNode(msgspec.Struct, frozen=True):
    name: Name
    parameters: tuple[Name, ...]
    capacity: Name | None


class DemandNode(msgspec.Struct, frozen=True):
    """`crane`, `places(s) 2`: what an action takes of a resource."""

    resource: Name
    arguments: tuple[Name, ...]
    amount: Name | None


class SchemaNode(msgspec.Struct, frozen=True):
    name: Name
    inputs: tuple[Name, ...]
    outputs: tuple[Name, ...]
    marks: tuple[str, ...]
    intervals: tuple[Name, ...]
    sections: tuple[tuple[str, Clause], ...]
    duration: tuple[Name, Name] | None = None
    uses: tuple[DemandNode, ...] = ()


Sentence: TypeAlias = AssumptionNode | GoalNode | RuleNode | PersistenceNode | FactNode | ResourceNode | SchemaNode
