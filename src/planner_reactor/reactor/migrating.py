"""Do the reactions of a changed situation take other parameters, and what becomes of those who assert it?

Asked of an adaptation before anything begins. A drain holds ASSERTs back; those of a root that is replaced as well
would go with it, and those that stay would bring the old arguments. `Change.migrate` says what becomes of them. In mode
versions nothing is held back: an old parent may still assert, so parameters stay as they are; nor in mode wait.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterable, Mapping

from planner_reactor.errors import RefusedError, nearest
from planner_reactor.link.messages import Adaptation, Change
from planner_reactor.reactor.reactions import Reactions
from planner_reactor.rs.reactions import Reaction
from planner_reactor.rs.terms import Call, Symbol, Text, Value, calls, operands


def refuse_lost_arguments(
    adaptation: Adaptation,
    present: Reactions,
    new: tuple[Reaction, ...],
    functions: Mapping[str, Callable[..., Value]],
) -> None:
    """`RefusedError` (reason migrate) if a new reaction would be given arguments that it does not take."""
    before = _taken([present[label] for label in adaptation.kills])
    after = _taken(new)
    for change in adaptation.changes:
        old, now = before.get(change.situation), after.get(change.situation)
        if change.migrate is not None:
            _migrates(change, adaptation.mode, old, now, functions)
        elif old is not None and now is not None and old != now:
            _changes(change.situation, adaptation, old, now)
        if old != now and now is not None:
            staying = [r for r in present.asserting(change.situation) if r.label not in adaptation.kills]
            _asserted(change.situation, now, (*staying, *new))


def _taken(reactions: Iterable[Reaction]) -> dict[str, int]:
    """How many arguments the reactions of each situation take; of some there are none, or they look at none."""
    counts: dict[str, int] = {}
    for reaction in reactions:
        if reaction.situation is not None:
            condition = operands(reaction.schema.body)[0]
            assert isinstance(condition, Call)
            if condition.results:
                counts[reaction.situation] = max(len(condition.results) - 1, counts.get(reaction.situation, 0))
    return counts


def _changes(situation: str, adaptation: Adaptation, old: int, now: int) -> None:
    if adaptation.mode != "drain":
        raise RefusedError(
            "migrate", f"{situation} took {old} arguments, it takes {now}: expected mode drain, or another situation"
        )


def _migrates(
    change: Change, mode: str, old: int | None, now: int | None, functions: Mapping[str, Callable[..., Value]]
) -> None:
    situation, how = change.situation, change.migrate or ()
    if mode != "drain":
        raise RefusedError("migrate", f"nothing of {situation} is held back in mode {mode}: expected mode drain")
    if old is None or now is None or change.fresh:
        raise RefusedError("migrate", f"no reaction of {situation} is replaced: there is nothing to migrate")
    if len(how) != now:
        raise RefusedError("migrate", f"{situation} takes {now} arguments, and {len(how)} are made for it")
    for way in how:
        if isinstance(way, int):
            if not 1 <= way <= old:
                raise RefusedError("migrate", f"{situation} had {old} arguments: there is no argument {way}")
        elif way not in functions:
            hint = nearest(way, functions)
            raise RefusedError("migrate", f"no function {way} is registered" + (f", {hint}" if hint else ""))
        elif not _takes(functions[way], old):
            raise RefusedError("migrate", f"{way} does not take the {old} arguments that {situation} had")


def _takes(function: Callable[..., Value], count: int) -> bool:
    try:
        inspect.signature(function).bind(*range(count))
    except TypeError:
        return False
    return True


def _asserted(situation: str, count: int, reactions: Iterable[Reaction]) -> None:
    """Who asserts it afterwards gives it as many arguments as it takes."""
    for reaction in reactions:
        for call in calls(reaction.schema.body):
            first = call.arguments[0] if call.arguments else None
            named = first.name if isinstance(first, Symbol) else first.value if isinstance(first, Text) else None
            if call.name in ("ASSERT", "REASSERT") and named == situation and len(call.arguments) - 1 != count:
                given = len(call.arguments) - 1
                raise RefusedError(
                    "migrate", f"P[{reaction.label}] asserts {situation} with {given} arguments, it takes {count}"
                )
