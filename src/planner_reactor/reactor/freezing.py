"""A running situation is stopped on demand, and let go again (R §5.5: INHIBIT used to "freeze" it).

    FREEZE[s] : (cleanup ; NIL)

runs as a root of its own, which holds the situation until it is thawed. What is in service of it, and below it, aborts:
each basic process with its one `abandon`; what then has to be put in order is the *cleanup*, a process in RS that
somebody has deliberated. The instance stays on: it is served anew, from its beginning, when the situation is thawed, or
it is given up by an adaptation that changes the situation meanwhile. Nothing is in service any more, so that such an
adaptation has nothing to wait for: this is R's stronger boundedness, at the price of the cleanup.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from planner_reactor.errors import InputError, RSError
from planner_reactor.rs.loading import load
from planner_reactor.rs.terms import Call, Process, Symbol, cond, seq
from planner_reactor.rs.vocabulary import BUILT_IN
from planner_reactor.runtime import Root

if TYPE_CHECKING:
    from planner_reactor.reactor.reactor import Reactor

CLEANUP = "Cleanup"


class Freezer:
    """Freezes and thaws the situations of one reactor."""

    def __init__(self, reactor: Reactor) -> None:
        self._reactor = reactor
        self._roots: dict[str, Root] = {}

    @property
    def frozen(self) -> tuple[str, ...]:
        """The situations that are frozen, in the order in which they were."""
        return tuple(s for s, root in self._roots.items() if root.outcome is None)

    def freeze(self, situation: str, cleanup: str = "STOP") -> None:
        """Stop what is in service of the situation, then run the cleanup; nothing of it is served until `thaw`.

        `InputError` if the situation is frozen already, the reactor is halted, or the cleanup is no good process.
        """
        if situation in self.frozen:
            raise InputError(f"{situation} is frozen already")
        if self._reactor.halted:
            raise InputError("the reactor is halted: nothing is in service")
        after = seq(self._process(cleanup), Call("NIL"))
        script = cond(Call("FREEZE", (Symbol(situation),)), after)
        self._roots[situation] = self._reactor.executer.start_process(script, name=f"freeze {situation}")

    def thaw(self, situation: str) -> None:
        """Let it go: what is on is served anew, a running cleanup is aborted. `InputError` if it is not frozen."""
        if situation not in self.frozen:
            raise InputError(f"{situation} is not frozen, frozen are: {', '.join(self.frozen) or 'none'}")
        self._reactor.executer.kill(self._roots.pop(situation))

    def _process(self, text: str) -> Process:
        host = self._reactor.host
        signatures = {**BUILT_IN, **host.signatures}
        try:
            program = load(f"{CLEANUP} = {text}", file="<cleanup>", signatures=signatures, functions=host.functions)
        except RSError as problem:
            raise InputError(str(problem)) from None
        (schema,) = program.schemas
        return schema.body
