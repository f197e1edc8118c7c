"""When a reaction is at rest, so that KILL may take it (docs/decisions, 0007)."""

from __future__ import annotations

import pytest

from planner_reactor.rs import states
from planner_reactor.rs.leaves import resting
from planner_reactor.rs.states import (
    Await,
    Ended,
    Export,
    Group,
    InstanceNumber,
    Leaf,
    Queued,
    Reaction,
    Round,
    Run,
    Serve,
    Spawning,
    Waiting,
)
from planner_reactor.rs.terms import STOP, Loop, Spawn

ONE = InstanceNumber(1)
SENSING = states.Testing
BUSY, SIT = Leaf("Delay", (9,)), Leaf("SIT", ("s",))
LOOP, SPAWN = Loop(STOP, STOP), Spawn(STOP, STOP)


def serving(body: Run) -> Serve:
    return Serve("s", ONE, Reaction(None, None), body)


CASES: list[tuple[Run, bool]] = [
    (SIT, True), (BUSY, False), (Leaf("NIL"), True), (Leaf("E", (1,)), True), (Leaf("ADD"), True),
    (Leaf("ASSUMONITOR"), True), (Leaf("HOLDMONITOR"), True), (Leaf("IN", ("p",)), False),
    (Ended(True), True), (Ended(False), True), (Queued(ONE, SIT), True),
    (Await(ONE, ()), False), (Waiting("WAIT", "s"), False), (serving(SIT), False), (serving(Ended(True)), False),
    (SENSING(BUSY, LOOP, ()), True), (SENSING(Await(ONE, ()), LOOP, ()), True),
    (SENSING(serving(SIT), LOOP, ()), False),
    (Round(BUSY, LOOP, ()), False), (Round(SIT, LOOP, ()), True), (Round(Queued(ONE, SIT), LOOP, ()), True),
    (Round(SENSING(BUSY, LOOP, ()), LOOP, ()), False), (SENSING(Round(BUSY, LOOP, ()), LOOP, ()), True),
    (Spawning(BUSY, SPAWN, ()), True), (Spawning(serving(SIT), SPAWN, ()), False),
    (Spawning(SIT, SPAWN, (), (BUSY,)), False), (Spawning(SIT, SPAWN, (), (SIT, BUSY)), False),
    (Spawning(SIT, SPAWN, (), (SIT, SIT)), True), (Round(Spawning(BUSY, SPAWN, ()), LOOP, ()), False),
    (Spawning(SIT, SPAWN, (), (SENSING(BUSY, LOOP, ()),)), False),
    (Group("|", (SIT, BUSY)), False), (Group("|", (BUSY, SIT)), False), (Group("&", (SIT, SIT)), True),
    (Export((), BUSY), False), (Export((), SIT), True),
]  # fmt: skip


@pytest.mark.parametrize(("term", "rests"), CASES)
def test_a_reaction_rests_where_nothing_has_begun(term: Run, rests: bool) -> None:
    assert resting(term) is rests
