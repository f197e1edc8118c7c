"""`verify --adapt`: verdicts in every mode, counterexamples that run, bounds; what it refuses."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.cli.conftest import Call

PLANT = """\
R = (E[1] # P[1]) | (E[2] # Serving) | (E[3] # P[3]) | (ADD<m> :: (E[m] # P[m]))
P[1] = Term[9] :; ASSERT[job]
Serving = SIT[job]<k> :; (~(REASSERT[part] : SUCCEED[job, k]) : FAIL[job, k])
P[3] = SIT[part]<k> :; (~(Term[5] : SUCCEED[part, k]) : FAIL[part, k])
P[4] = SIT[job]<k> :; (~(ASSERT[part] : SUCCEED[job, k]) : FAIL[job, k])
P[5] = SIT[part]<k> :; (~(Term[2] : SUCCEED[part, k]) : FAIL[part, k])
Endless = (E[1] # P[1]) | (E[3] # Asks) | (ADD<m> :: (E[m] # P[m]))
Asks = SIT[job]<k> :; (Term[1] :; Term[1])
Loose = P[1]
"""
LAWS = ("safe", "consistent", "atomic", "local", "bounded")


@pytest.fixture(autouse=True)
def plant(call: Call) -> None:
    Path("plant.rsl").write_text(PLANT, encoding="utf-8")


def test_kills_and_posts_are_put_into_the_words_and_the_order_of_the_mode(call: Call) -> None:
    ran = call("verify", "plant.rsl", "R", "--adapt", "POST[4] : KILL[3] : KILL[2] : POST[5]", "--json")
    assert ran.status == 0
    assert ran.object["script"] == (
        "DRAIN[job] : DRAIN[part] : KILL[2] : KILL[3] : POST[5] : POST[4] : UNINHIBIT[part] : UNINHIBIT[job]"
    )
    assert all(ran.object[law] is True for law in LAWS)
    assert ran.object["bound_s"] == 10.0
    assert (ran.object["counterexample"], ran.object["broken"], ran.object["replayed"]) == ([], None, None)


def test_versions_come_at_once(call: Call) -> None:
    ran = call("verify", "plant.rsl", "R", "--adapt", "KILL[3] : POST[5]", "--mode", "versions", "--json")
    assert ran.object["script"] == "RETIRE[3] : RENEW[part] : POST[5] : WAITOLD[part] : KILL[3]"
    assert ran.object["safe"] is ran.object["consistent"] is ran.object["local"] is True


@pytest.mark.parametrize(
    ("script", "law", "steps"),
    [
        ("WAIT[job] : INHIBIT[job] : KILL[2] : POST[4]", "safe", 6),
        ("INHIBIT[job] : WAIT[job] : KILL[2] : POST[4]", "bounded", 3),
        ("WAITINHIBIT[part] : WAITINHIBIT[job] : KILL[2] : POST[4]", "bounded", 3),
        ("DRAIN[part] : DRAIN[job] : KILL[2] : KILL[3] : POST[5] : POST[4]", "local", 5),
    ],
)
def test_a_wrong_protocol_has_a_shortest_counterexample_that_runs(
    call: Call, script: str, law: str, steps: int
) -> None:
    ran = call("verify", "plant.rsl", "R", "--adapt", script, "--json")
    assert (ran.status, ran.object["broken"], ran.object[law]) == (1, law, False)
    assert len(ran.object["counterexample"]) == steps
    assert ran.object["replayed"] is True
    text = call("verify", "plant.rsl", "R", "--adapt", script).out
    assert f"{law}: does not hold" in text
    assert ran.object["why"] in text


def test_a_body_without_an_end_has_no_bound(call: Call) -> None:
    ran = call("verify", "plant.rsl", "Endless", "--adapt", "KILL[3] : POST[4]", "--json")
    assert (ran.status, ran.object["bounded"], ran.object["bound_s"]) == (1, False, None)


def test_the_script_may_stand_in_a_file(call: Call) -> None:
    Path("change.rsl").write_text("KILL[3] : POST[5]\n", encoding="utf-8")
    assert call("verify", "plant.rsl", "R", "--adapt", "change.rsl").status == 0


def test_what_cannot_be_adapted_is_refused_with_its_cause(call: Call) -> None:
    assert call("verify", "plant.rsl", "R", "--adapt", "KILL[9]").refused("no reaction 9 to kill", "1, 2, 3")
    assert call("verify", "plant.rsl", "R", "--adapt", "POST[6]").refused("no clause P[6] to add")
    assert call("verify", "plant.rsl", "Loose", "--adapt", "KILL[1]").refused("no guarded reactions")
    assert call("verify", "plant.rsl", "R", "--adapt", "KILL[2").refused("expected")
    assert call("verify", "plant.rsl", "R", "--adapt", "DRAYN[job]").refused("DRAIN")
    assert call("verify", "plant.rsl", "R", "--adapt", "KILL[2]", "--mode", "drains").refused("mode", "drain")
    assert call("verify", "plant.rsl", "R", "--adapt", "nowhere.rsl").refused("nowhere.rsl")
    assert call("verify", "plant.rsl", "R", "--adapt", "KILL[3] : POST[5]", "--limit", "4").refused("4 states")
