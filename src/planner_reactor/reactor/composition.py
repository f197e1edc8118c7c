"""Adaptations made of adaptations: the undoing of one, and several that are applied all or none (R §5.5).

Both are adaptations like any other: checked, drained, journalled and reported as such. The undoing of one whose
situations were changed again meanwhile is refused as stale.
"""

from __future__ import annotations

from collections.abc import Sequence

from msgspec.structs import replace

from planner_reactor.errors import InputError
from planner_reactor.link.messages import Adaptation, Change
from planner_reactor.reactor.committed import Committed
from planner_reactor.rs.parser import parse_program
from planner_reactor.rs.printer import show
from planner_reactor.rs.terms import Number


def undone(adaptation: Adaptation, before: Committed, *, number: int, epoch: int, first_label: int) -> Adaptation:
    """The adaptation that brings back the structure `before` an applied one, under new labels from `first_label` on."""
    labels = {old: first_label + n for n, old in enumerate(reversed(adaptation.kills))}
    changes = []
    for change in adaptation.changes:
        if change.base:
            changes.append(Change(situation=change.situation, base=change.base + 1, assumptions=_rests(before, change)))
    for situation in adaptation.removed:
        back = before.versions.get(situation, 0) + 1
        changes.append(Change(situation=situation, base=back, assumptions=before.rests_on.get(situation, ())))
    return Adaptation(
        id=number,
        epoch=epoch,
        definitions="\n".join(_relabelled(before.clauses[old], new) for old, new in labels.items()),
        changes=tuple(changes),
        removed=tuple(c.situation for c in adaptation.changes if not c.base),
        kills=tuple(reversed(adaptation.adds)),
        adds=tuple(labels.values()),
        mode=adaptation.mode,
        purpose=f"undo of adaptation {adaptation.id}",
        drops=adaptation.adopts,
        adopts=adaptation.drops,
    )


def _rests(before: Committed, change: Change) -> tuple[str, ...]:
    return before.rests_on.get(change.situation, ())


def _relabelled(clause: str, label: int) -> str:
    (schema,) = parse_program(clause).schemas
    return show(replace(schema, head=(Number(label),)))


def together(adaptations: Sequence[Adaptation], *, number: int) -> Adaptation:
    """One adaptation that does what these do, all of it or nothing. `InputError` if they do not fit together.

    They must be of one mode, and no situation may be changed by two of them. Earlier ones are drained first.
    """
    if len({a.mode for a in adaptations}) != 1:
        raise InputError(f"a group of adaptations has one mode, found {sorted({a.mode for a in adaptations})}")
    names = [n for a in adaptations for n in (*(c.situation for c in a.changes), *a.removed)]
    if twice := sorted({n for n in names if names.count(n) > 1}):
        raise InputError(f"{', '.join(twice)} is changed by two adaptations of a group")
    deadlines = [a.deadline for a in adaptations if a.deadline is not None]
    return Adaptation(
        id=number,
        epoch=max(a.epoch for a in adaptations),
        definitions="\n".join(a.definitions for a in adaptations),
        changes=tuple(c for a in adaptations for c in a.changes),
        removed=tuple(s for a in adaptations for s in a.removed),
        kills=tuple(n for a in adaptations for n in a.kills),
        adds=tuple(n for a in reversed(adaptations) for n in a.adds),
        mode=adaptations[0].mode,
        deadline=min(deadlines, default=None),
        purpose="; ".join(a.purpose for a in adaptations if a.purpose),
        drops=tuple(n for a in adaptations for n in a.drops),
        adopts=tuple(n for a in adaptations for n in a.adopts),
    )
