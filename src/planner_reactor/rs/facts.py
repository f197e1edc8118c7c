"""What one walk over a definition finds: its calls, the loops that serve situations, what stands beside a
guard.

The static checks read these facts instead of walking the terms again, each on its own.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

import msgspec

from planner_reactor.errors import Place
from planner_reactor.rs.terms import (
    Apply,
    Call,
    Disable,
    Expression,
    Loop,
    Negative,
    Operation,
    Process,
    Spawn,
    Symbol,
    Variable,
    operands,
)


class Service(msgspec.Struct, frozen=True):
    """A loop that serves the instances of a situation, `SIT[s]<k, …> :; body` or `::`."""

    sit: Call
    body: Process
    spawns: bool

    @property
    def situation(self) -> Expression | None:
        return self.sit.arguments[0] if self.sit.arguments else None


@dataclass(slots=True)
class Facts:
    """What was found in one process, left to right.

    `binders` maps the names of results to where they are bound first; `strays` are the SITs that are not the
    whole left operand of a loop; `guarded` are the reactions: what stands beside an `E[…]` in a `#`;
    `families` are the names X of `E[k] # X[k]`, where k is a variable.
    """

    calls: list[Call] = field(default_factory=list)
    binders: dict[str, Place | None] = field(default_factory=dict)
    services: list[Service] = field(default_factory=list)
    strays: list[Call] = field(default_factory=list)
    guarded: list[Process] = field(default_factory=list)
    families: list[str] = field(default_factory=list)


def facts_of(process: Process) -> Facts:
    """The facts of one process."""
    facts = Facts()
    _collect(process, facts)
    return facts


def names(expressions: tuple[Expression, ...]) -> Iterator[Symbol | Variable]:
    """The symbols and variables in these expressions, left to right."""
    for expression in expressions:
        match expression:
            case Symbol() | Variable():
                yield expression
            case Negative(operand):
                yield from names((operand,))
            case Operation(_, left, right):
                yield from names((left, right))
            case Apply(_, arguments):
                yield from names(arguments)


def _collect(process: Process, facts: Facts) -> None:
    match process:
        case Call(name):
            _note(process, facts)
            if name == "SIT":
                facts.strays.append(process)
        case Loop(Call("SIT") as sit, body) | Spawn(Call("SIT") as sit, body):
            facts.services.append(Service(sit, body, isinstance(process, Spawn)))
            _note(sit, facts)
            _collect(body, facts)
        case _:
            if isinstance(process, Disable):
                _collect_guards(process, facts)
            for part in operands(process):
                _collect(part, facts)


def _note(call: Call, facts: Facts) -> None:
    facts.calls.append(call)
    for name in call.results:
        facts.binders.setdefault(name, call.place)


def _collect_guards(process: Disable, facts: Facts) -> None:
    guards = [p for p in process.parts if isinstance(p, Call) and p.name == "E"]
    if not guards:
        return
    others = [p for p in process.parts if not (isinstance(p, Call) and p.name == "E")]
    facts.guarded.extend(others)
    labels = [g.arguments for g in guards if g.arguments and isinstance(g.arguments[0], Variable)]
    facts.families.extend(p.name for p in others if isinstance(p, Call) and p.arguments in labels)
