"""What can be read off the structure of a reactor: its text, and how long a change of it may take (R §5.3, §5.5)."""

from __future__ import annotations

from collections.abc import Mapping

from planner_reactor.link.messages import Adaptation
from planner_reactor.link.surgeries import drained
from planner_reactor.reactor.reactions import Reactions
from planner_reactor.rs.bounds import Bounds
from planner_reactor.rs.printer import show
from planner_reactor.rs.reactions import REACTION, Reaction
from planner_reactor.rs.terms import Process, operands
from planner_reactor.rs.vocabulary import Signature

MARGIN = 1.0
"""Seconds added to a computed bound, for the monitors and the clock."""


def text_of(reactions: Mapping[int, Reaction]) -> str:
    """A reactor as a program that can be run: equation (3) with its reactions, by label."""
    guarded = [f"(E[{label}] # {REACTION}[{label}])" for label in sorted(reactions)]
    equation = " | ".join([*guarded, f"(ADD<m> :: (E[m] # {REACTION}[m]))"])
    clauses = [show(reactions[label].schema) for label in sorted(reactions)]
    return "\n".join([f"REACTOR = {equation}", *clauses]) + "\n"


def bound_of(
    adaptation: Adaptation,
    reactions: Mapping[int, Reaction],
    signatures: Mapping[str, Signature],
    limits: Mapping[str, float],
) -> float:
    """Seconds in which the adaptation will have been applied, given what each basic process may take."""
    if adaptation.mode == "versions":
        return MARGIN

    standing = Reactions.of(reactions)

    def serving(situation: str) -> tuple[Process, ...]:
        return tuple(operands(reaction.schema.body)[1] for reaction in standing.serving(situation))

    return Bounds(standing, signatures, limits, serving).drains(drained(adaptation)) + MARGIN
