"""The declared form of processes."""

from __future__ import annotations

from planner_reactor.rs.vocabulary import BUILT_IN, NEVER_ENDS, Signature


def test_every_built_in_process_is_declared_under_its_name() -> None:
    names = """STOP ABORT NIL IN OUT STREAM Delay Term SUSPEND Ran GTR LST Equal
        ASSERT REASSERT SIT SUCCEED FAIL UPDATE STUB WAIT INHIBIT UNINHIBIT WAITINHIBIT DRAIN
        RENEW WAITOLD RETIRE COMMIT MIGRATE KILL E ADD POST DISABLE ENABLE
        DISABLED ENABLED FREEZE ASSUMONITOR HOLDMONITOR REPORT"""
    assert set(BUILT_IN) == set(names.split())
    assert all(signature.name == name for name, signature in BUILT_IN.items())
    assert BUILT_IN["NIL"].outcomes == NEVER_ENDS


def test_usage_is_written_as_a_call() -> None:
    usage = {name: signature.usage() for name, signature in BUILT_IN.items()}
    assert usage["SIT"] == "SIT[situation]<k, …>"
    assert usage["Equal"] == "Equal[any, any, number?]"
    assert usage["ADD"] == "ADD<m>"
    assert usage["UPDATE"] == "UPDATE[situation, instance, …]"


def test_counts_of_arguments_and_results() -> None:
    equal, sit, update = BUILT_IN["Equal"], BUILT_IN["SIT"], BUILT_IN["UPDATE"]
    assert [equal.takes(n) for n in range(5)] == [False, False, True, True, False]
    assert [update.takes(n) for n in range(5)] == [False, False, True, True, True]
    assert [sit.returns(n) for n in range(4)] == [True, True, True, True]
    pair = Signature("Pair", (), ("x", "y"))
    assert [pair.returns(n) for n in range(4)] == [True, False, True, False]


def test_arguments_beyond_the_declared_ones_are_of_any_kind() -> None:
    assert [BUILT_IN["UPDATE"].kind(n) for n in range(4)] == ["situation", "instance", "any", "any"]
