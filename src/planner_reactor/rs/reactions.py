"""The shape of a reactor, read off its text: which reaction serves which situation, and what it asserts (R §5.4).

The reactor, its analysis and its planner read it here. A reaction is a clause `P[n] = …`; its situation is that of the
SIT in front of its loop (None for a root reaction or a monitor). The situations and what their reactions assert form
the hierarchy of R Figs 8 to 10, an acyclic digraph. A `Surgery` is a change of it, and the scripts that do it are here
too, so that what is verified is what is run.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import TypeAlias

import msgspec

from planner_reactor.rs.terms import (
    STOP,
    Call,
    Loop,
    Number,
    Process,
    Schema,
    Spawn,
    Symbol,
    Text,
    calls,
    cond,
    operands,
)

REACTION = "P"
"""The schema of which every reaction is a clause."""


class Reaction(msgspec.Struct, frozen=True):
    """One clause `P[label]`."""

    label: int
    schema: Schema
    situation: str | None
    asserts: tuple[str, ...]
    stubs: bool
    monitors: tuple[str, ...]

    @property
    def spawns(self) -> bool:
        """Are all instances of its situation served at once (`::`)?"""
        return isinstance(self.schema.body, Spawn)


def reaction_of(schema: Schema) -> Reaction | None:
    """The reaction that a clause describes, or None if it is not of the form `P[n] = …`."""
    match schema:
        case Schema(name=name, head=(Number(int() as label),)) if name == REACTION:
            body = schema.body
            return Reaction(
                label,
                schema,
                served_by(body),
                tuple(_named(body, "ASSERT", "REASSERT")),
                any(True for _ in _named(body, "STUB")),
                tuple(_named(body, "ASSUMONITOR", "HOLDMONITOR")),
            )
        case _:
            return None


class Surgery(msgspec.Struct, frozen=True, kw_only=True):
    """What an adaptation does to a reactor's structure: reactions come and go, these situations are held meanwhile.

    `held` is top-down, `kills` top-down, `adds` bottom-up. `named` are the situations that it changes, held or new.
    """

    held: tuple[str, ...] = ()
    kills: tuple[int, ...] = ()
    adds: tuple[int, ...] = ()
    named: tuple[str, ...] = ()
    removed: tuple[str, ...] = ()  # of `named`: nothing serves them afterwards
    migrated: tuple[tuple[str, tuple[int | str, ...]], ...] = ()  # what becomes of the arguments of what is queued
    number: int | None = None  # what COMMIT makes durable: the id of the adaptation


def drain_script(surgery: Surgery) -> Process:
    """Safe adaptation: `DRAIN[top] : … : COMMIT[id] : KILL[old] : … : POST[new] : … : UNINHIBIT[top]`.

    `MIGRATE[s, …]` follows COMMIT where a situation takes other parameters.
    """
    return _script([Call("DRAIN", (Symbol(s),)) for s in surgery.held], surgery, surgery.held)


def wait_script(surgery: Surgery) -> Process:
    """The papers' (R §5.5): WAITINHIBIT, top-down, on every situation whose reactions change."""
    return _script([Call("WAITINHIBIT", (Symbol(s),)) for s in surgery.held], surgery, surgery.held)


def versions_script(surgery: Surgery, killed: Iterable[Reaction]) -> Process:
    """Old and new beside each other: `COMMIT[id] : RETIRE[old] : … : RENEW[s] : … : POST[new] : …`, in an instant."""
    steps = [
        *_commit(surgery),
        *(Call("RETIRE", (Number(r.label),)) for r in killed),
        *(Call("RENEW", (Symbol(s),)) for s in surgery.named if s not in surgery.removed),
        *(Call("POST", (Number(n),)) for n in surgery.adds),
    ]
    return cond(*steps) if steps else STOP


def removal_script(surgery: Surgery, killed: Iterable[Reaction]) -> Process:
    """What was retired goes, top-down, once nothing is left that it may serve: `WAITOLD[s] : KILL[old] : …`.

    A removed situation is renewed when whoever asserted it has gone: what comes back meanwhile is not waited for.
    Monitors go last: as long as anything of the old is left, what it rests on is watched.
    """
    steps: list[Process] = []
    waited: set[str] = set()
    for reaction in sorted(killed, key=lambda reaction: reaction.situation is None):
        if (situation := reaction.situation) is None:
            steps.append(Call("KILL", (Number(reaction.label),)))
            continue
        if situation not in waited:
            waited.add(situation)
            ends = ("RENEW", "WAITOLD") if situation in surgery.removed else ("WAITOLD",)
            steps += [Call(name, (Symbol(situation),)) for name in ends]
        steps.append(Call("KILL", (Number(reaction.label),)))
    return cond(*steps) if steps else STOP


def _commit(surgery: Surgery) -> list[Process]:
    return [] if surgery.number is None else [Call("COMMIT", (Number(surgery.number),))]


def _migrate(surgery: Surgery) -> list[Process]:
    """Before what asserted it is removed: from then on what is queued stays without it."""
    return [
        Call("MIGRATE", (Symbol(s), *(Number(way) if isinstance(way, int) else Symbol(way) for way in how)))
        for s, how in surgery.migrated
    ]


def _script(hold: list[Process], surgery: Surgery, held: tuple[str, ...]) -> Process:
    steps = [*hold, *_commit(surgery), *_migrate(surgery), *(Call("KILL", (Number(n),)) for n in surgery.kills)]
    steps += [Call("POST", (Number(n),)) for n in surgery.adds]
    steps += [Call("UNINHIBIT", (Symbol(s),)) for s in reversed(held)]
    return cond(*steps) if steps else STOP


_RESTS = frozenset({"ASSERT", "REASSERT", "DISABLED", "ENABLED", "STOP", "ABORT", "NIL"})


def rests_when_drained(process: Process) -> bool:
    """Is a reaction that serves no situation at rest whenever all that it asserts is drained?

    It senses in the conditions of its loops; in their bodies it does nothing but assert.
    """
    working = operands(process)[1:] if isinstance(process, Loop | Spawn) else (process,)
    return all(call.name in _RESTS for part in working for call in calls(part))


def served_by(process: Process) -> str | None:
    """The situation whose instances this process serves."""
    match process:
        case Loop(Call("SIT", (Symbol(name) | Text(name), *_)), _):
            return name
        case Spawn(Call("SIT", (Symbol(name) | Text(name), *_)), _):
            return name
        case _:
            return None


def _named(process: Process, *names: str) -> Iterator[str]:
    """The first arguments of the calls with these names, each once, left to right."""
    seen: set[str] = set()
    for call in calls(process):
        if call.name in names and call.arguments and isinstance(call.arguments[0], Symbol | Text):
            first = call.arguments[0]
            name = first.name if isinstance(first, Symbol) else first.value
            if name not in seen:
                seen.add(name)
                yield name


def children(reactions: Iterable[Reaction]) -> dict[str, tuple[str, ...]]:
    """Situation → the situations that its reactions assert."""
    found: dict[str, tuple[str, ...]] = {}
    for reaction in reactions:
        if reaction.situation is not None:
            found[reaction.situation] = (*found.get(reaction.situation, ()), *reaction.asserts)
    return found


Onward: TypeAlias = Callable[[str], Iterable[str]]
"""Where one gets from a situation in one step: those that its reactions assert, say."""


def reach(start: Iterable[str], onward: Onward) -> set[str]:
    """What can be reached from any of these by one step or more."""
    found: set[str] = set()
    waiting = list(start)
    while waiting:
        for name in onward(waiting.pop()):
            if name not in found:
                found.add(name)
                waiting.append(name)
    return found


def upside_down(order: Sequence[str], below: Onward) -> tuple[str, str] | None:
    """A situation that comes before one above it: (first, above it), or None."""
    for n, later in enumerate(order[1:], 1):
        reached = reach([later], below)
        if found := [earlier for earlier in order[:n] if earlier in reached]:
            return found[0], later
    return None


def cycle(below: Mapping[str, tuple[str, ...]]) -> tuple[str, ...] | None:
    """A situation that is asserted from below itself, with the way round, or None."""
    done: set[str] = set()
    for start in below:
        stack, trail = [(start, iter(below.get(start, ())))], [start]
        while stack:
            name, rest = stack[-1]
            child = next(rest, None)
            if child is None:
                stack.pop()
                trail.pop()
                done.add(name)
            elif child in trail:
                return (*trail[trail.index(child) :], child)
            elif child not in done:
                stack.append((child, iter(below.get(child, ()))))
                trail.append(child)
    return None
