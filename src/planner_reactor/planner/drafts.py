"""A situation that is being planned, with what has to be planned before it is issued."""

from __future__ import annotations

import msgspec
from msgspec.structs import replace

from planner_reactor.planner.beliefs import Beliefs
from planner_reactor.planner.memory import Thought
from planner_reactor.planner.model import Drafted, Model, Segment
from planner_reactor.planner.situations import Context, Refinement, Situation


class Draft(msgspec.Struct, eq=False):
    """Work on one segment. `waiting` sub-situations are refined before it is issued.

    A sub-situation that turns out to be impossible is `avoided` where it is called; a situation for which
    there is no way without is `settled`: it keeps the call, and what it calls is `left` a stub.
    """

    segment: Segment
    purpose: str
    assumption: str = ""
    drafted: Drafted = msgspec.field(default_factory=Drafted)
    waiting: list[Situation] = msgspec.field(default_factory=list)
    avoided: dict[Situation, frozenset[str]] = msgspec.field(default_factory=dict)
    settled: set[Situation] = msgspec.field(default_factory=set)
    left: set[Situation] = msgspec.field(default_factory=set)
    contexts: dict[Situation, tuple[Context, Beliefs]] = msgspec.field(default_factory=dict)  # what each rests on
    spent: int = 0  # units of work
    more: Situation | None = None  # what is refined beyond what must be (`sizing`)
    thought: Thought | None = None  # what is being worked out

    def __post_init__(self) -> None:
        if self.segment.avoided:
            self.avoided[self.segment.situation] = self.segment.avoided
        if self.segment.settled:
            self.settled.add(self.segment.situation)

    @property
    def refinements(self) -> dict[Situation, Refinement]:
        return self.drafted.refinements

    @property
    def size(self) -> int:
        """How many calls of sub-situations there are in it: what it takes to issue it grows with that."""
        return sum(len(refinement.children) for refinement in self.drafted.refinements.values())

    def to_avoid(self, situation: Situation) -> frozenset[str]:
        """The abstract actions that are not to be used for it."""
        return self.avoided.get(situation, frozenset())

    def context(self, situation: Situation, model: Model) -> Context:
        """What one of its situations may count on."""
        own = situation == self.segment.situation
        context = self.segment.context if own else model.context(situation, self.drafted)
        avoided = self.to_avoid(situation)
        return replace(context, forbidden=context.forbidden | avoided) if avoided else context

    def add_more(self, refinement: Refinement) -> None:
        """What need not be in it is in it if it has a plan, and nothing that is asked for could make it another."""
        self.waiting, self.more = [], None
        if refinement.composition is None or refinement.asked:
            self.left.add(refinement.situation)
        else:
            self.drafted.add(refinement)

    def fail(self, situation: Situation) -> bool:
        """There is no plan for one of its situations: begin again without it, or content with less.

        False if nothing is left to try.
        """
        if self.to_avoid(situation):
            del self.avoided[situation]
            self.settled.add(situation)
        elif situation == self.segment.situation:
            return False
        else:
            for caller in self.drafted.calls.get(situation, {}):
                if caller in self.settled:
                    self.left.add(situation)
                else:
                    self.avoided[caller] = self.to_avoid(caller) | {situation.schema}
        self.drafted = Drafted()
        self.waiting = []
        return True
