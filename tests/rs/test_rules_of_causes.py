"""Why things abort: the cause of every abort that the rules know.

The fine print of the rules: `test_evolves` asks what each says; here is what a rule with a small mistake would still
get right there (docs/analysis.md, Mutants).
"""

from __future__ import annotations

import pytest

from planner_reactor.rs.states import (
    Ended,
)
from tests.rs.driving import SERVED, causes, following, inside
from tests.rs.test_evolves import STOPS, run


@pytest.mark.parametrize(
    ("text", "cause"),
    [
        ("ABORT", "failed"),
        ("no", "failed"),
        ("Delay[port]", "failed"),
        ("Delay[x]", "failed"),
        ("GTR[1, 2]", "failed"),
        ("Delay[1/0]", "error"),
        ("((yes<x>;NIL)#STOP) : Delay[x]", "error"),
        ("KILL[9]", "error"),
        ("no | Delay[1/0]", "failed"),
        ("Delay[1/0] | no", "error"),
        ("STOP & no", "failed"),
        ("~yes & (Delay[1] : Delay[1/0])", "error"),
        ("no ; STOP", ""),
        ("no | yes", ""),
        ("no : yes", "failed"),
        ("no :; yes", "failed"),
        ("Delay[1/0] :: yes", "error"),
        ("(no # NIL) : yes", "failed"),
        ("POST[4] # Delay[1] : ABORT", "failed"),
        ("ASSUMONITOR[a, 0]", "error"),
        ("HOLDMONITOR[a, port]", "error"),
    ],
)
def test_the_cause_of_an_abort(text: str, cause: str) -> None:
    assert causes(text) == {cause}


def test_the_cause_of_a_call_that_no_clause_fits() -> None:
    assert causes("T[3]", program="T[1] = STOP") == {"error"}
    assert causes("T", program="T = Delay[1/0]") == {"error"}


def test_n8_spawning_keeps_the_cause_of_its_condition_unless_a_body_stopped() -> None:
    for body, cause in (("no", "failed"), ("yes", "")):
        assert causes("OUT[p, 1] ; OUT[p, 0]", f"(IN[p]<x> : GTR[x, 0]) :: {body}") == {cause}
        assert causes("OUT[p, 1]", f"(IN[p]<x> : Delay[1/0]) :: {body}") == {"error"}


def test_assert_below_what_has_ended_is_withdrawn_and_below_itself_an_error() -> None:
    assert causes("SIT[s]<k> :; (SUCCEED[s, k] ; NIL)", "(SIT[t]<j> :; (FAIL[t, j] ; ASSERT[s])) | ASSERT[t]") == {
        "runs"
    }
    gone = following("SIT[s]<k> :; ((SUCCEED[s, k] ; ASSERT[t]) & NIL)", "ASSERT[s]", until=1)
    assert [e.cause for e in inside(gone.root(1)) if isinstance(e, Ended)] == ["withdrawn"]
    below = following("SIT[s]<k> :; (ASSERT[s] & NIL)", "ASSERT[s]", until=1)
    assert [e.cause for e in inside(below.root(1)) if isinstance(e, Ended)] == ["error"]


def test_assert_below_itself_is_found_through_what_lies_between() -> None:
    reactor = "(SIT[s]<k> :; ASSERT[t]) | (SIT[t]<j> :; (ASSERT[s] & NIL))"
    below = following(reactor, "ASSERT[s]", until=1)
    assert [e.cause for e in inside(below.root(1)) if isinstance(e, Ended)] == ["error"]


def test_reassert_that_gives_up_says_withdrawn() -> None:
    reactor = "(SIT[s]<k> :; (REASSERT[t] & NIL)) | (SIT[t]<j> :; (Delay[2] ; FAIL[t, j]))"
    config = following(reactor, "ASSERT[s]", "Delay[1] ; DRAIN[s]", until=9)
    assert [e for e in inside(config.root(1)) if isinstance(e, Ended)] == [Ended(False)]
    assert [e.cause for e in inside(config.root(1)) if isinstance(e, Ended)] == ["withdrawn"]


def test_n9_an_aborted_await_fails_its_instance_with_a_cause_and_nobody_collects_it() -> None:
    config = following(SERVED, "ASSERT[s] # Delay[1]", until=2)
    (instance,) = config.store.instances
    assert (instance.status, instance.cause, instance.awaited) == ("ab", "cancelled", False)
    assert following(SERVED, "ASSERT[s] # Delay[1]", until=9).store.instances == ()


def test_a_report_and_a_stub_stop_and_can_do_nothing_else() -> None:
    assert run("REPORT[a, 1]") == STOPS
    assert run("STUB[s]") == STOPS
