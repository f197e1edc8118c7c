"""Denseness by looking: every state of a timed network, its local ports hidden (X §6.4, several ports).

`denseness` composes what components do in a round. Where this is not the whole story, since a component asks another
for something within its round and waits for the answer, the paper had no general solution. This is one, for networks
whose delays are numbers and whose data do not grow: the process runs beside writers that are always ready at its input
ports and an eager reader at the port in question, every state is reached by the rules of `rs.evolves`, what happens at
any other port is hidden, and the longest time between two readings is the silence. Hiding is sound because it keeps
branching bisimilarity (`equivalence`): a network and its reduction, in which the local processing is a delay, have the
same silences; tests/analysis/test_hiding.py compares the two.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from math import inf
from typing import TypeAlias

from planner_reactor.analysis.rounds import Irreducible
from planner_reactor.analysis.transitions import Transitions, build
from planner_reactor.errors import BudgetError
from planner_reactor.rs.configurations import Label, World
from planner_reactor.rs.evolves import started
from planner_reactor.rs.terms import STOP, Call, Loop, Number, Par, Process, Symbol

LIMIT = 20_000
"""States that are looked at unless a caller says otherwise."""

Moves: TypeAlias = Sequence[Sequence[tuple[Label, int]]]


def silence(process: Process, world: World, port: str, ready: Collection[str] = (), *, limit: int = LIMIT) -> float:
    """The longest that an eager reader of the port waits for the next value, in seconds; `inf` if for ever.

    `ready` are ports at which the world outside always has a value. The pause of a STREAM counts, and an offer that
    ends as it begins (Term may) is none. `Irreducible` above `limit` states: data that grow, or too many delays.
    """
    transitions = _beside(process, world, port, ready, limit)
    moves = [[(label, after) for label, after in found] for found in transitions.moves]
    begun = sorted({after for found in moves for label, after in found if _is_read(label, port)})
    longest: dict[int, float] = {}
    return max((_longest(state, moves, port, longest) for state in begun), default=inf)


def _beside(process: Process, world: World, port: str, ready: Collection[str], limit: int) -> Transitions:
    writers = [Loop(Call("OUT", (Symbol(p), Number(0))), STOP) for p in ready]
    reader = Loop(Call("IN", (Symbol(port),), ("value",)), STOP)
    try:
        return build(started(Par((process, *writers, reader)), world), world, limit=limit)
    except BudgetError as error:
        raise Irreducible(process, f"more than {limit} states: its data grow, or its delays are too many") from error


def _is_read(label: Label, port: str) -> bool:
    return label[0] == "COM" and label[1][0] == port


def _seconds(label: Label) -> float:
    return float(label[1][0]) if label[0] == "TIME" else 0.0  # type: ignore[arg-type]


def _longest(start: int, moves: Moves, port: str, known: dict[int, float]) -> float:
    """The longest time until the port is read, on any way; for ever if a way goes round without it, or ends."""
    under_way: set[int] = set()
    stack = [start]
    while stack:
        state = stack[-1]
        if state in known:
            under_way.discard(state)
            stack.pop()
            continue
        following = [after for label, after in moves[state] if not _is_read(label, port)]
        if state in under_way:
            waits = [0.0 if _is_read(label, port) else _seconds(label) + known.get(after, inf)
                     for label, after in moves[state]]  # fmt: skip
            known[state] = max(waits, default=inf)
        elif not moves[state]:
            known[state] = inf
        else:
            under_way.add(state)
            if any(after in under_way for after in following):
                known[state] = inf
            else:
                stack += [after for after in following if after not in known]
    return known[start]
