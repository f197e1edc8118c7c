"""Is this adaptation one that may be applied? Checked whole before anything changes (docs/reactor.md, law 1).

`examine` gives the reactions to add, or raises `RefusedError` with one of the reasons below: a stable word for the
planner, a sentence for people. Nothing is changed here.

    repeated   its id was seen before (6)             stale      planned against another version (7)
    epoch      an older planner's (7)                 mode       not in this version
    text       the definitions do not load            labels     kills or adds are not what they should be
    pending    an earlier change of a situation is under way     structure  the reactor would not hang together
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Container, Mapping, Sequence

import msgspec

from planner_reactor.errors import RefusedError, RSError
from planner_reactor.link.messages import Adaptation
from planner_reactor.rs.loading import load
from planner_reactor.rs.reactions import Reaction, children, cycle, reaction_of
from planner_reactor.rs.terms import Program, Schema, Value
from planner_reactor.rs.vocabulary import Signature


class Standing(msgspec.Struct, frozen=True):
    """What an adaptation is held against: the reactor as it stands."""

    reactions: Mapping[int, Reaction]
    versions: Mapping[str, int]
    pending: Collection[str]
    taken: Container[int]
    epoch: int
    used_labels: Collection[int]
    signatures: Mapping[str, Signature]
    functions: Mapping[str, Callable[..., Value]]
    equation: Program  # equation (3), so that what is added is checked as guarded reactions


MODES = ("drain", "wait", "versions")


def examine(adaptation: Adaptation, standing: Standing) -> tuple[Reaction, ...]:
    """The reactions that the adaptation adds, in its order of adds (bottom-up)."""
    _identity(adaptation, standing)
    _versions(adaptation, standing)
    schemas = _definitions(adaptation, standing)
    new = _labels(adaptation, standing, schemas)
    _structure(adaptation, standing, new)
    return new


def _identity(adaptation: Adaptation, standing: Standing) -> None:
    if adaptation.id in standing.taken:
        raise RefusedError("repeated", f"adaptation {adaptation.id} was taken before")
    if adaptation.epoch < standing.epoch:
        raise RefusedError("epoch", f"epoch {adaptation.epoch}, expected at least {standing.epoch}")
    if adaptation.mode not in MODES:
        raise RefusedError("mode", f"mode {adaptation.mode} is not in this version, expected {' or '.join(MODES)}")


def _versions(adaptation: Adaptation, standing: Standing) -> None:
    for change in adaptation.changes:
        version = standing.versions.get(change.situation, 0)
        if change.base != version:
            raise RefusedError("stale", f"{change.situation} is at version {version}, planned against {change.base}")
        if change.situation in standing.pending:
            raise RefusedError("pending", f"{change.situation} is being changed by an earlier adaptation")
    names = [change.situation for change in adaptation.changes]
    if len(set(names)) < len(names):
        raise RefusedError("structure", f"a situation is named twice among {', '.join(names)}")


def _definitions(adaptation: Adaptation, standing: Standing) -> tuple[Schema, ...]:
    try:
        program = load(
            adaptation.definitions,
            file=f"<adaptation {adaptation.id}>",
            signatures=standing.signatures,
            functions=standing.functions,
            given=standing.equation,
        )
    except RSError as problem:
        raise RefusedError("text", str(problem)) from None
    return program.schemas


def _labels(adaptation: Adaptation, standing: Standing, schemas: Sequence[Schema]) -> tuple[Reaction, ...]:
    found = {}
    for schema in schemas:
        reaction = reaction_of(schema)
        if reaction is None:
            raise RefusedError("labels", f"{schema.name} is no reaction, expected clauses P[n] = …")
        found[reaction.label] = reaction
    if sorted(found) != sorted(adaptation.adds):
        raise RefusedError("labels", f"defines {sorted(found)}, adds {sorted(adaptation.adds)}")
    if reused := [label for label in adaptation.adds if label in standing.used_labels]:
        raise RefusedError("labels", f"labels {reused} were used before")
    if absent := [label for label in adaptation.kills if label not in standing.reactions]:
        raise RefusedError("labels", f"no reactions {absent} to kill")
    if len(set(adaptation.kills)) < len(adaptation.kills):
        raise RefusedError("labels", f"a label is killed twice in {list(adaptation.kills)}")
    return tuple(found[label] for label in adaptation.adds)


def _structure(adaptation: Adaptation, standing: Standing, new: tuple[Reaction, ...]) -> None:
    changed = {change.situation for change in adaptation.changes} | set(adaptation.removed)
    killed = [standing.reactions[label] for label in adaptation.kills]
    for reaction in (*killed, *new):
        if reaction.situation is not None and reaction.situation not in changed:
            raise RefusedError(
                "structure", f"P[{reaction.label}] serves {reaction.situation}, which is not among the changes"
            )
    after = [r for label, r in standing.reactions.items() if label not in adaptation.kills] + list(new)
    served = {r.situation for r in after}
    for reaction in after:
        if orphans := [name for name in reaction.asserts if name not in served]:
            raise RefusedError("structure", f"P[{reaction.label}] asserts {', '.join(orphans)}, which nothing serves")
    below = children(after)
    spawned = {r.situation for r in after if r.spawns}
    if (way := cycle({s: c for s, c in below.items() if s not in spawned})) is not None:
        raise RefusedError("structure", f"a situation is asserted from below itself: {' → '.join(way)}")
