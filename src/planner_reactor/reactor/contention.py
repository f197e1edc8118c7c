"""Is an adaptation in the way of one that is under way? Each was examined against what stands; both must fit together.

What is under way may be applied or come to nothing: with it and without it the reactor must hang together. Without it
is what `admission` asks; here it is asked with all of it applied. What does not fit is refused (reason pending): once
what is under way has been decided, it can be asked for again.

    killed     an earlier adaptation kills the same reaction: the second would find nothing to kill after its COMMIT
    bereft     one asserts what the other leaves without a reaction: who asserts it would wait for ever
    circular   each asserts what the other serves, so that a situation is asserted from below itself
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence

from planner_reactor.errors import RefusedError
from planner_reactor.reactor.admission import After
from planner_reactor.reactor.reactions import Reactions
from planner_reactor.rs.reactions import Reaction, cycle


def refuse_contention(
    new: Sequence[Reaction],
    killed: Sequence[Reaction],
    present: Reactions,
    coming: Sequence[Reaction],
    going: Collection[int],
) -> None:
    """`RefusedError` if an adaptation (`new`, `killed`) does not fit what is under way (`coming`, `going` by label)."""
    if twice := [reaction.label for reaction in killed if reaction.label in going]:
        raise RefusedError("pending", f"P[{twice[0]}] is being killed by an earlier adaptation")
    gone = frozenset([*going, *[reaction.label for reaction in killed]])
    after = After(present, gone, (*new, *coming))
    for reaction in (*new, *coming):
        if orphans := [name for name in reaction.asserts if not after.serving(name)]:
            way = "removes, together with an earlier one" if reaction in coming else "an earlier adaptation removes"
            raise RefusedError("pending", f"P[{reaction.label}] asserts {orphans[0]}, which {way}")
    if (ring := _ring(new, present, coming)) is not None:
        raise RefusedError("pending", f"with an earlier adaptation {' → '.join(ring)} would be asserted from below")


def _ring(new: Sequence[Reaction], present: Reactions, coming: Sequence[Reaction]) -> tuple[str, ...] | None:
    """A situation that would be asserted from below itself, whichever of the reactions that go are still there."""

    def below(name: str) -> tuple[str, ...]:
        serving: Iterable[Reaction] = (*present.serving(name), *[r for r in (*new, *coming) if r.situation == name])
        return tuple([child for reaction in serving if not reaction.spawns for child in reaction.asserts])

    if not any(r.asserts for r in coming):
        return None
    found: dict[str, tuple[str, ...]] = {}
    waiting = [r.situation for r in new if r.situation is not None and r.asserts]
    while waiting:
        if (name := waiting.pop()) not in found:
            found[name] = below(name)
            waiting += found[name]
    return cycle(found)
