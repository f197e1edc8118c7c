"""Could this adaptation wait for itself? Asked of the situations' graph before anything begins (docs/reactor.md).

A script waits until what is on of a situation has ended, and that may need other situations served. So it must hold
none that its own progress, or that of another adaptation under way, needs; what it would wait for for ever is refused:

    order      a child is held before its parent, or (mode versions) removed before it
    cycle      it needs what another holds that needs what it holds, one after the other (mode wait)
    disabled   something below what it holds is disabled: who asked for it is not served, and does not end (mode wait)
    retired    an older parent, retired and not gone yet, may still assert what it removes (drain and wait)

A drain needs nothing below: who is withdrawn asks for nothing more.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable

from planner_reactor.errors import RefusedError
from planner_reactor.link.messages import Adaptation
from planner_reactor.link.surgeries import drained
from planner_reactor.reactor.reactions import Reactions
from planner_reactor.rs.reactions import Onward, Reaction, cycle, reach, upside_down


def refuse_waiting_for_itself(
    adaptation: Adaptation,
    present: Reactions,
    under_way: Iterable[Adaptation],
    retired: Iterable[Reaction],
    disabled: Callable[[str], object],
) -> None:
    """`RefusedError` (reason deadlock) if it could; `disabled` tells whether a situation is, by a failed assumption."""

    def below(situation: str) -> Iterable[str]:
        return (child for reaction in present.serving(situation) for child in reaction.asserts)

    _order(adaptation, present, below)
    if adaptation.mode != "versions":
        _retired(adaptation, retired)
    if adaptation.mode == "wait":
        _cycle(adaptation, below, under_way)
        _disabled(adaptation, below, disabled)


def _order(adaptation: Adaptation, present: Reactions, below: Onward) -> None:
    if (wrong := upside_down(drained(adaptation), below)) is not None:
        child, parent = wrong
        raise RefusedError("deadlock", f"{child} is held before {parent}, which needs it: expected {parent} first")
    if adaptation.mode == "versions":
        removed = [situation for n in adaptation.kills if (situation := present[n].situation) is not None]
        if (wrong := upside_down(removed, below)) is not None:
            child, parent = wrong
            raise RefusedError(
                "deadlock", f"what serves {child} goes before what serves {parent}: expected {parent} first"
            )


def _retired(adaptation: Adaptation, retired: Iterable[Reaction]) -> None:
    for reaction in retired:
        if asserted := [s for s in reaction.asserts if s in adaptation.removed]:
            raise RefusedError(
                "deadlock", f"P[{reaction.label}], retired and not gone yet, may assert {asserted[0]}: expected later"
            )


def _cycle(adaptation: Adaptation, below: Onward, under_way: Iterable[Adaptation]) -> None:
    """Who waits needs everything below what it waits for; who drains needs nothing."""
    holds = {a.id: set(drained(a)) for a in (adaptation, *under_way)}
    waiting = {a.id: reach(drained(a), below) for a in (adaptation, *under_way) if a.mode == "wait"}
    needs = {
        str(one): tuple(str(other) for other, held in holds.items() if other != one and needed & held)
        for one, needed in waiting.items()
    }
    if (way := cycle(needs)) is not None:
        raise RefusedError("deadlock", f"adaptations would wait for each other: {' → '.join(way)}")


def _disabled(adaptation: Adaptation, below: Onward, disabled: Callable[[str], object]) -> None:
    held = drained(adaptation)
    if found := sorted(s for s in reach(held, below) if disabled(s)):
        raise RefusedError(
            "deadlock", f"{found[0]} is disabled, and {held[0]} cannot end without it: expected mode drain"
        )
