"""The environment of the kitting workcell as RS text: it defines what the host offers, and it can be loaded."""

from __future__ import annotations

import pytest

from planner_reactor.errors import InputError
from planner_reactor.rs.checks import check_addition
from planner_reactor.rs.parser import parse_program
from planner_reactor.rs.terms import Program
from planner_reactor.runtime import Scheduler, VirtualClock
from planner_reactor.workcell.environments import ASSUMPTIONS, KINDS, kitting
from planner_reactor.workcell.evidence import ASSUMPTIONS as SENSED
from planner_reactor.workcell.host import host


@pytest.mark.parametrize("kinds", [("cap",), ("cap", "motor"), KINDS])
@pytest.mark.parametrize("fails", [(), ("AQ", "ADD"), ("AQ(cap)",)])
def test_it_is_a_program_without_a_fault(kinds: tuple[str, ...], fails: tuple[str, ...]) -> None:
    found = check_addition(Program(), parse_program(kitting(kinds, fails)))
    assert not [f for f in found if f.severity == "error"]


def test_it_defines_every_process_of_the_cell_with_its_arguments_and_results() -> None:
    program = parse_program(kitting(KINDS))
    made = host(Scheduler(VirtualClock()))
    for name in made.processes:
        signature = made.signatures[name]
        clauses = program.clauses(name)
        assert clauses, name
        assert all(signature.takes(len(c.head)) and signature.returns(len(c.results)) for c in clauses)


def test_it_has_the_assumptions_of_the_cell() -> None:
    assert set(ASSUMPTIONS) == set(SENSED)


def test_each_assumption_that_fails_changes_the_world() -> None:
    assert len({kitting(("cap", "motor"), [name]) for name in ASSUMPTIONS}) == len(ASSUMPTIONS)
    assert kitting(("cap", "motor"), ["AQ(cap)"]) != kitting(("cap", "motor"), ["AQ"])


@pytest.mark.parametrize(("kinds", "fails", "said"), [
    (("cop",), (), "unknown kind cop, did you mean cap?"),
    (("cap",), ("AX",), "unknown assumption AX"),
    (("cap",), ("ADT(cap)",), "unknown assumption ADT(cap)"),
])  # fmt: skip
def test_what_it_does_not_know_is_refused(kinds: tuple[str, ...], fails: tuple[str, ...], said: str) -> None:
    with pytest.raises(InputError) as caught:
        kitting(kinds, fails)
    assert said in str(caught.value)
