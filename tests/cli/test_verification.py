"""`verify`: verdicts, counterexamples, exit status; what it refuses."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.cli.conftest import Call

PLANT = """\
Good = Asks # Serves
Asks = Delay[5] :; ASSERT[job]
Serves = SIT[job]<k> :; (~(Term[2] : SUCCEED[job, k]) : FAIL[job, k])
Slack = Asks # Forgets
Forgets = SIT[job]<k> :; Term[2]
Unserved = Delay[1] : ASSERT[job]
Hasty = (STOP :; ASSERT[job]) # (SIT[job]<k> :; SUCCEED[job, k])
Better = (OUT[kit, 1] # OUT[kit, 2]) | IN[kit]<x>
Worse = OUT[kit, 1] | IN[kit]<x>
Grows[n] = Delay[1] : Grows[n + 1]
"""
ASKED = "asserted job leads to succeeded job"


@pytest.fixture(autouse=True)
def plant(call: Call) -> None:
    Path("plant.rsl").write_text(PLANT, encoding="utf-8")


def test_what_holds_is_told_with_status_0(call: Call) -> None:
    ran = call("verify", "plant.rsl", "Good", "--property", ASKED, "--json")
    assert ran.status == 0
    assert ran.object["deadlock_free"] is ran.object["zeno_free"] is ran.object["complete"] is True
    assert [p["holds"] for p in ran.object["properties"]] == [True]
    assert (ran.object["refuted"], ran.object["counterexample"]) == (None, [])


def test_a_property_that_is_refuted_comes_with_a_lasso_and_status_1(call: Call) -> None:
    ran = call("verify", "plant.rsl", "Slack", "--property", ASKED, "--json")
    assert (ran.status, ran.object["deadlock_free"]) == (1, True)
    assert ran.object["refuted"] == "always (asserted job -> eventually succeeded job)"
    assert ran.object["counterexample"][:3] == ["5 s pass", "Delay[5]", "ASSERT[job] waits"]
    assert ran.object["cycle"] > 0
    text = call("verify", "plant.rsl", "Slack", "--property", ASKED).out
    assert "does not hold" in text
    assert "and then for ever" in text


def test_deadlock_and_zeno_come_with_the_way_to_them(call: Call) -> None:
    stuck = call("verify", "plant.rsl", "Unserved", "--json")
    assert (stuck.status, stuck.object["deadlock_free"], stuck.object["then"]) == (1, False, "nothing")
    assert stuck.object["counterexample"] == ["1 s pass", "Delay[1]", "ASSERT[job] waits"]
    hasty = call("verify", "plant.rsl", "Hasty", "--json").object
    assert (hasty["zeno_free"], hasty["then"]) == (False, "round")
    assert hasty["counterexample"] == ["ASSERT[job] waits", "SIT[job]<1>", "SUCCEED[job, 1]"]


def test_one_process_is_compared_with_another(call: Call) -> None:
    seeing = ("--seeing", "sent kit[1]", "--seeing", "sent kit[2]")
    assert call("verify", "plant.rsl", "Better", "--refines", "Worse", *seeing, "--json").object["refines"] is True
    back = call("verify", "plant.rsl", "Worse", "--refines", "Better", *seeing, "--json")
    assert (back.status, back.object["refines"]) == (1, False)
    assert back.object["replayed"] is True
    assert (back.object["refuted"], back.object["counterexample"]) == ("refines Better", ["kit!2"])


def test_beyond_the_limit_is_neither_yes_nor_no(call: Call) -> None:
    ran = call("verify", "plant.rsl", "Grows[0]", "--limit", "20", "--json")
    assert (ran.status, ran.object["deadlock_free"], ran.object["complete"]) == (1, None, False)


def test_a_host_brings_processes_that_may_end_in_any_way(call: Call) -> None:
    Path("uses.rsl").write_text("Main = Find[cap]<x> : OUT[found, x] | IN[found]<y>", encoding="utf-8")
    ran = call("verify", "uses.rsl", "Main", "--host", "small_host", "--property", "never aborted Find", "--json")
    assert ran.object["counterexample"] == ["Find[cap] aborts"]
    assert ran.object["deadlock_free"] is False


@pytest.mark.parametrize(("arguments", "said"), [
    (("Good", "--property", "alwys on job"), "<property>:1:1: expected a word"),
    (("Good", "--property", "never failed jib"), "the program has no situation jib, did you mean job?"),
    (("Godo",), "did you mean Good?"),
    (("Good", "--limit", "0"), "limit is 0"),
    (("Good", "--refines", "Slack"), "expected what is to be seen"),
    (("Good", "--refines", "Slack", "--seeing", "on job"), "on job is not a step"),
    (("Good", "--seeing", "served job"), "with `refines` only"),
    (("Good", "--properti", "x"), "did you mean --property?"),
])  # fmt: skip
def test_bad_input_is_refused(call: Call, arguments: tuple[str, ...], said: str) -> None:
    assert call("verify", "plant.rsl", *arguments).refused(said)
