"""Components, their ports, and the subnet that matters for a port (Snet)."""

from __future__ import annotations

import pytest

from planner_reactor.analysis.recursions import recursions
from planner_reactor.analysis.subnets import network, open_ports, subnet, traffic
from planner_reactor.errors import InputError
from planner_reactor.rs.parser import parse_program
from planner_reactor.rs.printer import show
from tests.analysis.models import Model, read, shipped


def names(found: Model, *ports: str) -> list[str]:
    return [show(part).partition("[")[0] for part in subnet(found.process, found.world, ports)]


def test_components_are_found_through_any_number_of_definitions() -> None:
    gem = shipped("guarded_move")
    parts = network(gem.process, gem.world).components
    assert [show(p) for p in parts] == ["Object[p]", "Camera[a]", "Robot[pr]", "Tactile", "Dist"]


def test_ports_with_one_side_only_are_open() -> None:
    gem = shipped("guarded_move")
    assert open_ports(network(gem.process, gem.world).components, gem.world) == {"angle", "rc", "pos", "tact"}


def test_ports_that_are_parameters_are_followed() -> None:
    model = read("Both = Copy[q, r] | Copy[r, s]\nCopy[from, to] = IN[from]<x> : OUT[to, x]", "Both")
    first, second = (traffic(p, model.world) for p in network(model.process, model.world).components)
    assert (first.reads, first.writes) == ({"q"}, {"r"})
    assert (second.reads, second.writes) == ({"r"}, {"s"})


def test_only_what_the_port_depends_on_matters() -> None:
    gem = shipped("guarded_move")
    assert names(gem, "pos") == ["Object", "Camera"]
    assert names(gem, "rc") == ["Robot"]
    assert names(gem, "tact") == ["Object", "Robot", "Tactile", "Dist"]


def test_who_writes_without_a_stream_waits_for_its_reader() -> None:
    model = read("Three = (OUT[q, 1] ; OUT[r, 2]) | (IN[q]<x> ; Delay[1]) | (IN[r]<y> ; Delay[1])", "Three")
    assert len(subnet(model.process, model.world, ["q"])) == 3
    streams = read("Two = (STREAM[q, 1] # IN[w]) | (IN[q]<x> ; Delay[1])", "Two")
    assert len(subnet(streams.process, streams.world, ["w"])) == 1


def test_a_port_that_nobody_uses_is_refused_with_the_nearest() -> None:
    gem = shipped("guarded_move")
    with pytest.raises(InputError, match="did you mean pos"):
        subnet(gem.process, gem.world, ["poss"])


def test_recursions_lead_back_to_the_entry_of_a_cycle() -> None:
    program = parse_program("A = Delay[1] : B\nB = Delay[1] : (A | C)\nC = Delay[1] : C\nD = A")
    assert recursions(program, ["D"]) == {("B", "A"), ("C", "C")}
    assert recursions(program, ["B"]) == {("A", "B"), ("C", "C")}
