"""What an adaptation does to the structure of a reactor, as both sides have to understand it.

The reactor runs the script of this surgery, the planner verifies it before it issues the adaptation.
"""

from __future__ import annotations

from planner_reactor.link.messages import Adaptation
from planner_reactor.rs.reactions import Surgery


def drained(adaptation: Adaptation) -> tuple[str, ...]:
    """The situations whose instances must come to an end first, top-down: all but those that did not exist."""
    fresh = {change.situation for change in adaptation.changes if change.fresh}
    changed = [change.situation for change in adaptation.changes if not change.fresh]
    return (*changed, *(s for s in adaptation.removed if s not in changed and s not in fresh))


def surgery(adaptation: Adaptation) -> Surgery:
    """What it does to the structure of the reactor."""
    named = (*(change.situation for change in adaptation.changes), *adaptation.removed)
    return Surgery(
        held=drained(adaptation),
        kills=adaptation.kills,
        adds=adaptation.adds,
        named=tuple(dict.fromkeys(named)),
        removed=adaptation.removed,
        migrated=tuple((c.situation, c.migrate) for c in adaptation.changes if c.migrate is not None),
    )
