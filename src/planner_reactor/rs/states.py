"""Run-time terms: what a process has become while it runs (docs/language.md, "Run-time terms and store").

`evolves` rewrites these terms. Legend, with the notation of the rules on the left:

    ok.r, ab.r      Ended       terminated, with bindings r
    a leaf          Leaf        a basic or built-in process that has come to life, with its age
    await_{s,k}<x>  Await       an ASSERT (or REASSERT) that waits for its instance
    –               Queued      an ASSERT held back while its situation is drained or disabled
    –               Waiting     a WAIT, WAITINHIBIT, DRAIN or WAITOLD that has begun
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

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from functools import lru_cache
from typing import Any, ClassVar, Generic, Literal, TypeAlias, TypeVar

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


T = TypeVar("T")


class _Once(Generic[T]):
    """A property that is worked out when first asked for (`functools.cached_property` takes a lock each time)."""

    def __init__(self, work_out: Callable[[Any], T]) -> None:
        self._work_out = work_out
        self._name = work_out.__name__

    def __get__(self, term: Any, kind: type | None = None) -> T:
        value = term.__dict__[self._name] = self._work_out(term)
        return value


class InstanceNumber(int):
    """The number k of a situation instance: an integer that an explorer may rename consistently."""


class Reaction(msgspec.Struct, frozen=True, cache_hash=True):
    """The identity g of a reaction: the label of its guard, if any, and where its SIT stands in the text."""

    guard: Value | None
    site: Place | None


@dataclass(frozen=True, slots=True)
class Ended:
    """`ok.r` or `ab.r`. The cause is for traces and perceptions; the algebra sees only the outcome."""

    waits: ClassVar[None] = None

    ok: bool
    bindings: Bindings = ()
    cause: str = field(default="", compare=False)


class Delivered(msgspec.Struct, frozen=True):
    """A SIT that has just delivered an instance: what follows it, if anything, is the instance's body."""

    waits: ClassVar[None] = None

    situation: str
    instance: InstanceNumber
    reaction: Reaction
    bindings: Bindings


class Leaf(msgspec.Struct, frozen=True, cache_hash=True):
    """A basic or built-in process that has come to life.

    `age` in seconds; `opens` marks a SIT whose instance is served by what follows it; `problem` says why its
    arguments have no value.
    """

    waits: ClassVar[tuple[Wait, ...]] = ()

    name: str
    arguments: tuple[Value, ...] = ()
    results: tuple[str, ...] = ()
    age: float = 0.0
    site: Place | None = None
    opens: bool = False
    problem: str = ""


class _Wait(msgspec.Struct, frozen=True):
    """What the store ends."""

    @property
    def waits(self) -> tuple[Wait, ...]:
        return (self,)  # type: ignore[return-value]  # every one that stands below is a Wait


class Await(_Wait, frozen=True):
    """`await_{s,k}<x>`; `again` holds the leaf of a REASSERT, to be repeated should the instance fail."""

    instance: InstanceNumber
    results: tuple[str, ...]
    again: Leaf | None = None


class Queued(_Wait, frozen=True):
    """An ASSERT held back: `ticket` finds it in the store's queue."""

    ticket: InstanceNumber
    leaf: Leaf


class Waiting(_Wait, frozen=True):
    """A WAIT, WAITINHIBIT, DRAIN or WAITOLD (for the versions before `version`) that has begun."""

    name: str
    situation: str
    version: int = 0


class _Composed(msgspec.Struct, frozen=True, dict=True, cache_hash=True):
    """A term with live parts."""

    @_Once
    def waits(self) -> tuple[Wait, ...] | None:
        """What the store may end in it; None if something ends in it whatever the store."""
        return _waits(parts_of(self))  # type: ignore[arg-type]  # each that stands below is a Run


class Chain(_Composed, frozen=True):
    operator: Literal[";", ":"]
    current: Run
    rest: Process
    scope: Bindings


class Keep(_Composed, frozen=True):
    bindings: Bindings
    body: Run

    @_Once
    def waits(self) -> tuple[Wait, ...] | None:
        return self.body.waits if self.bindings and not isinstance(self.body, Keep) else None


class Export(_Composed, frozen=True):
    """Only the `renamed` results (inner name, outer name) leave the body; none, for the body of a loop."""

    renamed: tuple[tuple[str, str], ...]
    body: Run

    @_Once
    def waits(self) -> tuple[Wait, ...] | None:
        return self.body.waits if self.renamed or not isinstance(self.body, Export | Keep) else None


class Group(_Composed, frozen=True):
    operator: Literal["|", "&", "#"]
    parts: tuple[Run, ...]

    @_Once
    def waits(self) -> tuple[Wait, ...] | None:
        live = [part for part in self.parts if not isinstance(part, Ended)]
        enough = len(self.parts) if self.operator == "#" else 1  # with fewer live parts it is decided, or over
        return _waits(live) if len(live) >= enough else None


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

    @_Once
    def waits(self) -> tuple[Wait, ...] | None:
        over = bool(self.bodies) and isinstance(self.condition, Ended) and not self.condition.ok
        return _waits(self.bodies if over else (self.condition, *self.bodies))


class Serve(_Composed, frozen=True):
    situation: str
    instance: InstanceNumber
    reaction: Reaction
    body: Run


Run: TypeAlias = (
    Ended | Delivered | Leaf | Await | Queued | Waiting | Chain | Keep | Export | Group | Inverted | Deciding
    | Testing | Round | Spawning | Serve
)  # fmt: skip

Wait: TypeAlias = Await | Queued | Waiting

Path: TypeAlias = tuple[int, ...]


class Spot(msgspec.Struct, frozen=True):
    """A live leaf of a configuration: where it is, and what encloses it."""

    root: int
    path: Path
    leaf: Run
    guard: Value | None = None
    owner: InstanceNumber | None = None


_LIVE: dict[type, str] = {
    Chain: "current",
    Keep: "body",
    Export: "body",
    Inverted: "body",
    Deciding: "test",
    Testing: "condition",
    Round: "body",
    Serve: "body",
}
"""In which field a term keeps its one live component."""


def parts_of(term: Run) -> tuple[Run, ...]:
    """The live components of a run-time term, left to right."""
    if (field := _LIVE.get(term.__class__)) is not None:
        return (getattr(term, field),)
    if isinstance(term, Group):
        return term.parts
    return (term.condition, *term.bodies) if isinstance(term, Spawning) else ()


def _waits(parts: Iterable[Run]) -> tuple[Wait, ...] | None:
    found: tuple[Wait, ...] = ()
    for part in parts:
        if (waits := part.waits) is None:
            return None
        found += waits
    return found


def with_parts(term: Run, parts: tuple[Run, ...]) -> Run:
    """The same term with other live components."""
    if (field := _LIVE.get(term.__class__)) is not None:
        changed: Run = replace(term, **{field: parts[0]})  # type: ignore[type-var]
        return changed
    if isinstance(term, Group):
        return Group(term.operator, parts)
    return replace(term, condition=parts[0], bodies=parts[1:]) if isinstance(term, Spawning) else term


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
) -> list[Spot]:
    """Every live leaf, left to right, with the guard and the instance that enclose it."""
    found: list[Spot] = []
    waiting = [(term, path, guard, owner)]
    while waiting:
        term, path, guard, owner = waiting.pop()
        below = 0
        while (field := _LIVE.get(term.__class__)) is not None:
            owner = term.instance if term.__class__ is Serve else owner
            term = getattr(term, field)
            below += 1
        if below:
            path += (0,) * below
        if isinstance(term, Leaf | Await | Queued | Waiting):
            found.append(Spot(root, path, term, guard, owner))
        elif parts := parts_of(term):
            label = guard_of(term)
            guard = guard if label is None else label
            waiting += [(parts[i], (*path, i), guard, owner) for i in range(len(parts) - 1, -1, -1)]
    return found


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


def results_of(leaf: Leaf, values: tuple[Value, ...]) -> Bindings:
    """What a leaf binds that ends with these values."""
    return bind(tuple(zip(leaf.results, values, strict=False)))
