"""Run-time terms: what a process has become while it runs (docs/language.md, "Run-time terms and store").

`evolves` rewrites these terms. Legend, with the notation of the rules on the left:

    ok.r, ab.r      Ended       terminated, with bindings r
    a leaf          Leaf        a basic or built-in process that has come to life, with its age
    await_{s,k}<x>  Await       an ASSERT (or REASSERT) that waits for its instance
    –               Queued      an ASSERT held back while its situation is drained or disabled
    –               Waiting     a WAIT, WAITINHIBIT or DRAIN that has begun
    P;Q  P:Q        Chain       the part that runs, and what is still to come
    r>T             Keep        bindings kept for the outside
    [T]_A, [T]_{r→y} Export     only these results leave, under these names
    {T}_{s,k,g}     Serve       a body of instance k of s, served by reaction g
    A:;B            Testing, Round
    A::B            Spawning

A continuation that has not begun is source text with the bindings in scope, `Bindings` restricted to the
names that it uses, so that equal states are equal values.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cached_property, lru_cache
from typing import ClassVar, Literal, TypeAlias

import msgspec
from msgspec.structs import replace

from planner_reactor.errors import Place
from planner_reactor.rs.terms import (
    Apply,
    Call,
    Expression,
    If,
    Loop,
    Negative,
    Operation,
    Process,
    Spawn,
    Value,
    Variable,
    calls,
)

Bindings: TypeAlias = tuple[tuple[str, Value], ...]
"""Names and values, sorted by name."""


class InstanceNumber(int):
    """The number k of a situation instance: an integer that an explorer may rename consistently."""


class Reaction(msgspec.Struct, frozen=True):
    """The identity g of a reaction: the label of its guard, if any, and where its SIT stands in the text."""

    guard: Value | None
    site: Place | None


@dataclass(frozen=True, slots=True)
class Ended:
    """`ok.r` or `ab.r`. The cause is for traces and perceptions; the algebra sees only the outcome."""

    at_rest: ClassVar[bool] = False

    ok: bool
    bindings: Bindings = ()
    cause: str = field(default="", compare=False)


class Delivered(msgspec.Struct, frozen=True):
    """A SIT that has just delivered an instance: what follows it, if anything, is the instance's body."""

    at_rest: ClassVar[bool] = False

    situation: str
    instance: InstanceNumber
    reaction: Reaction
    bindings: Bindings


class Leaf(msgspec.Struct, frozen=True):
    """A basic or built-in process that has come to life.

    `age` in seconds; `opens` marks a SIT whose instance is served by what follows it; `problem` says why its
    arguments have no value.
    """

    at_rest: ClassVar[bool] = True

    name: str
    arguments: tuple[Value, ...] = ()
    results: tuple[str, ...] = ()
    age: float = 0.0
    site: Place | None = None
    opens: bool = False
    problem: str = ""


class Await(msgspec.Struct, frozen=True):
    """`await_{s,k}<x>`; `again` holds the leaf of a REASSERT, to be repeated should the instance fail."""

    at_rest: ClassVar[bool] = False

    instance: InstanceNumber
    results: tuple[str, ...]
    again: Leaf | None = None


class Queued(msgspec.Struct, frozen=True):
    """An ASSERT held back: `ticket` finds it in the store's queue."""

    at_rest: ClassVar[bool] = False

    ticket: InstanceNumber
    leaf: Leaf


class Waiting(msgspec.Struct, frozen=True):
    """A WAIT, WAITINHIBIT or DRAIN that has begun."""

    at_rest: ClassVar[bool] = False

    name: str
    situation: str


class _Composed(msgspec.Struct, frozen=True, dict=True, cache_hash=True):
    """A term with live parts."""

    @cached_property
    def at_rest(self) -> bool:
        """Can nothing in it end within the present step, whatever the store? Then settling passes it by."""
        return all(part.at_rest for part in parts_of(self))  # type: ignore[arg-type]  # each that stands below is a Run


class Chain(_Composed, frozen=True):
    operator: Literal[";", ":"]
    current: Run
    rest: Process
    scope: Bindings


class Keep(_Composed, frozen=True):
    bindings: Bindings
    body: Run

    @cached_property
    def at_rest(self) -> bool:
        return bool(self.bindings) and not isinstance(self.body, Keep) and self.body.at_rest


class Export(_Composed, frozen=True):
    """Only the `renamed` results (inner name, outer name) leave the body; none, for the body of a loop."""

    renamed: tuple[tuple[str, str], ...]
    body: Run

    @cached_property
    def at_rest(self) -> bool:
        return bool(self.renamed or not isinstance(self.body, Export | Keep)) and self.body.at_rest


class Group(_Composed, frozen=True):
    operator: Literal["|", "&", "#"]
    parts: tuple[Run, ...]


class Inverted(_Composed, frozen=True):
    body: Run


class Deciding(_Composed, frozen=True):
    test: Run
    branches: If
    scope: Bindings


class Testing(_Composed, frozen=True):
    """`A:;B` while A runs."""

    condition: Run
    loop: Loop
    scope: Bindings


class Round(_Composed, frozen=True):
    """`A:;B` while B runs."""

    body: Run
    loop: Loop
    scope: Bindings


class Spawning(_Composed, frozen=True):
    """`A::B`: A runs, or has ended, beside the bodies spawned so far; `stopped` if an ended body has
    stopped."""

    condition: Run
    loop: Spawn
    scope: Bindings
    bodies: tuple[Run, ...] = ()
    stopped: bool = False


class Serve(_Composed, frozen=True):
    situation: str
    instance: InstanceNumber
    reaction: Reaction
    body: Run


Run: TypeAlias = (
    Ended | Delivered | Leaf | Await | Queued | Waiting | Chain | Keep | Export | Group | Inverted | Deciding
    | Testing | Round | Spawning | Serve
)  # fmt: skip

Path: TypeAlias = tuple[int, ...]


class Spot(msgspec.Struct, frozen=True):
    """A live leaf of a configuration: where it is, and what encloses it."""

    root: int
    path: Path
    leaf: Run
    guard: Value | None = None
    owner: InstanceNumber | None = None


def parts_of(term: Run) -> tuple[Run, ...]:
    """The live components of a run-time term, left to right."""
    match term:
        case Ended() | Delivered() | Leaf() | Await() | Queued() | Waiting():
            return ()
        case Group(_, parts):
            return parts
        case Spawning(condition, _, _, bodies):
            return (condition, *bodies)
        case Chain(_, current) | Testing(current) | Deciding(current):
            return (current,)
        case Keep(_, body) | Export(_, body) | Inverted(body) | Round(body) | Serve(body=body):
            return (body,)


def with_parts(term: Run, parts: tuple[Run, ...]) -> Run:
    """The same term with other live components."""
    match term:
        case Group(operator):
            return Group(operator, parts)
        case Spawning():
            return replace(term, condition=parts[0], bodies=parts[1:])
        case Chain():
            return replace(term, current=parts[0])
        case Testing():
            return replace(term, condition=parts[0])
        case Deciding():
            return replace(term, test=parts[0])
        case Keep() | Export() | Inverted() | Round() | Serve():
            return replace(term, body=parts[0])
        case _:
            return term


def put(term: Run, path: Path, new: Run) -> Run:
    """The term with `new` at `path`."""
    if not path:
        return new
    parts = parts_of(term)
    changed = put(parts[path[0]], path[1:], new)
    return with_parts(term, (*parts[: path[0]], changed, *parts[path[0] + 1 :]))


def guard_of(term: Run) -> Value | None:
    """The label n of an `E[n] # …`, else None."""
    if isinstance(term, Group) and term.operator == "#":
        for part in term.parts:
            if isinstance(part, Leaf) and part.name == "E" and part.arguments:
                return part.arguments[0]
    return None


def spots(
    term: Run,
    root: int = 0,
    path: Path = (),
    guard: Value | None = None,
    owner: InstanceNumber | None = None,
) -> Iterator[Spot]:
    """Every live leaf, left to right, with the guard and the instance that enclose it."""
    match term:
        case Leaf() | Await() | Queued() | Waiting():
            yield Spot(root, path, term, guard, owner)
        case Ended() | Delivered():
            return
        case _:
            label = guard_of(term)
            guard = guard if label is None else label
            owner = term.instance if isinstance(term, Serve) else owner
            for index, part in enumerate(parts_of(term)):
                yield from spots(part, root, (*path, index), guard, owner)


# ----------------------------------------------------------------------------------------------- bindings


def bind(*many: Bindings) -> Bindings:
    """r + r' + …: later ones win."""
    merged: dict[str, Value] = {}
    for bindings in many:
        merged.update(bindings)
    return tuple(sorted(merged.items()))


def only(bindings: Bindings, names: frozenset[str]) -> Bindings:
    return tuple(b for b in bindings if b[0] in names)


@lru_cache(maxsize=4096)
def variables(process: Process) -> frozenset[str]:
    """The names of all variables that occur in a process."""
    found: set[str] = set()
    waiting: list[Expression] = [a for call in calls(process) for a in call.arguments]
    while waiting:
        match waiting.pop():
            case Variable(name):
                found.add(name)
            case Negative(operand):
                waiting.append(operand)
            case Operation(_, left, right):
                waiting += [left, right]
            case Apply(_, arguments):
                waiting += arguments
    return frozenset(found)


def leaf_of(call: Call, arguments: tuple[Value, ...] = (), *, problem: str = "") -> Leaf:
    """The leaf that a call of a basic or built-in process becomes."""
    return Leaf(call.name, arguments, call.results, site=call.place, problem=problem)
