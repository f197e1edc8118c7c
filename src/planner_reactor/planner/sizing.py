"""How much of the expectation is reduced at once (R §7.2): the size of ΔE.

At least the first step of what is refined becomes concrete, so that the reactor can begin with it. How much more goes
into the same adaptation follows from

1. the response time asked for: work goes on as long as it allows, so that a planner with more time sends fewer and
   larger adaptations; without one, nothing more;
2. what is uncertain: a situation whose plan would be another if a perception request were answered stays a stub until
   it is;
3. the resources: what can go on beside what is concrete already comes before what has to wait for its resource.
"""

from __future__ import annotations

from collections.abc import Iterator
from math import ceil

import msgspec

from planner_reactor.errors import InputError
from planner_reactor.logic.domain import Domain
from planner_reactor.planner.drafts import Draft
from planner_reactor.planner.model import Model
from planner_reactor.planner.situations import Refinement, Situation

UNIT_MS = 0.05
"""What a unit of work (`thinking`) is taken to last, in milliseconds."""


class Sizing(msgspec.Struct, frozen=True):
    """`units` of work may go into one adaptation; what must be in it is in it whatever it takes."""

    units: int = 0

    @classmethod
    def within(cls, response_ms: float | None) -> Sizing:
        """For this response time (milliseconds; None: as small as can be)."""
        if response_ms is not None and not 0 <= response_ms < 1e9:
            raise InputError(f"response time is {response_ms:g} ms, expected 0 or more")
        return cls(0 if response_ms is None else ceil(response_ms / UNIT_MS))

    def more(self, draft: Draft, model: Model, domain: Domain) -> Situation | None:
        """What else is to be made concrete with this draft, if there is time for more."""
        if draft.spent >= self.units:
            return None
        taken = {resource for situation in draft.refinements for resource in _uses(domain, situation)}
        able = list(dict.fromkeys(_still_stubs(draft, model)))
        return min(able, key=lambda s: not taken.isdisjoint(_uses(domain, s)), default=None)


def at_once(draft: Draft, refinement: Refinement, model: Model) -> list[Situation]:
    """The new sub-situations that must be concrete at once: of a stub the first step, else all."""
    new = list(dict.fromkeys(c.situation for c in refinement.children if c.situation not in model.segments))
    if draft.segment.is_stub:
        first = refinement.begins_with
        begun = [c.situation for c in refinement.children if first and c.arguments == first.arguments]
        new = [s for s in new if first and first.abstract and s.schema == first.name and s in begun]
    done = {*draft.refinements, *draft.waiting, *draft.left}
    return [s for s in new if s not in done]


def _still_stubs(draft: Draft, model: Model) -> Iterator[Situation]:
    for refinement in draft.refinements.values():
        for child in refinement.children:
            known = child.situation in model.segments or child.situation in draft.refinements
            if not known and child.situation not in draft.left:
                yield child.situation


def _uses(domain: Domain, situation: Situation) -> Iterator[str]:
    schema = domain.schemas.get(situation.schema)
    return (demand.resource.predicate for demand in schema.uses) if schema is not None else iter(())
