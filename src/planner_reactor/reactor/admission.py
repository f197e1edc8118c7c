"""Is this adaptation one that may be applied? Checked whole before anything changes (docs/reactor.md, law 1).

`examine` gives the reactions to add, or raises `RefusedError` with one of the reasons below: a stable word for the
planner, a sentence for people. Nothing is changed here.

    repeated   its id was seen before (6)             stale      planned against another version (7)
    epoch      an older planner's (7)                 mode       there is none of this name
    text       the definitions do not load            labels     kills or adds are not what they should be
    pending    an earlier change of a situation is under way     structure  the reactor would not hang together
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Container, Iterable, Iterator, Mapping, Sequence

import msgspec

from planner_reactor.errors import RefusedError
from planner_reactor.link.messages import Adaptation
from planner_reactor.reactor.committed import Committed
from planner_reactor.reactor.migrating import refuse_lost_arguments
from planner_reactor.reactor.preparing import Prepared
from planner_reactor.reactor.reactions import Reactions
from planner_reactor.rs.reactions import Reaction, children, cycle
from planner_reactor.rs.terms import Value


class Standing(msgspec.Struct, frozen=True):
    """What an adaptation is held against: the reactor as it stands."""

    reactions: Mapping[int, Reaction]
    versions: Mapping[str, int]
    pending: Collection[str]
    taken: Container[int]
    epoch: int
    used_labels: Collection[int]
    functions: Mapping[str, Callable[..., Value]]


def standing_of(
    committed: Committed,
    reactions: Mapping[int, Reaction],
    pending: Collection[str],
    functions: Mapping[str, Callable[..., Value]],
) -> Standing:
    """What is committed and runs, while these situations are being changed."""
    return Standing(
        reactions=reactions,
        versions=committed.versions,
        pending=pending,
        taken=committed.taken,
        epoch=committed.epoch,
        used_labels=range(committed.highest_label + 1),
        functions=functions,
    )


MODES = ("drain", "wait", "versions")


def is_text(adaptation: Adaptation) -> bool:
    """Can it be written down? A lone surrogate cannot; what came over a link always can."""
    try:
        msgspec.msgpack.encode(adaptation)
    except (UnicodeEncodeError, OverflowError):
        return False
    return True


def examine(prepare: Callable[[], Prepared], adaptation: Adaptation, standing: Standing) -> Prepared:
    """The adaptation with its text read and checked, which is only asked for if nothing else speaks against it."""
    _identity(adaptation, standing)
    _versions(adaptation, standing)
    prepared = prepare()
    if prepared.refusal is not None:
        raise prepared.refusal
    new = _labels(adaptation, standing, prepared.reactions)
    _structure(adaptation, standing, new)
    refuse_lost_arguments(adaptation, Reactions.of(standing.reactions), new, standing.functions)
    return prepared


def _identity(adaptation: Adaptation, standing: Standing) -> None:
    if adaptation.epoch == standing.epoch and adaptation.id in standing.taken:
        raise RefusedError("repeated", f"adaptation {adaptation.id} was taken before")
    if adaptation.epoch < standing.epoch:
        raise RefusedError("epoch", f"epoch {adaptation.epoch}, expected at least {standing.epoch}")
    if adaptation.mode not in MODES:
        raise RefusedError("mode", f"there is no mode {adaptation.mode}, expected {' or '.join(MODES)}")
    if adaptation.deadline is not None and not adaptation.deadline >= 0:
        raise RefusedError("mode", f"a deadline of {adaptation.deadline} s, expected 0 or more")


def _versions(adaptation: Adaptation, standing: Standing) -> None:
    for change in adaptation.changes:
        version = standing.versions.get(change.situation, 0)
        if change.base != version:
            raise RefusedError("stale", f"{change.situation} is at version {version}, planned against {change.base}")
    names = [change.situation for change in adaptation.changes]
    if held := [situation for situation in (*names, *adaptation.removed) if situation in standing.pending]:
        raise RefusedError("pending", f"{held[0]} is being changed by an earlier adaptation")
    if len(set(names)) < len(names):
        raise RefusedError("structure", f"a situation is named twice among {', '.join(names)}")


def _labels(adaptation: Adaptation, standing: Standing, found: Mapping[int, Reaction]) -> tuple[Reaction, ...]:
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
    after = After(Reactions.of(standing.reactions), frozenset(adaptation.kills), new)
    for reaction in (*new, *after.bereft(killed)):
        if orphans := [name for name in reaction.asserts if not after.serving(name)]:
            raise RefusedError("structure", f"P[{reaction.label}] asserts {', '.join(orphans)}, which nothing serves")
    for situation in adaptation.removed:
        if serving := [f"P[{r.label}]" for r in after.serving(situation)]:
            raise RefusedError("structure", f"{situation} is removed, and still served by {', '.join(serving)}")
    named = dict.fromkeys(r.situation for r in (*new, *killed) if r.situation is not None)
    if (way := after.cycle_from(named)) is not None:
        raise RefusedError("structure", f"a situation is asserted from below itself: {' → '.join(way)}")


class After:
    """The reactions as they will stand. What is asked of it costs what is near the change, not what stands elsewhere.
    """

    def __init__(self, standing: Reactions, killed: frozenset[int], new: Sequence[Reaction]) -> None:
        self._standing = standing
        self._killed = killed
        self._new = new

    def serving(self, situation: str) -> tuple[Reaction, ...]:
        staying = [r for r in self._standing.serving(situation) if r.label not in self._killed]
        return (*staying, *[r for r in self._new if r.situation == situation])

    def bereft(self, killed: Iterable[Reaction]) -> Iterator[Reaction]:
        """The reactions that stay, and assert a situation that these served."""
        for situation in dict.fromkeys(r.situation for r in killed if r.situation is not None):
            yield from (r for r in self._standing.asserting(situation) if r.label not in self._killed)

    def cycle_from(self, situations: Iterable[str]) -> tuple[str, ...] | None:
        """A situation at or below these that is asserted from below itself, with the way round, or None.

        What stands has no cycle: a new one leads through a situation whose reactions change.
        """
        below: dict[str, tuple[str, ...]] = {}
        waiting = list(situations)
        while waiting:
            if (name := waiting.pop()) not in below:
                reactions = self.serving(name)
                spawned = any(r.spawns for r in reactions)
                below[name] = () if spawned else children(reactions).get(name, ())
                waiting += below[name]
        return cycle(below)
