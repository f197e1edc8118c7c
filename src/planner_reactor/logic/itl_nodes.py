"""The sentences of a domain text as its grammar sees them, before names are resolved (see `itl_syntax`)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias


@dataclass(frozen=True, slots=True)
class Name:
    """An identifier or a number, and where it stands."""

    text: str
    offset: int
    number: bool = False


@dataclass(frozen=True, slots=True)
class AtomNode:
    name: Name
    arguments: tuple[Name, ...]
    at: Name | None = None


@dataclass(frozen=True, slots=True)
class RelationNode:
    """`ITL(first, relation, second)`."""

    first: Name
    relation: int
    second: Name


@dataclass(frozen=True, slots=True)
class UnequalNode:
    first: Name
    second: Name


LiteralNode: TypeAlias = AtomNode | RelationNode | UnequalNode


@dataclass(frozen=True, slots=True)
class Clause:
    """A conjunction; `exists` are the names that it introduces."""

    exists: tuple[Name, ...]
    literals: tuple[LiteralNode, ...]
    offset: int


@dataclass(frozen=True, slots=True)
class AssumptionNode:
    name: Name
    parameters: tuple[Name, ...]
    likelihood: Name | None
    period: Name | None
    monitor: str
    reinstatable: bool


@dataclass(frozen=True, slots=True)
class GoalNode:
    name: Name
    forall: tuple[Name, ...]
    antecedent: Clause | None
    consequent: Clause


@dataclass(frozen=True, slots=True)
class RuleNode:
    """`left => right`; a definition `left <=> right` has been turned round, for it is used from right
    to left.
    """

    forall: tuple[Name, ...]
    left: Clause
    right: Clause
    offset: int


@dataclass(frozen=True, slots=True)
class PersistenceNode:
    forall: tuple[Name, ...]
    atom: AtomNode
    assumptions: tuple[AtomNode, ...]


@dataclass(frozen=True, slots=True)
class FactNode:
    clause: Clause


@dataclass(frozen=True, slots=True)
class SchemaNode:
    name: Name
    inputs: tuple[Name, ...]
    outputs: tuple[Name, ...]
    marks: tuple[str, ...]
    intervals: tuple[Name, ...]
    sections: tuple[tuple[str, Clause], ...]


Sentence: TypeAlias = AssumptionNode | GoalNode | RuleNode | PersistenceNode | FactNode | SchemaNode
