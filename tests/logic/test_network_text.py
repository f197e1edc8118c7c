"""Networks from text: what is read, and what each fault says."""

from __future__ import annotations

import pytest

from planner_reactor.errors import DomainError
from planner_reactor.logic.allen import BIT, relations
from planner_reactor.logic.network_text import read_network, read_statements


def test_lines_become_constraints() -> None:
    network = read_network("// a comment\ni1 (b m o) i2\ni2 [m, o] i3 # another\n\ni3 meets i4\ni3 m i4")
    assert network.intervals == ("i1", "i2", "i3", "i4")
    assert network.relation("i1", "i2") == relations(["b", "m", "o"])
    assert network.relation("i3", "i4") == BIT["m"]


def test_durations_gaps_and_resources_are_read_with_their_lines() -> None:
    text = "i1 lasts 3 .. 5.5\ni2  lasts 4 # exact\ni3 lasts 2 ..\nstart of i2 after end of i1 -1 .. 2\ni1 uses arm\n"
    text += "i2 uses slots 2\nresource slots 4"
    said = read_statements(text, file="day.txt")
    assert [str(one) for one in said] == [
        "i1 lasts 3 .. 5.5", "i2 lasts 4", "i3 lasts 2 ..", "start of i2 after end of i1 -1 .. 2", "i1 uses arm",
        "i2 uses slots 2", "resource slots 4", "there is one arm, for nothing says otherwise",
    ]  # fmt: skip
    assert [one.place.line for one in said if one.place] == [1, 2, 3, 4, 5, 6, 7, 5]
    assert [one.own_words() for one in said[:-1]] == [str(one) for one in said[:-1]]


def test_a_contradiction_is_an_answer_not_an_error() -> None:
    assert not read_network("a (b) b\nb (b) a").consistent


@pytest.mark.parametrize(
    ("text", "line", "column", "says"),
    [
        ("i1", 1, 3, "not a constraint"),
        ("a (b) b\ni1 (b q) i2", 2, 7, "q is not a relation"),
        ("i1 mets i2", 1, 4, "did you mean meets"),
        ("i1 () i2", 1, 5, "empty list"),
        ("i1 (b) i2 i3", 1, 11, "expected the end of the line"),
        ("i1 (b)", 1, 7, "second interval is missing"),
        ("i1 lasts 5 .. 3", 1, 10, "5 .. 3 holds nothing, expected the least first"),
        ("i1 lasts long", 1, 4, "expected a line such as i1 lasts 3000 .. 5000"),
        ("i1 lasts -1 .. 3", 1, 10, "a negative duration"),
        ("i1 uses arm 0", 1, 13, "above 0"),
        ("start of i1 before i2", 1, 7, "such as start of i2 after end of i1"),
        ("i1 (b", 1, 3, "expected INTERVAL (RELATIONS) INTERVAL"),
    ],
)
def test_a_fault_has_its_place_and_its_cause(text: str, line: int, column: int, says: str) -> None:
    with pytest.raises(DomainError) as caught:
        read_network(text, file="net.txt")
    assert (caught.value.place.line, caught.value.place.column) == (line, column)
    assert says in str(caught.value)


def test_all_faults_are_found_in_one_reading() -> None:
    with pytest.raises(DomainError) as caught:
        read_network("a (x) b\nc (y) d")
    assert len(caught.value.diagnostics) == 2
