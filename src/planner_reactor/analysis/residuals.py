"""What is left of a running process, written as a process again, so that people can read where it has come to.

By the rules: `A:;B` in the midst of A' is `A' : (B ; (A:;B))` (N8), a body that runs is followed by its loop, kept
bindings do not show. A part that is as a definition begins is written as the call of that definition. What text
cannot say is written as a call too: `await[s, k]` for an ASSERT that waits, `Delay[t - age]` for a delay under way.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TypeAlias

import msgspec

from planner_reactor.rs.configurations import Config, World
from planner_reactor.rs.evolves import begin, started
from planner_reactor.rs.given import constant, process_with_values
from planner_reactor.rs.states import (
    Await,
    Bindings,
    Chain,
    Deciding,
    Delivered,
    Ended,
    Export,
    Group,
    Inverted,
    Keep,
    Leaf,
    Queued,
    Round,
    Run,
    Serve,
    Spawning,
    Testing,
    Waiting,
)
from planner_reactor.rs.terms import (
    ABORT,
    STOP,
    All,
    Call,
    Cond,
    Disable,
    If,
    Not,
    Par,
    Process,
    Schema,
    Seq,
    Value,
    Variable,
    cond,
    seq,
)

Head: TypeAlias = tuple[str, tuple[Value, ...]]
"""A definition and the values that it was called with."""

GROUPS: Mapping[str, type[Par] | type[All] | type[Disable]] = {"|": Par, "&": All, "#": Disable}


class Noting(World, frozen=True):
    """A world that notes which definitions are called with which values, in order."""

    noted: dict[Head, None] = msgspec.field(default_factory=dict)

    def select(self, name: str, values: tuple[Value, ...]) -> Schema | None:
        self.noted[name, values] = None
        return super().select(name, values)


class Residuals(msgspec.Struct, frozen=True):
    """Writes running terms of one world as processes; `heads` are the definitions that may be recognised."""

    heads: Mapping[Run, Head]

    @classmethod
    def of(cls, heads: Iterable[Head], world: World) -> Residuals:
        found: dict[Run, Head] = {}
        for name, values in heads:
            body = _body(started(called(name, values), world).roots[0][1])
            if not isinstance(body, Leaf | Ended | Keep):
                found.setdefault(body, (name, values))
        return cls(found)

    def network(self, config: Config, world: World) -> Process:
        """What all roots have become, side by side."""
        parts = [self.residual(term, world) for _, term in config.roots]
        return parts[0] if len(parts) == 1 else Par(tuple(parts))

    def residual(self, term: Run, world: World) -> Process:
        """What is left of one term."""
        if (head := self.heads.get(term)) is not None:
            return called(*head)
        match term:
            case Ended(ok):
                return STOP if ok else ABORT
            case Leaf() | Await() | Queued() | Waiting() | Delivered():
                return _leaf(term)
            case Export(renamed, body) if renamed and (head := self.heads.get(body)) is not None:
                return Call(head[0], tuple(map(constant, head[1])), tuple(outer for _, outer in renamed))
            case Keep(_, body) | Export(_, body) | Serve(body=body):
                return self.residual(body, world)
            case Group(operator, parts):
                return _flat(GROUPS[operator], [self.residual(part, world) for part in parts])
            case Inverted(body):
                return Not(self.residual(body, world))
            case Chain(operator, current, rest, scope):
                follows = _bound(rest, scope)
                compose = seq if operator == ";" else cond
                return _chained(compose, Seq if operator == ";" else Cond, self.residual(current, world), follows)
            case Deciding(test, branches, scope):
                left = _bound(branches, scope)
                assert isinstance(left, If)
                return If(self.residual(test, world), left.then, left.otherwise)
            case Testing() | Round() | Spawning():
                return self._loop(term, world)

    def _loop(self, term: Testing | Round | Spawning, world: World) -> Process:
        head = self.heads.get(begin(term.loop, term.scope, world))
        loop = called(*head) if head is not None else _bound(term.loop, term.scope)
        match term:
            case Round(body):
                return seq(self.residual(body, world), loop)
            case Testing(condition):
                if _fresh(term, world):
                    return loop
                return cond(self.residual(condition, world), seq(_bound(term.loop.body, term.scope), loop))
        bodies = [self.residual(body, world) for body in term.bodies]
        if _fresh(term, world):
            return _flat(Par, [*bodies, loop])
        again = Par((_bound(term.loop.body, term.scope), loop))
        return _flat(Par, [*bodies, cond(self.residual(term.condition, world), again)])


def called(name: str, values: tuple[Value, ...]) -> Call:
    """The call of a definition with these values."""
    return Call(name, tuple(map(constant, values)))


def _body(term: Run) -> Run:
    return term.body if isinstance(term, Export) else term


def _bound(process: Process, scope: Bindings) -> Process:
    return process_with_values(process, dict(scope), Variable)


def _fresh(term: Testing | Spawning, world: World) -> bool:
    """Has its condition only just begun?"""
    begun = begin(term.loop, term.scope, world)
    return isinstance(begun, Testing | Spawning) and begun.condition == term.condition


def _flat(kind: type[Par] | type[All] | type[Disable], parts: list[Process]) -> Process:
    inner = [p for part in parts for p in (part.parts if isinstance(part, kind) else (part,))]
    return inner[0] if len(inner) == 1 else kind(tuple(inner))


def _chained(
    compose: object, kind: type[Seq] | type[Cond], first: Process, follows: Process
) -> Process:
    assert callable(compose)
    parts = first.parts if isinstance(first, kind) else (first,)
    chained: Process = compose(*parts, follows)
    return chained


def _leaf(term: Leaf | Await | Queued | Waiting | Delivered) -> Call:
    match term:
        case Leaf("Delay" | "SUSPEND" | "Term", (duration,), age=age) if not (isinstance(age, float) and age == 0.0):
            spent = age * 1000 if term.name == "SUSPEND" else age
            return Call(term.name, (constant(duration - spent),))  # type: ignore[operator]
        case Leaf(name, arguments, results):
            return Call(name, tuple(map(constant, arguments)), results)
        case Await(instance, results):
            return Call("await", (constant(int(instance)),), results)
        case Queued(_, leaf):
            return Call(leaf.name, tuple(map(constant, leaf.arguments)), leaf.results)
        case Waiting(name, situation):
            return Call(name, (constant(situation),))
        case Delivered(situation, instance):
            return Call("SIT", (constant(situation), constant(int(instance))))
