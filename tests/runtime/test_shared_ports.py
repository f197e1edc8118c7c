"""A port of two executers: what waits on one side meets what comes on the other, as if they were one."""

from __future__ import annotations

from planner_reactor.rs.loading import load
from planner_reactor.runtime import Executer, Host, Label, Scheduler, VirtualClock


def beside(world: str, program: str, *shared: str, until: float = 10.0) -> tuple[list[Label], list[Label]]:
    """What the world and the program did, sharing these ports."""
    scheduler = Scheduler(VirtualClock())
    seen: tuple[list[Label], list[Label]] = ([], [])
    outside = Executer(load(f"W = {world}"), scheduler=scheduler, observer=seen[0].append)
    host = Host("coupled")
    host.ports = outside.share(*shared)
    inside = Executer(load(f"P = {program}"), scheduler=scheduler, host=host, observer=seen[1].append)
    outside.start("W")
    inside.start("P")
    inside.run(until=until)
    assert outside.statistics().rendezvous >= len([s for s in seen[0] if s[0] in ("IN", "OUT")])
    return seen


def test_each_side_sees_its_own_half_of_a_rendezvous() -> None:
    world, program = beside("OUT[p, 7]", "IN[p]<x> : Equal[x, 7]", "p")
    assert world == [("OUT", ("p", 7), "ok", ())]
    assert program == [("IN", ("p",), "ok", (7,)), ("Equal", (7, 7), "ok", ())]


def test_it_is_one_meeting_whoever_comes_first() -> None:
    world, program = beside("Delay[2] : IN[p]<x>", "OUT[p, 3] : Delay[1]", "p")
    assert [s[0] for s in world] == ["Delay", "IN"]
    assert [s[0] for s in program] == ["OUT", "Delay"]


def test_what_is_not_shared_does_not_meet() -> None:
    world, program = beside("OUT[q, 1]", "IN[q]<x>", "p")
    assert (world, program) == ([], [])


def test_a_side_that_has_lost_its_race_offers_nothing_any_more() -> None:
    # the world's # is decided by the meeting at p, so that what it offers at q beside is gone at the same instant
    world, program = beside("OUT[p, 1] # OUT[q, 2]", "IN[p]<x> : IN[q]<y>", "p", "q")
    assert [s[1] for s in program] == [("p",)]
    assert [s[1] for s in world] == [("p", 1)]


def test_one_reader_for_each_write_first_come_first_served() -> None:
    _, program = beside("OUT[p, 1] : OUT[p, 2]", "(IN[p]<x> : Delay[1]) | (IN[p]<y> : Delay[2])", "p")
    assert [s[3] for s in program if s[0] == "IN"] == [(1,), (2,)]


def test_a_reader_that_was_aborted_takes_nothing() -> None:
    _, program = beside("Delay[2] : OUT[p, 1]", "(IN[p]<x> # Delay[1]) : Delay[3] : IN[p]<y>", "p")
    assert [s for s in program if s[0] == "IN"] == [("IN", ("p",), "ok", (1,))]
