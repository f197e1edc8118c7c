"""What a configuration evolves under: definitions, the prelude's too, endings, situations that are served by `::`."""

from __future__ import annotations

from planner_reactor.rs.configurations import Config, World, spawned_situations
from planner_reactor.rs.parser import parse_process, parse_program
from planner_reactor.rs.states import Ended
from tests.rs.driving import begun, following
from tests.rs.test_evolves import world


def test_a_basic_process_may_end_either_way_unless_it_is_said_otherwise() -> None:
    assert list(World().endings("a", ())) == [(True, ()), (False, ())]


def test_the_preludes_definitions_are_there_beside_those_of_the_program() -> None:
    w = World(parse_program("T[1] = STOP"))
    assert w.defines("T")
    assert w.defines("STREAM")
    assert not w.defines("U")
    assert w.select("T", (1,)) is not None
    assert w.select("T", (2,)) is None
    assert w.select("STREAM", ("p", 1)) is not None
    config = following("STREAM[p, 7]", "IN[p]<x> ; IN[p]<y>", until=1)
    assert config.root(2) == Ended(True, (("x", 7), ("y", 7)))


def test_situations_served_by_spawning_are_found_wherever_they_are_served() -> None:
    program = parse_program("A = SIT[s]<k> :: STOP\nB = SIT[t]<k> :; STOP")
    assert spawned_situations(program) == {"s"}
    assert spawned_situations(program, parse_process("NIL | ~(SIT[u]<k, x> :: STOP)")) == {"s", "u"}
    assert spawned_situations(parse_program(""), parse_process("IN[p]<x> :: STOP")) == frozenset()
    assert spawned_situations(parse_program(""), parse_process("(a ; b) :: STOP")) == frozenset()


def test_a_spawned_situation_may_be_asserted_from_below_itself() -> None:
    config = following("SIT[s]<k, n> :: ((GTR[n, 0] : ASSERT[s, n - 1]) ; NIL)", "ASSERT[s, 2]", until=1)
    assert [i.arguments for i in config.store.instances] == [(2,), (1,), (0,)]


def test_a_root_is_found_by_its_number_and_a_leaf_is_put_in_its_place() -> None:
    w = world()
    config = begun("NIL", "IN[p]<x> | NIL", w=w)
    first, second, third = config.spots()
    assert [(s.root, s.path) for s in (first, second, third)] == [(1, ()), (2, (0,)), (2, (1,))]
    after = config.put(second, Ended(True))
    assert after.root(1) == config.root(1)
    assert next(iter(after.spots())).root == 1
    assert len(list(after.spots())) == 2
    assert Config().roots == ()
