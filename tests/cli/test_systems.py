"""`lts`: what it prints and writes, and what it refuses."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.cli.conftest import Call


def test_lts_counts_states_transitions_and_deadlocks(call: Call) -> None:
    found = call("lts", "cell.rsl", "Pair", "-o", "pair.aut", "--json").object
    assert (found["states"], found["transitions"], found["deadlocks"]) == (2, 1, 0)
    assert Path("pair.aut").read_text() == 'des (0, 1, 2)\n(0, "p!7", 1)\n'


def test_lts_shows_a_shortest_way_to_a_deadlock(call: Call) -> None:
    found = call("lts", "cell.rsl", "Waits", "--json").object
    assert (found["deadlocks"], found["deadlock"]) == (1, {"steps": [], "cycle": 0})
    assert "deadlock" in call("lts", "cell.rsl", "Waits").out


@pytest.mark.parametrize(("name", "begins"), [("a.dot", 'digraph "Pair"'), ("a.pml", "/* Pair: 2 cells")])
def test_lts_writes_for_other_tools(call: Call, name: str, begins: str) -> None:
    call("lts", "cell.rsl", "Pair", "-o", name)
    assert Path(name).read_text().startswith(begins)


def test_lts_hides_ports_in_branching_reduction_only(call: Call) -> None:
    assert call("lts", "cell.rsl", "Pair", "--reduce", "branching", "--hide", "p", "--json").object["states"] == 1
    refused = call("lts", "cell.rsl", "Pair", "--reduce", "strong", "--hide", "p")
    assert refused.status == 2
    assert "branching only" in refused.err


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (("Pair", "-o", "pair.svg"), "ends in .aut, .dot, .pml"),
        (("Pair", "--reduce", "weak"), "weak"),
        (("Pair", "--reduce", "orders", "-o", "pair.aut"), "orders counts"),
        (("Count[2]", "--reduce", "orders"), "no time passes"),
        (("Count[2]", "--limit", "2"), "more than 2 states"),
        (("Count[2]", "--limit", "0"), "limit is 0"),
        (("Piar",), "did you mean Pair?"),
    ],
)
def test_lts_refuses_what_it_cannot_use(call: Call, arguments: tuple[str, ...], says: str) -> None:
    refused = call("lts", "cell.rsl", *arguments)
    assert refused.status == 2
    assert says in refused.err
    assert not Path("pair.aut").exists()
