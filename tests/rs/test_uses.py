"""Uses: which constants reach which arguments of basic processes."""

from __future__ import annotations

from planner_reactor.rs.linking import Linked
from planner_reactor.rs.parser import parse_program
from planner_reactor.rs.uses import ARITHMETIC, Uses, flows, parameter_kind, uses
from planner_reactor.rs.vocabulary import BUILT_IN


def linked(text: str) -> Linked:
    return Linked(parse_program(text), BUILT_IN, ())


def used(text: str) -> Uses:
    program = linked(text)
    return uses(program, among=range(len(program.schemas)))


def test_parameters_are_followed_through_calls_and_recursion() -> None:
    program = linked("P[a, b, c] = Q[a] | OUT[p, c] : P[b, a, c]\nQ[x] = IN[x]<v>")
    found = flows(program)
    port = frozenset({("IN", 0)})
    assert found == {0: {"a": port, "b": port, "c": frozenset()}, 1: {"x": port}}


def test_the_kind_of_a_parameter() -> None:
    program = linked("P[a] = Delay[a + 1]\nQ[a] = Delay[a] : E[a]\nR[a] = Delay[a] : IN[a]<x>\nS[a] = OUT[p, a]")
    found = flows(program)
    assert found[0]["a"] == {ARITHMETIC}
    assert [parameter_kind(program, found[number]["a"]) for number in range(4)] == ["number", "number", "any", "any"]


def test_constants_reach_sinks_with_the_place_where_they_stand() -> None:
    found = used("Main = Q[red] | IN[green]<y>\nQ[x] = IN[x]<v>")
    assert {name: place.column if place else 0 for name, place in found.of([("IN", 0)]).items()} == {
        "red": 10,
        "green": 20,
    }
    assert found.open_sinks == set()


def test_other_values_and_arguments_from_outside_leave_a_sink_open() -> None:
    assert used("Main = IN[f(1)]<x>").open_sinks == {("IN", 0)}
    assert used("Main = IN[p]<x> : OUT[x, 1]").open_sinks == {("OUT", 0)}
    assert used("Main[x] = IN[x]<y>").open_sinks == {("IN", 0)}
