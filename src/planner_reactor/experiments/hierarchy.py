"""A reactor as R Figs 8 to 10 show it: each situation broken down into what its reactions do.

A line of a figure says what the line above it consists of, from left to right in the order of time; what goes on at
once stands one below the other. Only what *does* something is shown: the processes that keep the books of instances
(SUCCEED, FAIL, UPDATE, SUSPEND) and what follows a failure are left out. Nothing is drawn here.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Literal, TypeAlias

import msgspec
from msgspec.structs import replace

from planner_reactor.experiments.snapshots import Snapshot, deed
from planner_reactor.rs.reactions import Reaction
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
    Symbol,
    Text,
)

Sign = Literal["&", "|", "#", "if", "then"]
BOOKKEEPING = frozenset({"SUCCEED", "FAIL", "UPDATE", "SUSPEND", "STOP", "ABORT", "NIL", "SIT"})


class Act(msgspec.Struct, frozen=True):
    """A basic process, or a stub. `tags`: assumptions."""

    label: str
    stub: bool = False
    tags: tuple[str, ...] = ()


class Part(msgspec.Struct, frozen=True):
    """A situation and what it consists of; None where it stands in full elsewhere."""

    label: str
    inside: Node | None
    tags: tuple[str, ...] = ()


class InOrder(msgspec.Struct, frozen=True):
    """One after the other."""

    parts: tuple[Node, ...]


class AtOnce(msgspec.Struct, frozen=True):
    """Side by side, by which operator; for "if" the two branches, for "then" lines to be read one after the other."""

    sign: Sign
    lanes: tuple[Node, ...]


Node: TypeAlias = Act | Part | InOrder | AtOnce
Tagging = Literal["rests_on", "because"]


def hierarchy(snapshot: Snapshot, *, tags: Tagging = "rests_on") -> tuple[Node, ...]:
    """What the reactor does, from the situations that nothing is above.

    `tags` on a situation or process: the assumptions that it rests on, or the one for whose relaxation it came in.
    """
    return _Breakdown(snapshot, tags).roots()


class _Breakdown:
    def __init__(self, snapshot: Snapshot, tags: Tagging) -> None:
        self._snapshot = snapshot
        self._tags = tags
        self._shown: set[str] = set()
        self._serving: dict[str, list[Reaction]] = {}
        for label in sorted(snapshot.reactions):
            reaction = snapshot.reactions[label]
            if reaction.situation is not None:
                self._serving.setdefault(reaction.situation, []).append(reaction)

    def roots(self) -> tuple[Node, ...]:
        found: list[Node] = []
        for label in sorted(self._snapshot.reactions):
            reaction = self._snapshot.reactions[label]
            if reaction.situation is None and not reaction.monitors:
                node = self._node(reaction.schema.body, {})
                found += [] if node is None else [node]
        asserted = {name for r in self._snapshot.reactions.values() for name in r.asserts}
        found += [self._situation(name) for name in self._serving if name not in asserted]
        return tuple(found)

    def _situation(self, name: str, tags: tuple[str, ...] = ()) -> Node:
        """A situation; `tags`: why it is asserted here, if that is known."""
        because = self._snapshot.because.get(name, {})
        if self._tags == "rests_on":
            tags = self._snapshot.rests_on.get(name, ())
        elif not tags and because.get("", ""):
            tags = (because[""],)
        if name in self._shown:
            return Part(name, None, tags if self._tags == "because" else ())
        self._shown.add(name)
        reactions = self._serving.get(name, [])
        inside = [n for r in reactions if (n := self._node(_served(r.schema.body), because)) is not None]
        if len(inside) > 1:
            return Part(name, AtOnce("|", tuple(inside)), tags)
        return Part(name, inside[0] if inside else None, tags)

    def _node(self, process: Process, because: Mapping[str, str]) -> Node | None:
        match process:
            case Call():
                return self._call(process, because)
            case Cond((Not(body), *_)):  # ~(body : SUCCEED) : FAIL
                return self._node(body, because)
            case Not(body):
                return self._node(body, because)
            case Seq(parts) | Cond(parts):
                return _in_order(self._nodes(parts, because))
            case Par(parts):
                return _at_once("|", self._nodes(parts, because))
            case All(parts):
                return _at_once("&", self._nodes(parts, because))
            case Disable(parts):
                return _at_once("#", self._nodes(parts, because))
            case If(test, then, otherwise):
                branches = _at_once("if", self._nodes((then, otherwise), because))
                return _in_order([*self._nodes((test,), because), *([] if branches is None else [branches])])
            case Loop(condition, body) | Spawn(condition, body):
                return _in_order(self._nodes((condition, body), because))

    def _nodes(self, parts: tuple[Process, ...], because: Mapping[str, str]) -> list[Node]:
        return [node for part in parts if (node := self._node(part, because)) is not None]

    def _call(self, call: Call, because: Mapping[str, str]) -> Node | None:
        tag = because.get(deed(call), "") if self._tags == "because" else ""
        tags = (tag,) if tag else ()
        match call.name, call.arguments:
            case ("ASSERT" | "REASSERT", (Symbol(name) | Text(name), *_)):
                return self._situation(name, tags)
            case ("STUB", _):
                return Act("STUB", stub=True)
            case (name, _) if name in BOOKKEEPING:
                return None
            case _:
                return Act(deed(call), tags=tags)


def folded(node: Node, width: Callable[[Node], float], limit: float, *, most_lanes: int = 8) -> Node:
    """The same for a page: what is wider than `limit` is broken into lines, and of very many lanes some are shown."""
    match node:
        case Act() | Part(inside=None):
            return node
        case Part(inside=inside):
            assert inside is not None
            return replace(node, inside=folded(inside, width, limit, most_lanes=most_lanes))
        case AtOnce(sign, lanes):
            shown = [folded(lane, width, limit, most_lanes=most_lanes) for lane in lanes[:most_lanes]]
            if len(lanes) > most_lanes:
                shown = [*shown[: most_lanes // 2], Part(f"… and {len(lanes) - most_lanes // 2} more of these", None)]
            return AtOnce(sign, tuple(shown))
        case InOrder(parts):
            return _lines([folded(part, width, limit, most_lanes=most_lanes) for part in parts], width, limit)


def _lines(parts: list[Node], width: Callable[[Node], float], limit: float) -> Node:
    """The parts in as few lines as they fit in."""
    lines: list[list[Node]] = [[]]
    for part in parts:
        if lines[-1] and width(InOrder((*lines[-1], part))) > limit:
            lines.append([])
        lines[-1].append(part)
    nodes: list[Node] = [line[0] if len(line) == 1 else InOrder(tuple(line)) for line in lines]
    return nodes[0] if len(nodes) == 1 else AtOnce("then", tuple(nodes))


def _served(body: Process) -> Process:
    """What is done for an instance: the body of the loop around SIT."""
    match body:
        case Loop(Call("SIT"), inner) | Spawn(Call("SIT"), inner):
            return inner
        case _:
            return body


def _in_order(parts: list[Node]) -> Node | None:
    flat = [inner for part in parts for inner in (part.parts if isinstance(part, InOrder) else (part,))]
    if len(flat) < 2:
        return flat[0] if flat else None
    return InOrder(tuple(flat))


def _at_once(sign: Sign, lanes: list[Node]) -> Node | None:
    if len(lanes) < 2:
        return lanes[0] if lanes else None
    return AtOnce(sign, tuple(lanes))
