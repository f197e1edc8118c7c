"""What the planner reports of itself: what one step did, and which assumptions it gave up or took back."""

from __future__ import annotations

from typing import Literal, TypeAlias

import msgspec

from planner_reactor.link.messages import Adaptation, Enquiry

Relax: TypeAlias = "Literal['all', 'none'] | tuple[str, ...]"
Cause: TypeAlias = Literal["normal", "forced"]
StepKind: TypeAlias = Literal[
    "refine", "relax", "reinstate", "watch", "foresee", "enquire", "resume", "repeat", "verify"
]  # fmt: skip


class Step(msgspec.Struct, frozen=True):
    """What one step did: worked on a `situation`, for the sake of an `assumption` (or ''), and what it
    issued, or issued once more (`repeat`). `withheld` says why something was not issued; an `enquiry` asks the reactor
    how it stands. `verify`: what another step came to is held, and is looked at.
    """

    kind: StepKind
    situation: str = ""
    assumption: str = ""
    cause: Cause | Literal["reinstated", ""] = ""
    adaptations: tuple[Adaptation, ...] = ()
    purpose: str = ""
    withheld: str = ""
    enquiry: Enquiry | None = None


class Relaxation(msgspec.Struct, frozen=True):
    """One assumption given up or taken back. `adaptations` were issued for it; `done` when the last
    one was.
    """

    assumption: str
    cause: Cause | Literal["reinstated"]
    adaptations: tuple[int, ...] = ()
    done: bool = False
