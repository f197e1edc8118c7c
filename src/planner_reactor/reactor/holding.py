"""What a reaction can do about situations that are held back: wait for it, and bring it about at once.

DISABLED[s]<a> stops while a failed assumption disables s, ENABLED[s] while none does: cleanups and default safety
reactions are roots that begin with them (R §10, second flaw; T, "Architecture"; docs/reactor.md). FREEZE[s] is R §5.5's
stronger boundedness: it inhibits s and aborts what is in service of it and below it, in an orderly way (N9).
"""

from __future__ import annotations

from collections.abc import Iterator

from planner_reactor.reactor.controls import ERROR, STOPPED, Begin, BuiltIn, Sit, served
from planner_reactor.reactor.instances import Instance
from planner_reactor.reactor.situations import Situations
from planner_reactor.reactor.wakers import Waker
from planner_reactor.rs.terms import Value
from planner_reactor.runtime import Body, Outcome, Strand


class Holding:
    """DISABLED, ENABLED and FREEZE, on one store of situations."""

    def __init__(self, situations: Situations, sit: Sit, waker: Waker) -> None:
        self._situations = situations
        self._sit = sit
        self._waker = waker
        self._waiting: dict[str, dict[Strand, bool]] = {}  # situation → who waits, and whether for its being disabled
        situations.flipped = self._flipped
        situations.awaited = lambda name: any(self._waiting.get(name, {}).values())

    def __iter__(self) -> Iterator[BuiltIn]:
        yield BuiltIn("DISABLED", self._until(disabled=True), self._left, resting=True)
        yield BuiltIn("ENABLED", self._until(disabled=False), self._left, resting=True)
        yield BuiltIn("FREEZE", self._freeze)

    def _until(self, *, disabled: bool) -> Begin:
        def begin(strand: Strand, arguments: tuple[Value, ...]) -> Outcome | None:
            name = str(arguments[0])
            assumption = self._situations.disabled_by(name)
            if (assumption is not None) is not disabled:
                self._waiting.setdefault(name, {})[strand] = disabled
                return None
            self._left(strand)
            return STOPPED if assumption is None else Outcome(True, (assumption,))

        return begin

    def _flipped(self, name: str) -> None:
        for strand in list(self._waiting.get(name, ())):
            self._waker.wake(strand)

    def _left(self, strand: Strand) -> None:
        for waiting in self._waiting.values():
            waiting.pop(strand, None)

    def _freeze(self, strand: Strand, arguments: tuple[Value, ...]) -> Outcome:
        name = str(arguments[0])
        concerned = {b: None for b in self._sit.bodies if _below(served(b)[0], name)}
        if any(body in concerned for body in _around(strand.body)):
            return ERROR
        self._situations.inhibit(name, strand.root)
        for body in concerned:
            if not any(outer in concerned for outer in _around(body.parent)):
                self._situations.notice("frozen", situation=name, instance=served(body)[0].number)
                self._waker.cut(body, "frozen")
        return STOPPED


def _below(instance: Instance | None, name: str) -> bool:
    """Is it an instance of this situation, or below one?"""
    while instance is not None and instance.situation.name != name:
        instance = instance.owner
    return instance is not None


def _around(body: Body | None) -> Iterator[Body]:
    """This body and those around it."""
    return iter(()) if body is None else body.enclosing()
