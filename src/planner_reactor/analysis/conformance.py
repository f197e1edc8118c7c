"""Does a run do only what the semantics allows? Follow its labels, step by step, through `rs.evolves`.

A `Follower` holds every configuration that the run may be in (a label may fit several steps). It is told the labels
that an observer of a run sees, and the time that passes; where nothing fits, the run and the semantics disagree.
It can be told of what comes from outside, too: roots that begin or are killed, definitions that come and go, what a
failed assumption disables. So any run can be followed from its beginning on.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Hashable, Iterable

from msgspec.structs import replace

from planner_reactor.errors import BudgetError, PlannerReactorError
from planner_reactor.rs.configurations import Config, Ending, Label, Oracle, World, spawned_situations
from planner_reactor.rs.evolves import killed, settle, started
from planner_reactor.rs.leaves import Offer, elapsed, offers, slack, steps, urgent
from planner_reactor.rs.states import Bindings, Ended
from planner_reactor.rs.store import Store
from planner_reactor.rs.terms import Process, Schema, Value

TOLERANCE = 1e-6
"""Seconds by which two clocks may differ."""

MOST = 64
"""Configurations that are followed at once: beyond, the labels of a run say too little to follow it further."""


class Disagreement(PlannerReactorError):
    """A run did what the semantics does not allow."""


class Follower:
    """Follows one run of some processes that were started together, in at most `most` configurations at once.

    `steps` is how many it has seen, `last` are the latest of them.
    """

    def __init__(self, processes: Iterable[Process], world: World, *, most: int = MOST, kept: int = 20) -> None:
        self._world = world
        self._most = most
        config = Config()
        for process in processes:
            config = started(process, world, config=config)
        self.configs: tuple[Config, ...] = (config,)
        self.steps = 0
        self.last: deque[Label] = deque(maxlen=kept)

    def saw(self, label: Label, sites: tuple[Hashable, ...] = ()) -> None:
        """The run took a step with this label, by leaves that stand at `sites` in the text, if that is known."""
        self.last.append(label)
        name, arguments, status, values = label
        world = replace(self._world, endings=_oracle(name, arguments, status == "ok", values))
        found = ((c, o) for c in self.configs for o in offers(c, world, seen=label))
        after = _different([o.taken(c, world) for c, o in found if _stand_at(o, sites)])
        if not after:
            offered = sorted({str(s.label) for c in self.configs for s in steps(c, self._world)})
            raise Disagreement(f"step {self.steps + 1}: saw {label}, allowed: {'; '.join(offered) or 'nothing'}")
        if len(after) > self._most:
            raise BudgetError("configurations", f"step {self.steps + 1}: the run may be in {len(after)} states")
        self.configs = after
        self.steps += 1

    def passed(self, seconds: float) -> None:
        """The run let this much time pass."""
        if seconds <= 0:
            return
        patient = [c for c in self.configs if not urgent(c, self._world)]
        if not patient:
            wanted = sorted({str(s.label) for c in self.configs for s in steps(c, self._world) if s.urgent})
            raise Disagreement(f"{seconds} s passed though something is urgent: {'; '.join(wanted)}")
        room = [(c, slack(c, self._world)) for c in patient]
        allowed = [(c, most) for c, most in room if most >= seconds - TOLERANCE]
        if not allowed:
            raise Disagreement(f"{seconds} s passed, at most {max(most for _, most in room)} allowed")
        self.configs = _different([elapsed(c, min(seconds, most), self._world) for c, most in allowed])

    def room(self) -> float:
        """Seconds that may pass now, whatever configuration the run is in."""
        return min(0.0 if urgent(c, self._world) else slack(c, self._world) for c in self.configs)

    # -- from outside

    def begins(self, root: int, process: Process, scope: Bindings = ()) -> None:
        """A root of this number begins to run a process."""
        self.configs = tuple(
            started(process, self._world, config=c, scope=scope, number=root) for c in self.configs
        )

    def kills(self, root: int) -> None:
        """A root is aborted from outside."""
        self.configs = _different([killed(c, root, self._world) for c in self.configs])

    def forgets(self, root: int) -> None:
        """Nobody will ask any more how this root has ended."""
        kept = [replace(c, roots=tuple((n, t) for n, t in c.roots if n != root)) for c in self.configs]
        self.configs = _different(kept)

    def learns(self, schemas: Iterable[Schema], *, without: Iterable[Schema] = ()) -> None:
        """Definitions come, others go."""
        program = self._world.program.without(without).with_schemas(schemas)
        spawned = self._world.spawned | spawned_situations(program)
        self._world = replace(self._world, program=program, spawned=spawned)

    def disables(self, situation: str, assumption: str) -> None:
        """An assumption that has failed disables a situation, if it does not yet."""
        owner = ("assumption", assumption)

        def disabled(store: Store) -> Store:
            known = any(h.situation == situation and h.owner == owner for h in store.inhibitions)
            return store if known else store.inhibit(situation, owner, "assumption")

        self._settled(disabled)

    def enables(self, situation: str, assumption: str) -> None:
        """It does so no longer."""
        self._settled(lambda store: store.uninhibit(situation, ("assumption", assumption)))

    def _settled(self, change: Callable[[Store], Store]) -> None:
        changed = [replace(c, store=change(c.store)) for c in self.configs]
        self.configs = _different([settle(c, self._world) for c in changed])

    # -- how it ends

    def ended(self, root: int, *, ok: bool, results: Bindings) -> None:
        """The run says that this root (1, 2, …) has ended so."""
        fitting = [c for c in self.configs if c.root(root) == Ended(ok, results)]
        if not fitting:
            allowed = [c.root(root) for c in self.configs]
            raise Disagreement(f"root {root} ended with {ok}, {results}; allowed: {allowed}")
        self.configs = tuple(fitting)

    def runs(self, root: int) -> None:
        """The run says that this root has not ended."""
        fitting = [c for c in self.configs if not isinstance(c.root(root), Ended)]
        if not fitting:
            raise Disagreement(f"root {root} runs; it should have ended: {[c.root(root) for c in self.configs]}")
        self.configs = tuple(fitting)


def _stand_at(offer: Offer, sites: tuple[Hashable, ...]) -> bool:
    """Do the leaves of this step stand where those of the run do? What was not written down stands nowhere."""
    return all(own is None or own == seen for own, seen in zip(offer.sites, sites, strict=False))


def _different(configs: list[Config]) -> tuple[Config, ...]:
    return tuple(dict.fromkeys(configs)) if len(configs) > 1 else tuple(configs)


def _oracle(name: str, arguments: tuple[Value, ...], ok: bool, values: tuple[Value, ...]) -> Oracle:
    def endings(asked: str, given: tuple[Value, ...]) -> Iterable[Ending]:
        return [(ok, values)] if (asked, given) == (name, arguments) else []

    return endings
