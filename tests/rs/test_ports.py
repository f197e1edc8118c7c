"""Ports: in a complete program what is read is written, and the reverse."""

from __future__ import annotations

import pytest

from planner_reactor.errors import RSError
from planner_reactor.rs.checks import check
from planner_reactor.rs.loading import load
from planner_reactor.rs.parser import parse_program
from planner_reactor.rs.vocabulary import Signature
from tests.rs.findings import findings, messages, places


def test_a_port_that_nobody_serves() -> None:
    text = "P = IN[angle]<a> : OUT[angel, a]"
    assert messages(text, "unserved-port") == [
        "port angle is read but never written, did you mean angel?",
        "port angel is written but never read, did you mean angle?",
    ]
    assert places(text, "unserved-port") == [(1, 8), (1, 24)]
    assert messages("P = STREAM[pos, 1]", "unserved-port") == [
        "port pos is written but never read, nothing here reads it"
    ]


@pytest.mark.parametrize(
    "text",
    [
        "P = IN[p]<x> | OUT[p, 1]",
        "P = IN[p]<x> | STREAM[p, 1]",
        "P = Read[p] | OUT[p, 1]\nRead[q] = IN[q]<x>",
        "P = Read[p] | OUT[p, 1]\nRead[q] = Inner[q]\nInner[r] = IN[r]<x>",
        'P = IN["p"]<x> | OUT[p, 1]',
        "P = Sense<x> : IN[x]<y> : OUT[known, y]",  # x may be any port
        "P[port] = IN[port]<x> : OUT[known, x]",  # the port comes from outside
    ],
)
def test_ports_that_are_served_or_may_be(text: str) -> None:
    assert findings(text, "unserved-port") == []


def test_a_host_may_serve_ports_itself_or_by_its_processes() -> None:
    text = "P = IN[camera]<x>"
    assert findings(text, "unserved-port", ports=["camera"]) == []
    listens = {"Listen": Signature("Listen", ("port",))}
    program = parse_program(f"{text} | Listen[camera]")
    assert check(program, signatures=listens, complete=True) == ()


def test_only_complete_programs_must_serve_their_ports() -> None:
    program = parse_program("P = IN[p]<x>\nQ = OUT[p, 1]")
    assert check(program) == ()
    assert [f.code for f in check(program, roots=["P"])] == ["unserved-port", "unreachable"]
    load("P = IN[p]<x>")
    with pytest.raises(RSError, match="port p is read but never written"):
        load("P = IN[p]<x>", roots=["P"])
