"""Which situations rest on an assumption: what the journal says, the other way round, kept up with its changes."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from planner_reactor.reactor.persistent import Persistent


class Resting:
    """The situations by assumption. Following a change costs what was changed, not what stands."""

    def __init__(self) -> None:
        self._seen: Mapping[str, tuple[str, ...]] = {}
        self._rests_on: dict[str, tuple[str, ...]] = {}  # as it stands below
        self._by_assumption: dict[str, dict[str, None]] = {}

    def follow(self, rests_on: Mapping[str, tuple[str, ...]]) -> Resting:
        """This, brought up to date: situation → the assumptions that it rests on."""
        if self._seen is not rests_on:
            seen, self._seen = self._seen, rests_on
            changed = seen.keys_changed_until(rests_on) if isinstance(seen, Persistent) else None
            for situation in sorted(changed) if changed is not None else dict.fromkeys((*self._rests_on, *rests_on)):
                self._change(situation, rests_on.get(situation, ()))
        return self

    def _change(self, situation: str, assumptions: tuple[str, ...]) -> None:
        for assumption in self._rests_on.pop(situation, ()):
            if assumption not in assumptions:
                situations = self._by_assumption[assumption]
                situations.pop(situation, None)
                if not situations:
                    del self._by_assumption[assumption]
        for assumption in assumptions:
            self._by_assumption.setdefault(assumption, {})[situation] = None
        if assumptions:
            self._rests_on[situation] = assumptions

    def on(self, assumption: str) -> tuple[str, ...]:
        """The situations that rest on this one, in the order in which they came to it."""
        return tuple(self._by_assumption.get(assumption, ()))

    def __iter__(self) -> Iterator[str]:
        """The assumptions on which anything rests."""
        return iter(self._by_assumption)
