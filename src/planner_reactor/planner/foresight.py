"""Thinking ahead: what the reactor would have to be without one assumption more, worked out while there is time.

When nothing else is to be done, the reactor for each set of assumptions that could be next is planned to the
end, against a model that stands for no reactor. Nothing is issued; what was worked out stays in memory, so that
the failure of an assumption finds its refinements ready, and what is left to do is to issue them.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable

import msgspec

from planner_reactor.planner.beliefs import Beliefs
from planner_reactor.planner.issuing import Issuer
from planner_reactor.planner.model import Model
from planner_reactor.planner.reactions import Names
from planner_reactor.planner.reducing import Reducer
from planner_reactor.planner.relaxing import Assuming


class Foresight(msgspec.Struct, eq=False):
    """Plans for what `reducer` may have to plan next; `foreseen` are the beliefs that it has planned for."""

    reducer: Reducer
    foreseen: set[Beliefs] = msgspec.field(default_factory=set)
    _shadow: Reducer | None = None
    _about: str = ""

    def step(self, in_use: Iterable[str]) -> str | None:
        """One short piece of work; the assumption that it was about, or None if there is nothing left to foresee."""
        while self._shadow is None:
            beliefs = self.reducer.assuming.beliefs
            name = next((n for n in in_use if beliefs.without(n) not in self.foreseen), None)
            if name is None:
                return None
            self.foreseen.add(beliefs.without(name))
            self._shadow, self._about = shadow_of(self.reducer, beliefs.without(name), Names()), name
        step = self._shadow.step()
        if step is None:
            self._shadow = None
        else:
            for adaptation in step.adaptations:
                self._shadow.applied(adaptation.id)
        return self._about


def shadow_of(actual: Reducer, beliefs: Beliefs, names: Names) -> Reducer:
    """One that plans the same goals under other beliefs, for no reactor."""
    issuer = Issuer(Model(names=names), actual.issuer.fold, actual.issuer.stub_ms, None, actual.issuer.mode)
    issuer.sheets.share(actual.issuer.sheets)
    assuming = Assuming(actual.theory.domain, "none")
    assuming.beliefs = beliefs
    shadow = Reducer(actual.theory, issuer.model, issuer, assuming, Counter())
    shadow.memory = actual.memory
    for root in actual.model.roots:
        shadow.pursue(root.schema)
    return shadow
