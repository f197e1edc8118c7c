"""When a planner asks how the reactor stands, and when it repeats what was not answered.

It asks when it begins on a reactor that stands, and when the reactor begins anew and is not what it was: its journal
has lost something, or other versions stand. If the reactor that begins anew is what it was, what is open is issued
once more, unchanged and under the same ids: what was applied is acknowledged again, what was lost is begun again.
"""

from __future__ import annotations

from collections.abc import Container, Mapping
from typing import TYPE_CHECKING

import msgspec

from planner_reactor.link.messages import Enquiry, Perception, Standing
from planner_reactor.planner.issuing import Issuer
from planner_reactor.planner.steps import Step

if TYPE_CHECKING:
    from planner_reactor.planner.resuming import Resumption

ANSWERS = frozenset({"adaptation_applied", "adaptation_refused", "adaptation_timed_out"})


class Standings(msgspec.Struct, eq=False):
    """What one planner has to do with a standing reactor before it can plan."""

    fenced: bool = False
    _enquirer: int = 0
    waits: bool = False  # for an answer
    _asks: bool = False  # there is something to ask
    _resumption: Resumption | None = None
    _repeats: Issuer | None = None

    @property
    def busy(self) -> bool:
        """Is there nothing to be planned for now?"""
        return self.fenced or self.waits or self._resumption is not None or self._repeats is not None

    def step(self, unsent: Container[int] = ()) -> Step | None:
        """The next piece of work, if there is one; what is `unsent` (held until it is verified) is not repeated."""
        if self.fenced:
            return None
        if self._asks:
            self._asks = False
            return Step("enquire", enquiry=Enquiry(enquirer=self._enquirer), purpose="ask how the reactor stands")
        if self.waits:
            return None
        if self._resumption is not None:
            if not self._resumption.step():
                self._resumption = None
            return Step("resume", purpose="take over what stands")
        issuer, self._repeats = self._repeats, None
        under_way = issuer.under_way.items() if issuer else ()
        again = tuple(flight.adaptation for number, flight in under_way if number not in unsent)
        return Step("repeat", adaptations=again, purpose="repeat what was not answered")

    def enquire(self, enquirer: int | None = None) -> None:
        """Ask, or ask once more."""
        self._enquirer = self._enquirer if enquirer is None else enquirer
        self._asks = self.waits = True
        self._repeats = None

    def answers(self, standing: Standing, epoch: int) -> bool:
        """Is this what was asked for? A planner whose time is over goes on only if it asks itself.

        Who asked more than once is answered more than once, each time in another epoch: the last one counts.
        """
        mine = standing.enquirer == self._enquirer and (self.waits or standing.epoch > epoch)
        if mine:
            self.fenced = self._asks = self.waits = False
        return mine

    def resume(self, resumption: Resumption) -> None:
        self._resumption = resumption

    def perceive(self, perception: Perception, issuer: Issuer) -> None:
        """What bears on it: a later planner has taken over, or the reactor began anew."""
        if perception.kind == "adaptation_refused" and perception.cause == "epoch":
            self.fenced = True
        elif perception.kind == "restarted":
            versions: dict[str, int] = dict(perception.values)  # type: ignore[arg-type]  # pairs
            asking = self.waits or self._resumption is not None or perception.subject == "damaged"
            if asking or not _as_it_was(versions, issuer):
                self.enquire()
            elif issuer.under_way:
                self._repeats = issuer


def _as_it_was(versions: Mapping[str, int], issuer: Issuer) -> bool:
    """Has the reactor the versions that it should have, given that nobody knows what became of what is under way?"""
    open_ = {s for flight in issuer.under_way.values() for s in flight.touched}
    for segment in issuer.model:
        may_be = {segment.version, segment.version + (segment.situation in open_)}
        if versions.get(segment.name, 0) not in may_be:
            return False
    return True
