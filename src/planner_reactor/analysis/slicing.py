"""The part of a reactor that an adaptation can touch, small enough to look at every way in which it can go on.

Kept are the situations that the adaptation names, and those between them in the hierarchy. The rest is replaced by
something that can do at least as much:

    above       whoever asserts a kept situation from outside: `Asks :; ASSERT[s]`, at any time; two of them where
                several may ask at once
    below       a situation that is not kept, and every basic process: `Works`, which ends at any time, either way
    arguments   and results are dropped; nothing in the protocol depends on them

Parts that do nothing but `Works` one after the other, or side by side, are one. Names are replaced by numbers, so that
adaptations of one shape have one slice, verified once (`Slice` is its own key).

    monitors    come and go without a look: a monitor serves nothing and is always at rest

Sound for what waits and what is cut, because every step of the reactor has a counterpart here; that bodies end at all
is the bound's affair (`rs.bounds`), which is worked out on the reactor itself.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence

import msgspec
from msgspec.structs import replace

from planner_reactor.rs.reactions import REACTION, Reaction, Surgery, children, reach, reaction_of
from planner_reactor.rs.terms import (
    ABORT,
    STOP,
    All,
    Call,
    Cond,
    Disable,
    If,
    Loop,
    Not,
    Number,
    Par,
    Process,
    Schema,
    Seq,
    Spawn,
    Symbol,
    Text,
    Variable,
    cond,
    operands,
    seq,
)

WORKS = Call("Works")
ASKS = Call("Asks")
ENDS = frozenset({WORKS, STOP, ABORT})
"""After `Works`, a choice among these is `Works`: it ends at any time, either way."""
AT_ONCE = 2
"""Askers from outside that are told apart: a third adds nothing that two cannot show."""


class Slice(msgspec.Struct, frozen=True):
    """A reactor's part and its surgery, up to names: situations are `s0`, `s1`, …, labels 0, 1, …."""

    schemas: tuple[Schema, ...]
    present: tuple[int, ...]
    asked: tuple[str, ...]  # from outside, once for each asker
    surgery: Surgery

    @property
    def killed(self) -> tuple[Reaction, ...]:
        """The reactions that go."""
        found = {r.label: r for r in map(reaction_of, self.schemas) if r is not None}
        return tuple(found[n] for n in self.surgery.kills if n in found)

    @property
    def reactor(self) -> Process:
        """Equation (3) with the reactions present, and those who ask."""
        guarded: list[Process] = [_guarded(Number(n)) for n in self.present]
        asking: list[Process] = [Loop(ASKS, Call("ASSERT", (Symbol(s),))) for s in self.asked]
        adding = Spawn(Call("ADD", (), ("m",)), _guarded(Variable("m")))
        return Par((*guarded, *asking, adding)) if guarded or asking else adding


def _guarded(label: Number | Variable) -> Process:
    return Disable((Call("E", (label,)), Call(REACTION, (label,))))


class Sliced(msgspec.Struct, frozen=True):
    """A slice, and what its names stand for."""

    slice: Slice
    situations: Mapping[str, str]
    labels: Mapping[int, int]


def sliced(reactions: Sequence[Reaction], new: Sequence[Reaction], surgery: Surgery) -> Sliced:
    """The slice of an adaptation that adds `new` to a reactor of these `reactions`."""
    idle = {r.label for r in (*reactions, *new) if is_monitor(r)}
    before, coming = [r for r in reactions if r.label not in idle], [r for r in new if r.label not in idle]
    surgery = replace(
        surgery,
        kills=tuple(n for n in surgery.kills if n not in idle),
        adds=tuple(n for n in surgery.adds if n not in idle),
    )
    kept = _kept([*before, *coming], surgery)
    inside = [r for r in before if r.situation in kept or r.label in surgery.kills]
    labels = {r.label: n for n, r in enumerate([*inside, *coming])}
    names = {name: f"s{n}" for n, name in enumerate(_order(kept, inside, coming))}
    outside = [r for r in before if r not in inside and r.label not in surgery.kills]
    asked = [s for s in names for _ in range(min(AT_ONCE, _askers(s, outside)))]
    made = Slice(
        tuple(_schema(r, names, labels) for r in [*inside, *coming]),
        tuple(labels[r.label] for r in inside),
        tuple(names[s] for s in asked),
        _renamed(surgery, names, labels),
    )
    return Sliced(made, {new: old for old, new in names.items()}, {new: old for old, new in labels.items()})


def apart(reactions: Sequence[Reaction], new: Sequence[Reaction], surgery: Surgery) -> list[Surgery]:
    """The surgery as one for each situation: a drain that has ended stays so, whatever follows.

    A root that goes, goes with what it asserts.
    """
    serves = {r.label: r.situation for r in (*reactions, *new)}
    roots = {r.label: r.asserts for r in reactions if r.situation is None}
    return [
        Surgery(
            held=(situation,),
            kills=tuple(n for n in surgery.kills if serves.get(n) == situation or situation in roots.get(n, ())),
            adds=tuple(n for n in surgery.adds if serves.get(n) == situation),
            named=(situation,),
            removed=(situation,) if situation in surgery.removed else (),
        )
        for situation in surgery.held
    ]


def still_asking(reactions: Sequence[Reaction], single: Surgery, whole: Surgery) -> list[Reaction]:
    """Without those that go, too, once what they serve has come to its end: that is drained before what they assert."""
    if not single.removed:
        return list(reactions)
    gone = {r.label for r in reactions if r.label in whole.kills and r.situation in whole.held}
    return [r for r in reactions if r.label not in gone or r.situation in single.held]


def is_monitor(reaction: Reaction) -> bool:
    """Is it nothing but a monitor, which is always at rest?"""
    return isinstance(reaction.schema.body, Call) and bool(reaction.monitors)


def _kept(reactions: Sequence[Reaction], surgery: Surgery) -> frozenset[str]:
    """What is touched, and what lies between: asserted from below something touched and above something touched."""
    moved = {*surgery.kills, *surgery.adds}
    touched = {*surgery.held, *surgery.named} | {r.situation for r in reactions if r.label in moved and r.situation}
    below = children(reactions)
    above: dict[str, list[str]] = {}
    for parent, names in below.items():
        for name in names:
            above.setdefault(name, []).append(parent)
    down, up = reach(touched, lambda s: below.get(s, ())), reach(touched, lambda s: above.get(s, ()))
    return frozenset(touched | (down & up))


def _order(kept: frozenset[str], *many: Iterable[Reaction]) -> list[str]:
    """The kept situations in the order of the reactions that serve or assert them, then the others."""
    named = [s for group in many for r in group for s in (r.situation, *r.asserts) if s in kept]
    return list(dict.fromkeys([*filter(None, named), *sorted(kept)]))


def _askers(situation: str, outside: Iterable[Reaction]) -> int:
    """How many may ask for it at once; those that are served side by side count for many."""
    return sum(AT_ONCE if r.spawns else 1 for r in outside if situation in r.asserts)


def _renamed(surgery: Surgery, names: Mapping[str, str], labels: Mapping[int, int]) -> Surgery:
    return Surgery(
        held=tuple(names[s] for s in surgery.held),
        kills=tuple(labels.get(n, -1) for n in surgery.kills),
        adds=tuple(labels.get(n, -1) for n in surgery.adds),
        named=tuple(sorted(names[s] for s in surgery.named)),
        removed=tuple(names[s] for s in surgery.removed),
    )


# --------------------------------------------------------------------------------------------- what is left of a text


def _schema(reaction: Reaction, names: Mapping[str, str], labels: Mapping[int, int]) -> Schema:
    return Schema(REACTION, (Number(labels[reaction.label]),), (), _left(reaction.schema.body, names))


def _left(process: Process, names: Mapping[str, str]) -> Process:
    """The same with all that the protocol does not see as `Works`."""
    match process:
        case Call():
            return _call(process, names)
        case Cond(parts):
            return _chain(Cond, [_left(part, names) for part in parts])
        case Seq(parts):
            return _chain(Seq, [_left(part, names) for part in parts])
        case Par(parts) | All(parts) | Disable(parts):
            return _beside(type(process), [_left(part, names) for part in parts])
        case Not(body):
            inner = _left(body, names)
            return WORKS if inner == WORKS else Not(inner)
        case If(test, then, otherwise):
            three = tuple(_left(part, names) for part in (test, then, otherwise))
            return WORKS if three[0] == WORKS and ENDS.issuperset(three[1:]) else If(*three)
        case Loop(condition, body):
            return Loop(_left(condition, names), _left(body, names))
        case Spawn(condition, body):
            return Spawn(_left(condition, names), _left(body, names))


def _call(call: Call, names: Mapping[str, str]) -> Process:
    match call.name, call.arguments:
        case (("ASSERT" | "REASSERT"), (Symbol(name) | Text(name), *_)) if name in names:
            return Call(call.name, (Symbol(names[name]),))
        case "SIT", (Symbol(name) | Text(name), *_):
            return Call("SIT", (Symbol(names[name]),), ("k",))
        case (("SUCCEED" | "FAIL"), (Symbol(name) | Text(name), _)) if name in names:
            return Call(call.name, (Symbol(names[name]), Variable("k")))
        case (("STOP" | "ABORT" | "NIL"), _):
            return call
        case (("ASSUMONITOR" | "HOLDMONITOR"), _):
            return Call(call.name, (Symbol("a"), Number(1)))
        case _:
            return WORKS


def _chain(kind: type[Cond] | type[Seq], parts: list[Process]) -> Process:
    """`Works` after `Works` is one."""
    left: list[Process] = []
    for part in parts:
        if part == WORKS and left and left[-1] == WORKS:
            continue
        if left and left[-1] == STOP:
            left.pop()
        if left and left[-1] == WORKS and isinstance(part, Seq) and part.parts[0] == WORKS:
            part = seq(*part.parts[1:])
        left.append(part)
    return cond(*left) if kind is Cond else seq(*left)


def _beside(kind: type[Par] | type[All] | type[Disable], parts: list[Process]) -> Process:
    left = [part for n, part in enumerate(parts) if part != WORKS or WORKS not in parts[:n]]
    return left[0] if len(left) == 1 else kind(tuple(left))


def unknown_names(process: Process) -> Iterator[str]:
    """Situations that a process asserts by names that are worked out at run time: no slice can tell which they are."""
    waiting = [process]
    while waiting:
        term = waiting.pop()
        waiting += operands(term)
        if isinstance(term, Call) and term.name in ("ASSERT", "REASSERT"):
            yield from (str(a) for a in term.arguments[:1] if not isinstance(a, Symbol | Text))
