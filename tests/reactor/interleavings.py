"""Every interleaving of a small run, on the executer itself: all that the semantics leaves open is tried in every way.

Which strand has the next turn, which of those that wait for one instant is told first, who comes first at a port: a run
asks, and is run anew until each choice was made in every way, depth first.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator, Sequence

from planner_reactor.rs.terms import Program
from planner_reactor.runtime import Budgets, Executer, Host
from planner_reactor.runtime.guiding import GuidedScheduler, guide

MOST = 20_000

STEPS = Budgets(slice=1)
"""A turn is a step."""


def every_interleaving(
    play: Callable[[GuidedScheduler], None], *, at: float | None = None, departures: int | None = None
) -> int:
    """Play it in every way; how many there are. With `at` the choices are free at this instant only.

    With `departures` only those runs that depart from first come, first served no more often than that: most races
    need one or two (Musuvathi and Qadeer, PLDI 2007).
    """
    count = sum(1 for _ in itertools.islice(interleavings(play, at=at, departures=departures), MOST))
    assert count < MOST, f"{MOST} interleavings or more"
    return count


def interleavings(
    play: Callable[[GuidedScheduler], None],
    *,
    at: float | None = None,
    departures: int | None = None,
    begin: Sequence[int] = (),
) -> Iterator[Sequence[int] | None]:
    """Play one after the other, from `begin` on; how the next begins, after each, None after the last."""
    taken: Sequence[int] | None = begin
    while taken is not None:
        choices = _Choices(taken)
        scheduler = GuidedScheduler(choices, lambda name, low, high: low)
        choices.free = lambda scheduler=scheduler: at is None or scheduler.now == at  # type: ignore[misc]
        play(scheduler)
        taken = choices.following(departures)
        yield taken


class _Choices:
    """The choices of one run: given at its beginning, the first of each from there on."""

    def __init__(self, given: Sequence[int]) -> None:
        self._given = given
        self._taken: list[tuple[int, int]] = []  # which, of how many
        self.free: Callable[[], bool] = lambda: True

    def __call__(self, options: Sequence[str]) -> int:
        if not self.free():
            return 0
        number = len(self._taken)
        which = self._given[number] if number < len(self._given) else 0
        self._taken.append((which, len(options)))
        return which

    def following(self, departures: int | None) -> list[int] | None:
        """The beginning of the next run, depth first; None behind the last."""
        while self._taken:
            which, count = self._taken.pop()
            before = [chosen for chosen, _ in self._taken]
            allowed = departures is None or sum(map(bool, before)) < departures
            if which + 1 < count and allowed:
                return [*before, which + 1]
        return None


class Stage:
    """Actions that take their time, and a log of what they do: who begins, who is over, and whether by itself."""

    def __init__(self, scheduler: GuidedScheduler) -> None:
        self.scheduler = scheduler
        self.log: list[tuple[float, str, str]] = []
        self.running: set[str] = set()
        self.together = 0  # the most that ran at one time
        self.host = Host("stage")
        acts = self.host.process(limit=100.0, abandon=lambda name, seconds: self._over(name, "abandoned"), name="Act")
        acts(self._act)
        self.executer = Executer(Program(), scheduler=scheduler, host=self.host, budgets=STEPS)
        guide(self.executer, scheduler)

    def _act(self, name: str, seconds: float) -> Iterator[float]:
        self.log.append((self.scheduler.now, "begun", name))
        self.running.add(name)
        self.together = max(self.together, len(self.running))
        yield seconds
        self._over(name, "ended")

    def _over(self, name: str, how: str) -> None:
        self.running.remove(name)
        self.log.append((self.scheduler.now, how, name))

    def times(self, how: str, name: str) -> list[float]:
        return [time for time, what, who in self.log if (what, who) == (how, name)]
