"""What a draft is for, in words, and the step of the planner that it amounts to."""

from __future__ import annotations

from planner_reactor.link.messages import Adaptation
from planner_reactor.planner.drafts import Draft
from planner_reactor.planner.model import Segment
from planner_reactor.planner.relaxing import Assuming
from planner_reactor.planner.steps import Relaxation, Step

_VERBS = {"normal": "relax", "forced": "give up", "reinstated": "reinstate"}


def purpose(segment: Segment, about: Relaxation | None) -> tuple[str, str]:
    """Why a segment is planned, and the assumption for whose sake (or "")."""
    if segment.is_stub:
        return f"refine {segment.name}", ""
    if about is None:
        return f"adapt {segment.name}", ""
    return f"{_VERBS[about.cause]} {about.assumption}: {segment.name}", about.assumption


def step_of(draft: Draft, assuming: Assuming, *adaptations: Adaptation) -> Step:
    """A step that worked on this draft, and issued these."""
    about = assuming.current or (assuming.records[-1] if assuming.records else None)
    cause = about.cause if about is not None and draft.assumption else ""
    return Step("refine", draft.segment.name, draft.assumption, cause, adaptations, draft.purpose)
