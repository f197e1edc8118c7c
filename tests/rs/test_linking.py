"""What calls refer to, and the facts of a definition."""

from __future__ import annotations

from planner_reactor.rs.facts import facts_of
from planner_reactor.rs.linking import Linked
from planner_reactor.rs.parser import parse_process, parse_program
from planner_reactor.rs.printer import show
from planner_reactor.rs.terms import Call
from planner_reactor.rs.vocabulary import BUILT_IN

TEXT = """
    REACTOR = ADD<k> :: (E[k] # P[k])
    P[1] = SIT[s]<n> :; (Q[1] ; SUCCEED[s, n])
    P[2] = Q[2] ; P[1]
    Q[x] = Delay[x]
"""


def linked(text: str = TEXT, *, given: int = 0) -> Linked:
    return Linked(parse_program(text), BUILT_IN, (), given=given)


def targets(call: str) -> list[int]:
    term = parse_process(call, bound=["v"])
    assert isinstance(term, Call)
    return linked().targets(term)


def test_constants_select_clauses_and_variables_may_select_any() -> None:
    assert targets("P[1]") == [1]
    assert targets("P[2.0]") == [2]
    assert targets("P[v]") == targets("P[v + 1]") == [1, 2]
    assert targets("P[3]") == targets("P") == targets("P[1, 2]") == targets("R") == []
    assert targets("Q[7]") == targets("Q[v]") == [3]
    assert targets("Delay[1]") == []


def test_the_call_graph() -> None:
    assert linked().calls == {0: (1, 2), 1: (3,), 2: (3, 1), 3: ()}
    assert linked().families == {"P"}


def test_an_addition_is_seen_with_what_it_leads_to() -> None:
    late = linked(given=2)
    assert list(late.focus) == [2, 3]
    assert list(late.calls_in_focus) == [1, 2, 3]


def test_facts_of_a_process() -> None:
    facts = facts_of(parse_process("E[1] # (SIT[s]<k> :: (IN[p]<x> ; Act[x])) | SIT[t]<j> ; A<y>"))
    assert [call.name for call in facts.calls] == ["E", "SIT", "IN", "Act", "SIT", "A"]
    assert list(facts.binders) == ["k", "x", "j", "y"]
    (service,) = facts.services
    assert service.spawns
    assert show(service.body) == "IN[p]<x> ; Act[x]"
    assert [show(sit) for sit in facts.strays] == ["SIT[t]<j>"]
    assert [show(part) for part in facts.guarded] == ["SIT[s]<k> :: (IN[p]<x> ; Act[x])"]
    assert facts.families == []


def test_near_names_are_looked_for_a_few_times_only() -> None:
    program = linked()
    hints = [program.nearest("REACTR", program.names) for _ in range(100)]
    assert hints[0] == "did you mean REACTOR?"
    assert hints[-1] == ""
