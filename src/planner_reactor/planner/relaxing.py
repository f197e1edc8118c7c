"""The outer loop: which assumptions are held, which are given up, which come back (R §6.2, §7.5, §9.2.3).

Normal relaxation takes the assumption in use that is least likely to hold, among those that may be relaxed;
a failed one is given up at once, whatever its place. One that failed and is `reinstatable` comes back when
it holds again, each time after twice the wait, so that one that flaps costs ever less. With `relax="none"`
nothing is ever given up.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping
from types import MappingProxyType

from msgspec.structs import replace

from planner_reactor.errors import InputError, nearest
from planner_reactor.logic.domain import Domain
from planner_reactor.planner.beliefs import Beliefs, in_doubt
from planner_reactor.planner.steps import Cause, Relax, Relaxation

MOST_DOUBLINGS = 6


class Assuming:
    """The assumptions of one planner. `beliefs` are what it plans with, `records` what became of
    assumptions.
    """

    def __init__(self, domain: Domain, relax: Relax) -> None:
        self.domain = domain
        self.relax = _checked(domain, relax)
        self.beliefs = Beliefs(domain)
        self.records: list[Relaxation] = []
        self._causes: dict[str, Cause] = {}
        self._returning: dict[str, None] = {}
        self._returns: Counter[str] = Counter()

    @property
    def causes(self) -> Mapping[str, Cause]:
        """The assumptions given up, and why."""
        return MappingProxyType(self._causes)

    @property
    def current(self) -> Relaxation | None:
        """The change of assumptions that is being worked on."""
        return self.records[-1] if self.records and not self.records[-1].done else None

    def unlikelihood(self, name: str) -> tuple[float, int, str]:
        """The key by which the least likely comes first; among equals the order of the text."""
        declared = self.beliefs.assumption(name)
        return declared.likelihood, list(self.domain.assumptions).index(declared.name), name

    def least_likely(self, in_use: Iterable[str]) -> str | None:
        """The next one to relax, if any may be."""
        if self.relax == "none":
            return None
        names = [n for n in in_use if not in_doubt(n, self.beliefs.relaxed) and self._may_relax(n)]
        return min(names, key=self.unlikelihood, default=None)

    def fails(self, name: str) -> bool:
        """There is evidence against an assumption; is it news that must be acted on?"""
        self._returning.pop(name, None)
        known = name.partition("(")[0] in self.domain.assumptions
        return known and self.relax != "none" and not in_doubt(name, self.beliefs.relaxed)

    def may_doubt(self, name: str) -> bool:
        """Can it be given up, because somebody says so? InputError if there is no such assumption."""
        _checked(self.domain, (name,))
        self._returning.pop(name, None)
        return not in_doubt(name, self.beliefs.relaxed)

    def trust(self, name: str) -> None:
        """Somebody says that it holds; InputError if there is no such assumption."""
        _checked(self.domain, (name,))
        if name in self._causes:
            self._returning[name] = None

    def give_up(self, name: str, cause: Cause) -> None:
        """Plan without it from now on."""
        self._causes[name] = cause
        self.beliefs = self.beliefs.without(name)
        self.records.append(Relaxation(name, cause))

    def take_over(self, given_up: Iterable[str], failed: Iterable[str], watched: Mapping[str, int]) -> None:
        """What another planner gave up stays given up, by force if it failed or its return is `watched` for (how long,
        in ms); if it has returned meanwhile it may come back.
        """
        for name in given_up if self.relax != "none" else ():
            if name.partition("(")[0] in self.domain.assumptions and name not in self.beliefs.relaxed:
                forced = name in failed or name in watched
                self._causes[name] = "forced" if forced else "normal"
                self.beliefs = self.beliefs.without(name)
                if name in watched:
                    self._returns[name] = (watched[name] // self.beliefs.assumption(name).period_ms).bit_length() - 1
                    if name not in failed:
                        self.holds_again(name)

    def holds_again(self, name: str) -> None:
        """It may come back as soon as there is time."""
        if name in self.watched:
            self._returning[name] = None

    def take_back(self) -> str | None:
        """Hold an assumption again that came back, and give its name."""
        name = next(iter(self._returning), None)
        if name is not None:
            del self._returning[name], self._causes[name]
            self._returns[name] += 1
            self.beliefs = self.beliefs.reinstated(name)
            self.records.append(Relaxation(name, "reinstated"))
        return name

    def adopt(self, domain: Domain) -> None:
        """Another text: what was given up stays given up."""
        self.domain = domain
        self.beliefs = replace(self.beliefs, domain=domain)

    @property
    def watched(self) -> dict[str, int]:
        """The failed ones that may come back; how many periods long their monitors shall wait."""
        return {
            name: 1 << min(self._returns[name], MOST_DOUBLINGS)
            for name, cause in self._causes.items()
            if cause == "forced" and self.beliefs.assumption(name).reinstatable
        }

    def note(self, adaptation: int | None, *, done: bool) -> None:
        """Keep the record: an adaptation was issued for the current change; `done`: nothing is left to do."""
        if self.current is not None:
            issued = self.current.adaptations if adaptation is None else (*self.current.adaptations, adaptation)
            self.records[-1] = replace(self.current, adaptations=issued, done=done)

    def _may_relax(self, name: str) -> bool:
        return self.relax == "all" or name in self.relax or name.partition("(")[0] in self.relax


def _checked(domain: Domain, relax: Relax) -> Relax:
    if isinstance(relax, tuple):
        for name in relax:
            if name.partition("(")[0] not in domain.assumptions:
                hint = nearest(name, domain.assumptions) or f"known: {', '.join(domain.assumptions)}"
                raise InputError(f"{name} is not an assumption of {domain.file}, {hint}")
    return relax
