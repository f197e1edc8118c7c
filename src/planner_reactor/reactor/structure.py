"""What can be read off the structure of a reactor: its text, and how long a change of it may take (R §5.3, §5.5)."""

from __future__ import annotations

from collections.abc import Mapping
from math import inf

from planner_reactor.link.messages import Adaptation
from planner_reactor.link.surgeries import drained
from planner_reactor.reactor.forms import Durations
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
    durations: Mapping[int, Durations] | None = None,
) -> float:
    """Seconds in which the adaptation will have been applied, given what each basic process may take.

    `durations` is what was found for reactions before, by label: it is used, and added to.
    """
    if adaptation.mode == "versions":
        return MARGIN

    standing, held = Reactions.of(reactions), drained(adaptation)

    def serving(situation: str) -> tuple[Process, ...]:
        return tuple(operands(reaction.schema.body)[1] for reaction in standing.serving(situation))

    if durations is not None:
        found: dict[str, float] = {}
        times = [_time_of(name, standing, signatures, limits, durations, found) for name in held]
        if None not in times:
            return sum(time for time in times if time is not None) + MARGIN
    return Bounds(standing, signatures, limits, serving).drains(held) + MARGIN


def _time_of(
    situation: str,
    standing: Reactions,
    signatures: Mapping[str, Signature],
    limits: Mapping[str, float],
    durations: Mapping[int, Durations],
    found: dict[str, float],
) -> float | None:
    """What `Bounds.situation` gives, from what is known of each reaction; None if of one nothing may be known.

    A reaction in `durations` calls no definition: its time depends on that of the situations that it asserts alone.
    """
    if situation in found:
        return found[situation]
    longest, found[situation] = 0.0, inf  # asserted from below itself: no bound
    for reaction in standing.serving(situation):
        if (known := durations.get(reaction.label)) is None:
            return None
        below = []
        for name in reaction.asserts:
            if (time := _time_of(name, standing, signatures, limits, durations, found)) is None:
                return None
            below.append(time)
        if (own := known.get(key := tuple(below))) is None:
            body = (operands(reaction.schema.body)[1],)
            above = dict(zip(reaction.asserts, below, strict=True))
            own = known[key] = Bounds(standing, signatures, limits, lambda _: body, above).situation(situation)  # noqa: B023
        longest = max(longest, own)
    found[situation] = longest
    return longest
