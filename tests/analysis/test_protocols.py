"""Scripts that change a reactor: the safe one has nothing against it, each wrong one a shortest counterexample."""

from __future__ import annotations

import pytest

from planner_reactor.analysis.labels import show_label
from planner_reactor.analysis.protocols import Checked, Protocol, check
from planner_reactor.calls.replaying import replay
from planner_reactor.errors import BudgetError
from planner_reactor.reactor.situations import Situations
from planner_reactor.rs.configurations import Ending, World, spawned_situations
from planner_reactor.rs.parser import parse_process, parse_program
from planner_reactor.rs.store import Store
from planner_reactor.rs.terms import Value
from planner_reactor.rs.vocabulary import Signature
from planner_reactor.runtime.strands import Strand

OPEN = (0.0, float("inf"))
EITHER = ("RSB", "RSX", "Work")
LEAVES = {n: Signature(n, window=OPEN) for n in (*EITHER, "RSY", "Q", "Tail")}

NESTED = """
R = (E[1] # P[1]) | (E[2] # P[2]) | (E[3] # P[3]) | (ADD<m> :: (E[m] # P[m]))
P[1] = Q :; ASSERT[sa]
P[2] = SIT[sa]<k> :; (~(REASSERT[sb] : SUCCEED[sa, k]) : FAIL[sa, k])
P[3] = SIT[sb]<k> :; (~(RSB : SUCCEED[sb, k]) : FAIL[sb, k])
P[4] = SIT[sa]<k> :; (~(ASSERT[sx] : SUCCEED[sa, k]) : FAIL[sa, k])
P[5] = SIT[sx]<k> :; (~(RSX : SUCCEED[sx, k]) : FAIL[sx, k])
Broken = DISABLE[sb, A]
"""
SURGERY = "KILL[2] : KILL[3] : POST[5] : POST[4] : UNINHIBIT[sa]"

OVERLAPPING = """
R = (E[1] # P[1]) | (E[2] # P[2]) | (E[3] # P[3]) | (ADD<m> :: (E[m] # P[m]))
P[1] = Q :; ASSERT[s]
P[2] = Q :; ASSERT[s]
P[3] = SIT[s]<k> :: (~(Work : SUCCEED[s, k]) : FAIL[s, k])
P[4] = SIT[s]<k> :: (~(Work : SUCCEED[s, k]) : FAIL[s, k])
"""

TWO = """
R = (E[1] # P[1]) | (E[2] # P[2]) | (E[3] # P[3]) | (ADD<m> :: (E[m] # P[m]))
P[1] = Q :; ASSERT[s]
P[2] = SIT[s]<k> :; (RSX ; SUCCEED[s, k])
P[3] = SIT[s]<k> :; (RSY ; SUCCEED[s, k])
P[4] = SIT[s]<k> :; (RSX ; SUCCEED[s, k])
"""

TAIL = """
R = (E[1] # P[1]) | (E[2] # P[2]) | (ADD<m> :: (E[m] # P[m]))
P[1] = Q :; ASSERT[s]
P[2] = SIT[s]<k> :; (RSX ; SUCCEED[s, k] ; Tail)
P[4] = SIT[s]<k> :; RSX
"""


class NoInstanceOn(Store, frozen=True):
    """WAIT as R Table 2 has it: an instance that has its verdict does not count, whoever still serves it."""

    def quiescent(self, situation: str) -> bool:
        return not any(i.situation == situation and i.status == "on" for i in self.instances)


def endings(name: str, arguments: tuple[Value, ...]) -> list[Ending]:
    return [(True, ()), (False, ())] if name in EITHER else [(True, ())]


def checked(
    text: str,
    script: str,
    *,
    reactor: str = "R",
    named: str = "sa sb sx s",
    kills: tuple[int, ...] = (2, 3),
    adds: tuple[int, ...] = (4, 5),
    store: Store | None = None,
    limit: int = 5_000,
) -> Checked:
    program = parse_program(text)
    protocol = Protocol(
        reactor=parse_process(reactor),
        script=parse_process(script),
        named=frozenset(named.split()),
        kills=frozenset(kills),
        adds=frozenset(adds),
        store=store or Store(),
    )
    world = World(program, LEAVES, endings=endings, spawned=spawned_situations(program))
    return check(protocol, world, limit=limit)


def runs(text: str, script: str, found: Checked, law: str, reactor: str = "R") -> bool:
    """Does the executer take these steps? What goes round does so three times."""
    program = parse_program(text)
    signatures = {name: Signature(name, window=(0.0, 1e6)) for name in LEAVES}
    world = World(program, signatures, endings=endings, spawned=spawned_situations(program))
    broken = found.broken[law]  # type: ignore[index]
    around = broken.path[len(broken.path) - broken.cycle :]
    return replay([parse_process(reactor), parse_process(script)], world, (*broken.path, *around, *around)).done


def steps(found: Checked, law: str) -> list[str]:
    return [show_label(label) for label in found.broken[law].path]  # type: ignore[index]


@pytest.mark.parametrize("drains", ["DRAIN[sa]", "DRAIN[sa] : DRAIN[sb]"])
def test_nothing_is_to_be_said_against_drains_from_the_top(drains: str) -> None:
    assert not checked(NESTED, f"{drains} : {SURGERY}").broken


def test_wait_then_inhibit_is_unsafe_after_six_steps() -> None:
    script = f"WAIT[sa] : INHIBIT[sa] : {SURGERY}"
    found = checked(NESTED, script)
    assert runs(NESTED, script, found, "safe")
    assert steps(found, "safe") == [
        "Q", "WAIT[sa] waits", "ASSERT[sa] waits", "SIT[sa]<1>", "REASSERT[sb] waits", "INHIBIT[sa]",
    ]  # fmt: skip


def test_inhibit_then_wait_cannot_end_after_three_steps() -> None:
    script = f"INHIBIT[sa] : WAIT[sa] : {SURGERY}"
    found = checked(NESTED, script)
    assert runs(NESTED, script, found, "bounded")
    assert set(found.broken) == {"bounded"}
    assert steps(found, "bounded") == ["Q", "ASSERT[sa] waits", "INHIBIT[sa]"]
    assert not found.broken["bounded"].cycle


@pytest.fixture
def table_2(monkeypatch: pytest.MonkeyPatch) -> None:
    """The executer reads WAIT as the table does."""

    def wait(self: Situations, kind: str, name: str, strand: Strand, owner: object) -> None:
        situation = self.named(name)
        situation.waiters.append((kind, strand, owner))
        if not any(instance.status == "on" for instance in situation.instances.values()):
            self._quiescent(situation)

    monkeypatch.setattr(Situations, "wait", wait)


@pytest.mark.usefixtures("table_2")
def test_table_2s_wait_cuts_off_a_second_reaction() -> None:
    script = "WAITINHIBIT[s] : KILL[2] : KILL[3] : POST[4] : UNINHIBIT[s]"
    found = checked(TWO, script, adds=(4,), store=NoInstanceOn())
    assert runs(TWO, script, found, "safe")
    assert steps(found, "safe") == [
        "Q", "ASSERT[s] waits", "SIT[s]<1>", "SIT[s]<1>", "RSY", "SUCCEED[s, 1]", "WAITINHIBIT[s] waits",
    ]  # fmt: skip
    assert "safe" not in checked(TWO, script, adds=(4,)).broken


@pytest.mark.usefixtures("table_2")
def test_a_wait_that_ignores_the_tails_of_bodies_is_unsafe() -> None:
    script = "WAITINHIBIT[s] : KILL[2] : POST[4] : UNINHIBIT[s]"
    found = checked(TAIL, script, kills=(2,), adds=(4,), store=NoInstanceOn())
    assert runs(TAIL, script, found, "safe")
    assert steps(found, "safe") == [
        "Q", "ASSERT[s] waits", "SIT[s]<1>", "RSX", "SUCCEED[s, 1]", "WAITINHIBIT[s] waits",
    ]  # fmt: skip
    assert not checked(TAIL, script, kills=(2,), adds=(4,)).broken


def test_waiting_for_the_parent_of_a_disabled_child_cannot_end_and_draining_it_can() -> None:
    script = f"WAITINHIBIT[sa] : {SURGERY}"
    found = checked(NESTED, script, reactor="R | Broken")
    assert runs(NESTED, script, found, "bounded", reactor="R | Broken")
    assert steps(found, "bounded") == ["Q", "ASSERT[sa] waits", "DISABLE[sb, A]"]
    assert not checked(NESTED, f"DRAIN[sa] : {SURGERY}", reactor="R | Broken").broken


def test_waiting_for_a_child_before_its_parent_cannot_end() -> None:
    script = f"WAITINHIBIT[sb] : WAITINHIBIT[sa] : {SURGERY}"
    found = checked(NESTED, script)
    assert runs(NESTED, script, found, "bounded")
    assert steps(found, "bounded") == ["Q", "ASSERT[sa] waits", "WAITINHIBIT[sb] waits"]


def test_draining_a_child_before_its_parent_holds_the_parent_up() -> None:
    script = f"DRAIN[sb] : DRAIN[sa] : {SURGERY}"
    found = checked(NESTED, script)
    assert runs(NESTED, script, found, "local")
    assert set(found.broken) == {"local"}
    assert found.broken["local"].why == "sa is held up at sb, and is not drained yet"
    assert len(steps(found, "local")) == 5


def test_waitinhibit_may_be_overtaken_for_ever_under_weak_fairness_and_a_drain_may_not() -> None:
    surgery = "KILL[3] : POST[4] : UNINHIBIT[s]"
    found = checked(OVERLAPPING, f"WAITINHIBIT[s] : {surgery}", kills=(3,), adds=(4,))
    lasso = found.broken["bounded"]
    assert runs(OVERLAPPING, f"WAITINHIBIT[s] : {surgery}", found, "bounded")
    assert set(found.broken) == {"bounded"}
    assert lasso.cycle
    around = [show_label(label) for label in lasso.path[-lasso.cycle :]]
    assert {"SUCCEED[s, 1]", "ASSERT[s] waits"} <= set(around)  # one after the other, never none
    assert not checked(OVERLAPPING, f"DRAIN[s] : {surgery}", kills=(3,), adds=(4,)).broken


def test_one_instance_at_a_time_cannot_overtake_waitinhibit() -> None:
    alone = OVERLAPPING.replace("(E[2] # P[2]) | ", "")
    script = "WAITINHIBIT[s] : KILL[3] : POST[4] : UNINHIBIT[s]"
    assert not checked(alone, script, kills=(3,), adds=(4,)).broken


def test_a_child_that_fails_for_ever_keeps_waitinhibit_waiting() -> None:
    lasso = checked(NESTED, f"WAITINHIBIT[sa] : {SURGERY}").broken["bounded"]
    assert [show_label(label) for label in lasso.path[-lasso.cycle :]] == [
        "REASSERT[sb] waits", "SIT[sb]<2>", "RSB aborts", "FAIL[sb, 2]",
    ]  # fmt: skip


def test_a_kill_without_a_drain_is_unsafe() -> None:
    assert "safe" in checked(NESTED, "KILL[2] : KILL[3] : POST[5] : POST[4]").broken


def test_an_instance_that_outlives_its_reaction_is_inconsistent() -> None:
    """A body that gives no verdict leaves its instance on: the next reaction would serve it too."""
    text = TAIL.replace("(RSX ; SUCCEED[s, k] ; Tail)", "RSX")
    found = checked(text, "INHIBIT[s] : KILL[2] : POST[4] : UNINHIBIT[s]", kills=(2,), adds=(4,))
    assert found.broken["consistent"].why == "an instance of s is served by the old reaction and by the new one"


def test_a_drain_after_the_first_kill_is_not_atomic() -> None:
    found = checked(NESTED, "DRAIN[sa] : KILL[2] : DRAIN[sb] : KILL[3] : POST[5] : POST[4] : UNINHIBIT[sa]")
    assert not found.broken  # nothing of sb can be on: the drain is granted at once
    late = checked(NESTED, "DRAIN[sb] : KILL[3] : DRAIN[sa] : KILL[2] : POST[5] : POST[4] : UNINHIBIT[sa]")
    assert late.broken["atomic"].why == "the script waits though P[3] is removed already"


def test_a_kill_of_what_is_not_there_is_not_atomic() -> None:
    found = checked(NESTED, f"DRAIN[sa] : KILL[2] : KILL[9] : {SURGERY}")
    assert found.broken["atomic"].why == "the script aborts half-way"


def test_holding_a_situation_that_is_not_named_is_not_local() -> None:
    found = checked(NESTED, f"DRAIN[sa] : {SURGERY}", named="sb sx")
    assert found.broken["local"].why == "sa is held, and the adaptation does not name it"


def test_a_body_without_an_end_is_not_bounded() -> None:
    found = checked(TAIL.replace("Tail)", "(RSB :; RSX))"), "DRAIN[s] : KILL[2] : POST[4]", kills=(2,), adds=(4,))
    assert found.broken["bounded"].cycle


def test_more_states_than_allowed_are_an_error() -> None:
    with pytest.raises(BudgetError, match="more than 10 states"):
        checked(NESTED, f"DRAIN[sa] : {SURGERY}", limit=10)
