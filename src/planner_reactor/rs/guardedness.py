"""Nothing may go on for ever without a step (N7, N8 of `semantics`).

Calls, STOP, ABORT, `if`, the rounds of loops and the endings of compositions are silent; every other process
takes at least one step. A definition that reaches a call of itself silently would unfold for ever at one
instant, and so would a loop whose round is silent. This is decided from how processes can end silently and
which calls they make before their first step, clause by clause.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import msgspec

from planner_reactor.errors import Diagnostic
from planner_reactor.rs.graphs import cycles, solve, way_round
from planner_reactor.rs.linking import Linked, error
from planner_reactor.rs.terms import (
    All,
    Call,
    Cond,
    Disable,
    If,
    Loop,
    Not,
    Par,
    Process,
    Seq,
    Spawn,
    calls,
    operands,
)


class Silent(msgspec.Struct, frozen=True):
    """How a process may end without a step."""

    stops: bool = False
    aborts: bool = False

    @property
    def ends(self) -> bool:
        return self.stops or self.aborts


NEVER = Silent()


def check_guardedness(linked: Linked) -> Iterator[Diagnostic]:
    """Errors "unguarded-recursion" and "silent-loop"."""
    bodies = {number: linked.schemas[number].body for number in linked.calls_in_focus}
    known = solve(linked.calls_in_focus, NEVER, lambda n, known: Silence(linked, known).of(bodies[n]))
    silence = Silence(linked, known)
    for number in linked.focus:
        yield from (_silent_loop(linked, number, loop) for loop in silence.loops(bodies[number]))
    first_calls: dict[int, tuple[int, ...]] = {}
    for number, body in bodies.items():
        first = (t for call in silence.first_calls(body) for t in linked.targets(call))
        first_calls[number] = tuple(dict.fromkeys(first))
    for cycle in cycles(first_calls):
        yield _recursion(linked, way_round(first_calls, cycle[0]))


class Silence:
    """How processes end, and what they call, before their first step; `known` says it of definitions."""

    def __init__(self, linked: Linked, known: Mapping[int, Silent]) -> None:
        self._linked = linked
        self._known = known
        self._found: dict[int, Silent] = {}  # by identity: what is nested deeply is asked from every level above it

    def of(self, process: Process) -> Silent:
        """How this process may end without a step."""
        if (found := self._found.get(id(process))) is None:
            found = self._found[id(process)] = self._ends(process)
        return found

    def _ends(self, process: Process) -> Silent:
        match process:
            case Call("STOP"):
                return Silent(stops=True)
            case Call("ABORT"):
                return Silent(aborts=True)
            case Call():
                ends = [self._known[t] for t in self._linked.targets(process)]
                return Silent(any(e.stops for e in ends), any(e.aborts for e in ends))
            case Seq(parts):
                return self.of(parts[-1]) if all(self.of(p).ends for p in parts[:-1]) else NEVER
            case Cond(parts):
                return self._cond(parts)
            case Par(parts):
                ends = [self.of(p) for p in parts]
                return Silent(*_all_ended(ends, [e.stops for e in ends], [e.aborts for e in ends]))
            case All(parts):
                ends = [self.of(p) for p in parts]
                aborts, stops = _all_ended(ends, [e.aborts for e in ends], [e.stops for e in ends])
                return Silent(stops, aborts)
            case Disable(parts):
                ends = [self.of(p) for p in parts]
                return Silent(any(e.stops for e in ends), any(e.aborts for e in ends))
            case Not(body):
                inner = self.of(body)
                return Silent(inner.aborts, inner.stops)
            case Loop(condition, _) | Spawn(condition, _):
                return Silent(aborts=self.of(condition).aborts)
            case If(test, then, otherwise):
                tested = self.of(test)
                taken = [self.of(then)] * tested.stops + [self.of(otherwise)] * tested.aborts
                return Silent(any(e.stops for e in taken), any(e.aborts for e in taken))

    def _cond(self, parts: tuple[Process, ...]) -> Silent:
        aborts = False
        for part in parts:
            ends = self.of(part)
            aborts = aborts or ends.aborts
            if not ends.stops:
                return Silent(aborts=aborts)
        return Silent(True, aborts)

    def first_calls(self, process: Process) -> Iterator[Call]:
        """The calls that this process may make without a step before them."""
        match process:
            case Call():
                yield process
            case Seq(parts):
                for part in parts:
                    yield from self.first_calls(part)
                    if not self.of(part).ends:
                        return
            case Cond() | Loop() | Spawn():
                for part in operands(process):
                    yield from self.first_calls(part)
                    if not self.of(part).stops:
                        return
            case If(test, then, otherwise):
                tested = self.of(test)
                yield from self.first_calls(test)
                yield from self.first_calls(then) if tested.stops else ()
                yield from self.first_calls(otherwise) if tested.aborts else ()
            case _:
                for part in operands(process):
                    yield from self.first_calls(part)

    def loops(self, process: Process) -> Iterator[Loop | Spawn]:
        """The loops anywhere in this process of which a round may pass without a step."""
        match process:
            case Loop(condition, body) if self.of(condition).stops and self.of(body).ends:
                yield process
            case Spawn(condition, _) if self.of(condition).stops:  # the next round does not wait for the body
                yield process
        for part in operands(process):
            yield from self.loops(part)


def _all_ended(ends: list[Silent], one: list[bool], every: list[bool]) -> tuple[bool, bool]:
    """When all parts have ended: may one have ended as in `one`, and may all have ended as in `every`?"""
    return all(e.ends for e in ends) and any(one), all(every)


def _silent_loop(linked: Linked, number: int, loop: Loop | Spawn) -> Diagnostic:
    place = next((call.place for call in calls(loop) if call.place), linked.place(number))
    if isinstance(loop, Spawn):
        message = "this `::` spawns for ever at one instant"
        hint = "its condition must take a step before it stops; `:;` waits for the body"
    else:
        message = "a round of this `:;` may pass without a step"
        hint = "its condition or its body must take a step: a test, a Delay, a process of the host"
    return error(place, "silent-loop", message, hint)


def _recursion(linked: Linked, way: list[int]) -> Diagnostic:
    schema = linked.schemas[way[0]]
    around = " → ".join(linked.schemas[number].name for number in way)
    message = f"{schema.name} calls itself before it takes a step ({around})"
    hint = "put a process that takes a step before the call"
    return error(schema.place, "unguarded-recursion", message, hint)
