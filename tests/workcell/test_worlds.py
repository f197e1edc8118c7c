"""Environment models as worlds: what they do by themselves, and that only their interface reaches them (X §3.3)."""

from __future__ import annotations

import pytest

from planner_reactor.errors import InputError
from planner_reactor.rs.loading import load
from planner_reactor.rs.printer import show
from planner_reactor.runtime import Executer, Host, Scheduler, VirtualClock
from planner_reactor.workcell.environments.worlds import KINDS, Surroundings

STARTS = {"p": 0.0, "a": 0.0, "pr": 3.0, "s": 1.0}


def lived(kind: str, program: str, *, until: float = 20.0, seed: int = 1, **constants: float) -> Surroundings:
    """The world after so many seconds beside this program."""
    scheduler = Scheduler(VirtualClock(), seed=seed)
    world = Surroundings(scheduler, kind, STARTS, constants)
    host = Host("tried")
    host.ports = world.ports
    executer = Executer(load(f"P = {program}"), scheduler=scheduler, host=host)
    world.start(scheduler)
    executer.start("P")
    scheduler.run(until=until)
    assert world.balanced()
    return world


def test_an_object_moves_by_itself_and_one_seed_is_one_course() -> None:
    first, again, other = (lived("tracking", "NIL", seed=seed).gauge.courses["p"] for seed in (1, 1, 2))
    assert len(first) > 15
    assert first == again != other


def test_the_camera_turns_to_where_it_is_told_to_look() -> None:
    assert lived("tracking", "OUT[m1, 2.5]", until=1.0).gauge.now["a"] == 2.5


def test_a_camera_that_looks_elsewhere_reports_nothing() -> None:
    world = lived("tracking", "OUT[m1, 50.0] : Delay[1] : IN[s1]<v> : OUT[m1, v]")
    assert world.gauge.now["a"] == 50.0


def test_nothing_but_the_interface_is_there_for_a_program() -> None:
    world = lived("tracking", "OUT[angle, 9.0] | (IN[op]<v> : OUT[m1, v])")
    assert world.gauge.now["a"] == 0.0


def test_a_command_is_carried_out_once() -> None:
    world = lived("reaching", "OUT[r, 0.5]")
    assert (world.gauge.moves, world.gauge.now["pr"]) == (1, 3.5)


def test_a_hand_takes_what_is_at_it_and_nothing_else() -> None:
    missed = lived("reaching", "OUT[g, 1] : IN[h]<x> : Equal[x, 0]")
    assert (missed.gauge.taken, missed.gauge.grips[0][1]) == (0, False)
    taken = lived("reaching", "OUT[r, -3] : Delay[0.3] : OUT[g, 1] : IN[h]<x> : Equal[x, 1]", eps=0.0, stride=5.0)
    assert (taken.ledger(), taken.gauge.grips[0][1]) == ({"arrived": 1, "there": 0, "taken": 1, "lost": 0}, True)


def test_touch_is_felt_where_the_object_is() -> None:
    assert not lived("reaching", "IN[t]<v>", eps=0.0).gauge.touches
    assert lived("reaching", "OUT[r, -3] : IN[t]<v>", eps=0.0, stride=5.0).gauge.touches


def test_a_belt_carries_parts_past_and_the_next_one_comes() -> None:
    world = lived("line", "NIL", until=60.0)
    assert world.ledger()["lost"] == 2
    assert world.ledger()["arrived"] == 3


def test_a_belt_that_was_stopped_carries_nothing() -> None:
    scheduler = Scheduler(VirtualClock())
    world = Surroundings(scheduler, "line", STARTS)
    world.start(scheduler)
    scheduler.call_at(3.5, lambda: world.strike("belt", runs=0.0))
    scheduler.call_at(9.5, lambda: world.strike("belt", runs=1.0))
    scheduler.run(until=12.5)
    assert [t for t, _ in world.gauge.courses["p"]] == pytest.approx([0, 1, 2, 3, 10, 11, 12], abs=1e-6)


@pytest.mark.parametrize("kind", KINDS)
def test_every_port_of_an_interface_is_one_that_its_processes_use(kind: str) -> None:
    world = Surroundings(Scheduler(VirtualClock()), kind, STARTS)
    text = "\n".join(show(schema.body) for schema in world.program.schemas)
    assert all(f"[{port}" in text for port in KINDS[kind].ports)


def test_an_unknown_world_is_refused_with_the_nearest_name() -> None:
    with pytest.raises(InputError, match="did you mean tracking"):
        Surroundings(Scheduler(VirtualClock()), "traking", STARTS)


def test_a_robot_goes_only_so_far_for_one_command() -> None:
    assert lived("reaching", "OUT[r, -3]", stride=0.5).gauge.now["pr"] == 2.5
